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

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from rfm.calculus.types import Array
from solvers.equations.rows import Scalar
from structures.jet_matrix import JetMatrix

Column = tuple[int, int]
"""A column ``(m, alpha)`` of the structure: a derivative of one of its splines."""
Blocks = dict[tuple[Column, Column], Array]
Loads = dict[Column, Array]


class Density(Protocol):
    """A functional in the jet of u at points that can be expressed in the jets of the splines."""

    def pull_back(self, jet: JetMatrix, weights: Scalar) -> tuple[Blocks, Loads]:
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

    def pull_back(self, jet: JetMatrix, weights: Scalar) -> tuple[Blocks, Loads]:
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


def pull_back(density: QuadraticDensity, jet: JetMatrix, weights: Scalar) -> tuple[Blocks, Loads]:
    """Density in the jets of the splines, times quadrature weights.

    Parameters
    ----------
    density
        The density in the jet of the field at n points.
    jet
        Offset and jet matrix of the structure at the same points.
    weights
        Quadrature weights, shape of the points, or a number.

    Returns
    -------
    tuple
        ``C[(m, alpha), (m', alpha')]``, of a symmetric density for ``(m, alpha) <= (m', alpha')`` only, and
        ``b[(m, alpha)]``; nonzero entries only, weights included.  Equal entries may be one array: do not write
        into them.
    """
    columns: dict[Column, list[tuple[int, Array]]] = {}
    for psi, matrix in jet.entries.items():
        for (row, alpha), entry in matrix.items():
            columns.setdefault((psi, alpha), []).append((row, entry))
    times = Products()
    form = {
        column: [(row, times(entry, weights)) for row, entry in entries]
        for column, entries in density.columns().items()
    }
    images = {column: image(form, entries, times) for column, entries in columns.items()}
    # l - H v0: the rows of the load
    right = {row: -value for row, value in image(form, jet.known, times).items()}
    for row, value in density.linear.items():
        term = times(value, weights)
        right[row] = right[row] + term if row in right else term

    blocks: Blocks = {}
    loads: Loads = {}
    for test, entries in columns.items():
        for trial, product in images.items():
            if density.symmetric and trial < test:
                continue
            total = sum_products([(entry, product[row]) for row, entry in entries if row in product], times)
            if total is not None:
                blocks[test, trial] = total
        load = sum_products([(entry, right[row]) for row, entry in entries if row in right], times)
        if load is not None:
            loads[test] = load
    return blocks, loads


class Products:
    """Products that are computed once: equal entries of a structure are one array, and so are their products."""

    def __init__(self) -> None:
        self._known: dict[tuple[Any, Any], tuple[Scalar, Scalar, Scalar]] = {}

    def __call__(self, first: Scalar, second: Scalar) -> Scalar:
        """Product of two factors."""
        if isinstance(first, float) and first == 1.0:
            return second
        if isinstance(second, float) and second == 1.0:
            return first
        key = (_identity(first), _identity(second))
        if key not in self._known:
            # the factors are kept too: a number of theirs must not be given to another array
            self._known[key] = first, second, first * second
        return self._known[key][2]


def _identity(factor: Scalar) -> Any:
    return (factor,) if isinstance(factor, float) else id(factor)


def image(
    form: Mapping[int, list[tuple[int, Scalar]]], entries: Iterable[tuple[int, Array]], times: Products
) -> dict[int, Scalar]:
    """``H x`` of a sparse column x of entries by row; `form` holds the entries of H by column."""
    product: dict[int, Scalar] = {}
    for column, entry in entries:
        for row, coefficient in form.get(column, ()):
            term = times(coefficient, entry)
            product[row] = product[row] + term if row in product else term
    return product


def sum_products(pairs: Sequence[tuple[Array, Scalar]], times: Products) -> Array | None:
    """Sum of the products of `pairs`, or None when there are none; a single product may be shared."""
    if not pairs:
        return None
    if len(pairs) == 1:
        return np.asarray(times(*pairs[0]))
    total: Array = np.asarray(pairs[0][0] * pairs[0][1])
    for left, right in pairs[1:]:
        total += left * right
    return total
