r"""Quadratic energy densities in the jet of the unknown.

With :math:`v = (\partial^\beta u)_\beta`, :math:`\beta` over :func:`rfm.calculus.jets.multi_indices`,
an equation with an energy has the density

.. math:: W(v) = \tfrac12 \sum_{\beta\beta'} H_{\beta\beta'} v_\beta v_{\beta'} - \sum_\beta l_\beta v_\beta .

A solution structure :math:`v_\beta = v^0_\beta + \sum_\alpha M_{\beta\alpha}\,\partial^\alpha\psi` turns it
into a density in the jet of the spline :math:`\psi` (the *pull-back*),

.. math:: C = M^T H M, \qquad b = M^T (l - H v^0),

so that the solver sees numbers only (Shapiro, Acta Numerica 2007, section 7; one Newton step of
the Ritz method for a quadratic energy).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from rfm.calculus.types import Array
from structures.jet_matrix import JetMatrix

Scalar = Array | float
Blocks = dict[tuple[int, int], Array]
Loads = dict[int, Array]


@dataclass(frozen=True)
class QuadraticDensity:
    """Nonzero entries of H (upper triangle, ``beta <= beta'``) and of l; arrays over points or numbers."""

    hessian: Mapping[tuple[int, int], Scalar]
    linear: Mapping[int, Scalar]

    def entry(self, row: int, column: int) -> Scalar | None:
        """H[row, column] by symmetry, or None where it is structurally zero."""
        return self.hessian.get((min(row, column), max(row, column)))


def pull_back(
    density: QuadraticDensity, jet: JetMatrix, weights: Array, psi: int = 0
) -> tuple[Blocks, Loads]:
    """Density in the jet of psi, times quadrature weights.

    Parameters
    ----------
    density
        The density in the jet of u at n points.
    jet
        Offset and jet matrix of the structure at the same points.
    weights
        Quadrature weights, shape of the points.
    psi
        Which unknown spline.

    Returns
    -------
    tuple
        ``C[(alpha, alpha')]`` for ``alpha <= alpha'`` and ``b[alpha]``, nonzero entries only, weights included.
    """
    columns: dict[int, list[tuple[int, Array]]] = {}
    for (beta, alpha), entry in jet.entries[psi].items():
        columns.setdefault(alpha, []).append((beta, entry))
    n_beta = jet.offset.shape[0]
    # H M, one column of M at a time, weights included
    products: dict[int, dict[int, Array]] = {}
    for alpha, column in columns.items():
        image: dict[int, Array] = {}
        for beta, entry in column:
            for row in range(n_beta):
                coefficient = density.entry(row, beta)
                if coefficient is None:
                    continue
                term = coefficient * entry
                image[row] = image[row] + term if row in image else term
        products[alpha] = {row: value * weights for row, value in image.items()}

    blocks: Blocks = {}
    loads: Loads = {}
    for alpha, column in columns.items():
        for other, image in products.items():
            if other < alpha:
                continue
            total = sum_products((entry, image[beta]) for beta, entry in column if beta in image)
            if total is not None:
                blocks[alpha, other] = total
        sources = [
            (entry, density.linear[beta] * weights) for beta, entry in column if beta in density.linear
        ]
        load = sum_products(sources + [(-jet.offset[row], value) for row, value in products[alpha].items()])
        if load is not None:
            loads[alpha] = load
    return blocks, loads


def sum_products(pairs: Iterable[tuple[Array, Array]]) -> Array | None:
    """Sum of the products of `pairs`, or None when there are none."""
    total: Array | None = None
    for left, right in pairs:
        total = left * right if total is None else total + left * right
    return total
