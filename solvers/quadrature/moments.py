r"""Moment fitting: a rule on scattered points folded into weights on the Gauss nodes of the whole cell.

Notation: :math:`x_q, w_q` are the points and weights in a cell, :math:`L_k` the Lagrange basis at the tensor Gauss
nodes, :math:`W_k = \sum_q w_q L_k(x_q)`.  The folded rule agrees with the given one on polynomials of degree ``m - 1``
in each direction; on smooth functions the difference is their interpolation error.  Weights may be negative.

With values :math:`w_q c_q` in place of the weights the sums against all polynomials of that degree stay what they are
whatever the function c: so the assembly makes tensor cells of scattered points without an error
(:mod:`solvers.assembly`).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature.batch import PointBatch, PointRule, TensorBatch, padding, spans
from solvers.quadrature.lines import LineRule
from solvers.quadrature.pieces import gauss

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rfm.calculus.types import Array

POINTS_AT_ONCE = 60_000
PRODUCTS = 250_000
"""Numbers in the tables of one chunk of cells: they stay in the cache."""


def fold(cut: PointBatch | PointRule | LineRule, nodes_per_direction: int) -> TensorBatch:
    """Fold the rule of each cell into a tensor rule; the cells keep their order.

    Parameters
    ----------
    cut
        A rule on points, or on lines, of each cell's own.
    nodes_per_direction
        Gauss nodes ``m`` a direction: 2p for splines of degree p, 2p + 2 for p <= 4.
    """
    m = nodes_per_direction
    t, _ = gauss(m)
    if isinstance(cut, LineRule):
        return TensorBatch(cut.cells, t, _line_moments(cut, m))
    weights = np.zeros((len(cut), m ** cut.cells.shape[1]))
    start = 0
    for piece in cut.chunks(POINTS_AT_ONCE):
        weights[start : start + len(piece)] = nodal_moments(piece.nodes, [piece.weights], m)[:, 0]
        start += len(piece)
    return TensorBatch(cut.cells, t, weights)


def _line_moments(rule: LineRule, m: int) -> Array:
    """Moments of a rule on lines, shape ``(n, m**d)``: the sum over the points of a line comes first, in 1D.

    A polynomial of degree ``m - 1`` needs no more than ``(m + 1) // 2`` points on a line, whatever the rule has.
    """
    d = rule.cells.shape[1]
    t, w = gauss(min(rule.order, (m + 1) // 2))
    found = np.empty((len(rule), m**d))
    for span in spans(np.diff(rule.begin), PRODUCTS // (m * (d + 1) + m ** (d - 1))):
        lines = rule.lines
        where, valid = padding(rule.begin[span.start : span.stop + 1])
        start = np.moveaxis(lines.start[where], -1, 1)
        axis, length = lines.axis[where], lines.length[where]
        weight = np.where(valid, lines.weight[where], 0.0)
        legendre = _legendre(np.ascontiguousarray(start), m)
        x = np.take_along_axis(start, axis[:, None], axis=1)[:, 0]
        along = sum(c * _legendre(x + length * s, m) for s, c in zip(t, w, strict=True)) * weight[:, None]
        tables = [np.where((axis == k)[:, None], along, legendre[:, k]) for k in range(d)]
        found[span] = _contracted(tables).reshape(-1, m**d)
    return found


def nodal_moments(nodes: Array, values: Sequence[Array], m: int) -> Array:
    """Sums of values at points against the Lagrange basis at the tensor Gauss nodes.

    Parameters
    ----------
    nodes
        Unit coordinates of q points in each of n cells, shape (n, q, d).
    values
        Arrays of shape (n, q), weights included.
    m
        Gauss nodes a direction.

    Returns
    -------
    ndarray, shape (n, number of values, m**d)
    """
    n, q, d = nodes.shape
    found = np.empty((n, len(values), m**d))
    step = max(1, PRODUCTS // (q * (len(values) * m + m ** (d - 1))))
    for start in range(0, n, step):
        piece = slice(start, start + step)
        legendre = _legendre(np.ascontiguousarray(nodes[piece].swapaxes(1, 2)), m)
        stacked = np.stack([v[piece] for v in values], axis=1)
        left = (stacked[:, :, None] * legendre[:, None, 0]).reshape(len(legendre), -1, q)
        found[piece] = _contracted([left, *(legendre[:, k] for k in range(1, d))]).reshape(
            -1, len(values), m**d
        )
    return found


def _contracted(tables: Sequence[Array]) -> Array:
    """Sums over q of products of tables ``(n, v m, q)`` and ``(n, m, q)``, for the Lagrange basis: ``(n v, m, ..., m)``."""
    first, others, *last = tables
    n, m, q = others.shape
    if last:
        others = (others[:, :, None] * last[0][:, None]).reshape(n, m * m, q)
    moments = first @ others.swapaxes(1, 2)
    return _from_legendre(moments.reshape(-1, *[m] * len(tables)))


def _legendre(t: Array, count: int) -> Array:
    """Legendre polynomials on ``[0, 1]`` at ``t (..., q)``, shape ``(..., count, q)``."""
    s = 2.0 * t - 1.0
    values = np.ones((*t.shape[:-1], count, t.shape[-1]))
    if count > 1:
        values[..., 1, :] = s
    for k in range(1, count - 1):
        values[..., k + 1, :] = ((2 * k + 1) / (k + 1)) * s * values[..., k, :]
        values[..., k + 1, :] -= (k / (k + 1)) * values[..., k - 1, :]
    return values


@cache
def _legendre_to_lagrange(m: int) -> Array:
    """Return the matrix ``T`` with ``L_k = sum_j T[k, j] P_j`` (discrete orthogonality at the Gauss nodes)."""
    t, w = gauss(m)
    return np.asarray(w[:, None] * (2.0 * np.arange(m) + 1.0) * _legendre(t, m).T)


def _from_legendre(moments: Array) -> Array:
    """Turn moments of Legendre polynomials into moments of the Lagrange basis, direction by direction."""
    m = moments.shape[-1]
    matrix = _legendre_to_lagrange(m)
    for _ in range(moments.ndim - 1):
        # Each pass transforms the last axis and rolls it to the front of the cell's axes.
        moments = np.moveaxis(moments @ matrix.T, -1, 1)
    return np.asarray(moments)
