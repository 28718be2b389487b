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
    lines = rule.lines
    found = np.empty((len(rule), m**d))
    for span in spans(np.diff(rule.begin), PRODUCTS // (m * (d + len(t)) + m ** (d - 1))):
        where, valid = padding(rule.begin[span.start : span.stop + 1])
        axis, length = lines.axis[where], lines.length[where]
        weight = np.where(valid, lines.weight[where], 0.0)
        start = [lines.start[where, k] for k in range(d)]
        x = np.choose(axis, start)
        points = _chebyshev(x.ravel() + np.multiply.outer(t, length.ravel()), m)
        along = (w @ points).reshape(m, *where.shape) * weight
        tables = [np.where(axis == k, along, _chebyshev(start[k], m)) for k in range(d)]
        found[span] = _contracted(tables)
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
    v = len(values)
    found = np.empty((n, v * m**d))
    step = max(1, PRODUCTS // (q * (m * (v + d) + m ** (d - 1))))
    for start in range(0, n, step):
        piece = slice(start, start + step)
        first, *others = (_chebyshev(nodes[piece, :, k], m) for k in range(d))
        left = np.concatenate([first * value[piece] for value in values])
        found[piece] = _contracted([left, *others])
    return found.reshape(n, v, m**d)


def _contracted(tables: Sequence[Array]) -> Array:
    """Sums over q of products of tables ``(v m, n, q)`` and ``(m, n, q)``, for the Lagrange basis: ``(n, v m**d)``."""
    first, others, *last = tables
    m, n, q = others.shape
    if last:
        others = (others[:, None] * last[0]).reshape(m * m, n, q)
    # the factors stay as they lie, cells in the middle: one small matrix product a cell
    moments = first.swapaxes(0, 1) @ others.transpose(1, 2, 0)
    return _from_chebyshev(moments, m, len(tables)).reshape(n, -1)


def _chebyshev(t: Array, count: int) -> Array:
    """Chebyshev polynomials of the interval ``[0, 1]`` at ``t (...)``, shape ``(count, ...)``."""
    values = np.empty((count, *t.shape))
    values[0] = 1.0
    if count > 1:
        np.multiply(t, 2.0, out=values[1])
        values[1] -= 1.0
        double = 2.0 * values[1]
    for k in range(2, count):
        np.multiply(double, values[k - 1], out=values[k])
        values[k] -= values[k - 2]
    return values


@cache
def _chebyshev_to_lagrange(m: int) -> Array:
    """Return the matrix ``A`` with ``L_k = sum_j A[j, k] T_j``: the inverse of the values of T at the Gauss nodes."""
    return np.asarray(np.linalg.inv(_chebyshev(gauss(m)[0], m).T))


def _from_chebyshev(moments: Array, m: int, dimension: int) -> Array:
    """Turn moments of Chebyshev polynomials into moments of the Lagrange basis, direction by direction."""
    matrix = _chebyshev_to_lagrange(m)
    for _ in range(dimension):
        # Each pass transforms the last direction and brings it to the front of the others.
        moments = (moments.reshape(-1, m) @ matrix).reshape(-1, m ** (dimension - 1), m).swapaxes(1, 2)
    return moments
