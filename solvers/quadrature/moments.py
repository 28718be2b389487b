r"""Moment fitting: a rule on scattered points folded into weights on the Gauss nodes of the whole cell.

Notation: :math:`x_q, w_q` are the points and weights in a cell, :math:`L_k` the Lagrange basis at the tensor Gauss
nodes, :math:`W_k = \sum_q w_q L_k(x_q)`.  The folded rule agrees with the given one on polynomials of degree ``m - 1``
in each direction; on smooth functions the difference is their interpolation error.  Weights may be negative.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature.batch import PointBatch, PointRule, TensorBatch
from solvers.quadrature.pieces import gauss

if TYPE_CHECKING:
    from rfm.calculus.types import Array

POINTS_AT_ONCE = 60_000


def fold(cut: PointBatch | PointRule, nodes_per_direction: int) -> TensorBatch:
    """Fold the rule of each cell into a tensor rule; the cells keep their order.

    Parameters
    ----------
    cut
        A rule on points of each cell's own.
    nodes_per_direction
        Gauss nodes ``m`` a direction: 2p for splines of degree p, 2p + 2 for p <= 4.
    """
    m = nodes_per_direction
    d = cut.cells.shape[1]
    t, _ = gauss(m)
    weights = np.zeros((len(cut), m**d))
    start = 0
    for piece in cut.chunks(POINTS_AT_ONCE):
        n = len(piece)
        legendre = _legendre(piece.nodes, m)
        first = legendre[:, :, 0] * piece.weights[..., None]
        others = legendre[:, :, 1]
        if d == 3:
            others = (others[..., :, None] * legendre[:, :, 2, None, :]).reshape(n, -1, m * m)
        moments = (first.transpose(0, 2, 1) @ others).reshape(n, *[m] * d)
        weights[start : start + n] = _from_legendre(moments).reshape(n, -1)
        start += n
    return TensorBatch(cut.cells, t, weights)


def _legendre(t: Array, count: int) -> Array:
    """Legendre polynomials on ``[0, 1]``, shape ``(*t.shape, count)``."""
    s = 2.0 * t - 1.0
    values = np.ones((count, *t.shape))
    if count > 1:
        values[1] = s
    for k in range(1, count - 1):
        values[k + 1] = ((2 * k + 1) / (k + 1)) * s * values[k] - (k / (k + 1)) * values[k - 1]
    return np.ascontiguousarray(np.moveaxis(values, 0, -1))


@cache
def _legendre_to_lagrange(m: int) -> Array:
    """Return the matrix ``T`` with ``L_k = sum_j T[k, j] P_j`` (discrete orthogonality at the Gauss nodes)."""
    t, w = gauss(m)
    return np.asarray(w[:, None] * (2.0 * np.arange(m) + 1.0) * _legendre(t, m))


def _from_legendre(moments: Array) -> Array:
    """Turn moments of Legendre polynomials into moments of the Lagrange basis, direction by direction."""
    m = moments.shape[-1]
    matrix = _legendre_to_lagrange(m)
    for _ in range(moments.ndim - 1):
        # Each pass transforms the last axis and rolls it to the front of the cell's axes.
        moments = np.moveaxis(moments @ matrix.T, -1, 1)
    return np.asarray(moments)
