r"""Quadratic densities in the jet of the unknown field.

The rows of :math:`v` are the partial derivatives :math:`\partial^\beta u_c` of all components, one component
after the other, :math:`\beta` over :func:`rfm.calculus.jets.multi_indices`.  A method of solution gives a density

.. math:: W(v) = \tfrac12 v^T H v - l^T v

(for Ritz the energy of the equation, for least squares the square of its residual), or, for a method without a
functional, a form :math:`w^T H v - l^T w` with the test field's jet w, where H need not be symmetric.

A solution structure :math:`v = v^0 + \sum_m M_m\,(\partial^\alpha \psi_m)_\alpha` turns it into a density in the
jets of the splines :math:`\psi_m` (the *pull-back*),

.. math:: C = M^T H M, \qquad b = M^T (l - H v^0),

so that assembly sees numbers only (Shapiro, Acta Numerica 2007, section 7).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

from rfm.calculus.types import Array
from solvers.equations.rows import Scalar
from structures.jet_matrix import JetMatrix

Column = tuple[int, int]
"""A column ``(m, alpha)`` of the structure: a derivative of one of its splines."""
Blocks = dict[tuple[Column, Column], Array]
Loads = dict[Column, Array]


class Density(Protocol):
    """A functional in the jet of u at points that can be expressed in the jets of the splines."""

    def pull_back(self, jet: JetMatrix, weights: Array) -> tuple[Blocks, Loads]:
        """Return blocks and loads, quadrature weights included; see :func:`pull_back`."""
        ...


@dataclass(frozen=True)
class QuadraticDensity:
    """Nonzero entries of H and l, arrays over points or numbers.

    Attributes
    ----------
    hessian
        H by ``(row, column)``; of a symmetric H the entries with ``row <= column`` only.
    linear
        l by row.
    symmetric
        Whether H is symmetric.
    """

    hessian: Mapping[tuple[int, int], Scalar]
    linear: Mapping[int, Scalar]
    symmetric: bool = True

    def pull_back(self, jet: JetMatrix, weights: Array) -> tuple[Blocks, Loads]:
        """Density in the jets of the splines; see :func:`pull_back`."""
        return pull_back(self, jet, weights)

    def general(self) -> QuadraticDensity:
        """Return the same form with all its entries, as one that need not be symmetric."""
        if not self.symmetric:
            return self
        mirrored = {(j, i): entry for (i, j), entry in self.hessian.items()}
        return QuadraticDensity({**mirrored, **self.hessian}, self.linear, symmetric=False)

    def columns(self) -> dict[int, list[tuple[int, Scalar]]]:
        """The nonzero entries of H by column: ``(row, entry)``, both triangles."""
        found: dict[int, list[tuple[int, Scalar]]] = {}
        for (row, column), entry in self.hessian.items():
            found.setdefault(column, []).append((row, entry))
            if self.symmetric and row != column:
                found.setdefault(row, []).append((column, entry))
        return found


def squared(rows: Iterable[tuple[Mapping[int, Scalar], Scalar, Scalar]]) -> QuadraticDensity:
    """Half the weighted sum of squares of affine rows ``r.v - f``, given as (r, f, weight)."""
    hessian: dict[tuple[int, int], Scalar] = {}
    linear: dict[int, Scalar] = {}
    for row, right, weight in rows:
        for i, first in row.items():
            for j, second in row.items():
                if i <= j:
                    term = weight * first * second
                    hessian[i, j] = hessian[i, j] + term if (i, j) in hessian else term
            term = weight * first * right
            linear[i] = linear[i] + term if i in linear else term
    return QuadraticDensity(hessian, linear)


def pull_back(density: QuadraticDensity, jet: JetMatrix, weights: Array) -> tuple[Blocks, Loads]:
    """Density in the jets of the splines, times quadrature weights.

    Parameters
    ----------
    density
        The density in the jet of the field at n points.
    jet
        Offset and jet matrix of the structure at the same points.
    weights
        Quadrature weights, shape of the points.

    Returns
    -------
    tuple
        ``C[(m, alpha), (m', alpha')]``, of a symmetric density for ``(m, alpha) <= (m', alpha')`` only, and
        ``b[(m, alpha)]``; nonzero entries only, weights included.
    """
    columns: dict[Column, list[tuple[int, Array]]] = {}
    for psi, matrix in jet.entries.items():
        for (row, alpha), entry in matrix.items():
            columns.setdefault((psi, alpha), []).append((row, entry))
    form = density.columns()
    images = {column: image(form, entries, weights) for column, entries in columns.items()}
    start = image(form, list(enumerate(jet.offset)), weights)

    blocks: Blocks = {}
    loads: Loads = {}
    for test, entries in columns.items():
        for trial, product in images.items():
            if density.symmetric and trial < test:
                continue
            total = sum_products((entry, product[row]) for row, entry in entries if row in product)
            if total is not None:
                blocks[test, trial] = total
        pairs = [(entry, density.linear[row] * weights) for row, entry in entries if row in density.linear]
        load = sum_products(pairs + [(-entry, start[row]) for row, entry in entries if row in start])
        if load is not None:
            loads[test] = load
    return blocks, loads


def image(
    form: Mapping[int, list[tuple[int, Scalar]]], entries: Iterable[tuple[int, Array]], weights: Array
) -> dict[int, Array]:
    """``H x`` times the weights for a sparse column x of entries by row."""
    product: dict[int, Array] = {}
    for column, entry in entries:
        for row, coefficient in form.get(column, ()):
            term = coefficient * entry
            product[row] = product[row] + term if row in product else term
    return {row: value * weights for row, value in product.items()}


def sum_products(pairs: Iterable[tuple[Array, Array]]) -> Array | None:
    """Sum of the products of `pairs`, or None when there are none."""
    total: Array | None = None
    for left, right in pairs:
        total = left * right if total is None else total + left * right
    return total
