"""Boundary rules in boxes in which one surface, the target, is a graph over a base.

The notation is that of :mod:`solvers.quadrature.volume`; the target is slot 0.  A point of the target belongs to the
boundary of the domain when the domain contains one of its two sides only.  Points on a face of the box belong to the
box that holds the inner side, so that a boundary along the grid is found once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature import bernstein
from solvers.quadrature.heights import height, restrict
from solvers.quadrature.pieces import broken, gauss
from solvers.quadrature.volume import Graphs, base_nodes, line_breaks

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.logic import Mask
    from solvers.grid import Integers


@dataclass(frozen=True, eq=False)
class BoundaryPoints:
    """Flat rule over the base.

    Attributes
    ----------
    owner
        Box numbers, shape ``(N,)``.
    at
        Coordinates in box units, ``x, y[, z]``, shape ``(N, d)``.
    weight
        Weights over the base, shape ``(N,)``.
    inner_sign
        Sign of the target on the side of the domain, +1 or -1, shape ``(N,)``.
    """

    owner: Integers
    at: Array
    weight: Array
    inner_sign: Array


def boundary_points(graphs: Graphs, preceding: Mask, order: int) -> BoundaryPoints:
    """Return the rule for the target in all boxes.

    Parameters
    ----------
    graphs
        The boxes, target in slot 0; only the target needs a height.
    preceding
        Which other slots come before the target: where two surfaces coincide the first one bears the boundary.
        Shape ``(n, m)``.
    order
        Points on each piece of a base line.
    """
    m = graphs.noise.shape[1]
    pairs = [(0, j) for j in range(1, m)]
    if graphs.c.ndim == 4:
        return _plane(graphs, preceding, order, pairs)
    triples = [(0, i, j) for i in range(1, m) for j in range(i + 1, m)]
    owner, z, weight = base_nodes(graphs, order, pairs, triples)
    where = np.repeat(owner, order)
    plane = _plane(graphs.slices(owner, z), preceding[where], order, pairs)
    return BoundaryPoints(
        where[plane.owner],
        np.column_stack([plane.at, z.ravel()[plane.owner]]),
        plane.weight * weight.ravel()[plane.owner],
        plane.inner_sign,
    )


def _plane(graphs: Graphs, preceding: Mask, order: int, pairs: list[tuple[int, int]]) -> BoundaryPoints:
    t, w = gauss(order)
    pieces = broken(len(graphs.c), line_breaks(graphs, slice(0, 1), pairs))
    y = pieces.nodes(t)
    lines = restrict(graphs.c[pieces.owner], y)
    target = lines[:, :, 0]
    x, exists = height(target, graphs.noise[pieces.owner, 0][:, None])
    p, q = np.nonzero(exists)
    owner, x, lines = pieces.owner[p], x[p, q], lines[p, q]
    rising = target[p, q, -1] > target[p, q, 0]
    above, below, hidden = _sides(graphs, preceding, owner, lines, x, rising)
    rows = np.arange(len(owner))
    inside_above = graphs.table[owner][rows, above]
    inside_below = graphs.table[owner][rows, below]
    # On a face, the side within the box decides whether the point is ours.
    ours = np.where(
        x == 0.0,
        np.where(rising, inside_above, inside_below),
        np.where(x == 1.0, np.where(rising, inside_below, inside_above), True),
    )
    keep = np.flatnonzero((inside_above != inside_below) & ours & ~hidden)
    p, q = p[keep], q[keep]
    return BoundaryPoints(
        owner[keep],
        np.column_stack([x[keep], y[p, q]]),
        pieces.length[p] * w[q],
        np.where(inside_above[keep], 1.0, -1.0),
    )


def _sides(
    graphs: Graphs, preceding: Mask, owner: Integers, lines: Array, x: Array, rising: Mask
) -> tuple[Integers, Integers, Mask]:
    """Codes of the signs on the positive and on the negative side of the target, and points borne by another."""
    above = np.ones(len(x), dtype=np.int64)
    below = np.zeros(len(x), dtype=np.int64)
    hidden = np.zeros(len(x), dtype=bool)
    for a in range(1, lines.shape[1]):
        values = bernstein.evaluate(lines[:, a], x)
        positive_above = values > 0
        positive_below = positive_above
        shared = np.abs(values) <= COINCIDENT * graphs.noise[owner, a]
        if shared.any():
            slope = bernstein.evaluate(bernstein.derivative(lines[:, a], -1), x)
            with_target = (slope > 0) == rising
            positive_above = np.where(shared, with_target, positive_above)
            positive_below = np.where(shared, ~with_target, positive_below)
            hidden |= shared & preceding[owner, a]
        above |= positive_above.astype(np.int64) << a
        below |= positive_below.astype(np.int64) << a
    return above, below, hidden


COINCIDENT = 8.0
"""Surfaces nearer than this many times the rounding level lie on each other."""
