r"""The winding number of closed curves in the plane.

Notation: the closed curve runs through pieces from start to end.  Its winding number is that of the polygon of
the chords, found by the crossings of the ray to the right, plus that of each piece followed by its chord
backwards (``Curves.bulge``), which is +1 or -1 between the two and 0 elsewhere.  Both use one and the same
sign of the point's position beside the chord, so they fit together to the last bit; a point on a chord counts
to its right, on a level chord above it.

Reference: J. O'Rourke, Computational Geometry in C (Cambridge 1998), section 7.4 (crossings and winding).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.boundaries.pieces import Curves, in_chunks
from rfm.geometry.checks import shown

SAME_POINT = 1e-10
"""Ends of pieces closer than this, relative to the extent of the curve, are one point."""


def winding_number(batches: Sequence[Curves], x: Array, y: Array) -> Array:
    """Winding number of closed curves about points, of the shape of the coordinates; see :func:`closed`."""

    def number(x: Array, y: Array) -> Array:
        blocks = (block for batch in batches for block in batch.blocks(x.size))
        return np.asarray(sum(_crossings(block, x[:, None], y[:, None]) for block in blocks))

    return in_chunks(number, (x, y))


def _crossings(curves: Curves, x: Array, y: Array) -> Array:
    (ax, ay), (bx, by) = curves.start.T, curves.end.T
    turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    on_line_left = (by < ay) | ((by == ay) & (bx > ax))
    left = (turn > 0.0) | ((turn == 0.0) & on_line_left)
    up = (ay <= y) & (y < by) & left
    down = (by <= y) & (y < ay) & ~left
    total: Array = (up.astype(np.float64) - down + curves.bulge(x, y, left)).sum(axis=1)
    return total


def closed(batches: Sequence[Curves]) -> tuple[Curves, ...]:
    """Return the same pieces with ends that coincide exactly.

    Raises
    ------
    GeometryError
        When a piece begins or ends where no other one continues the curve.
    """
    from scipy.spatial import cKDTree

    starts = np.concatenate([batch.start for batch in batches])
    ends = np.concatenate([batch.end for batch in batches])
    extent = float(np.ptp(np.concatenate([starts, ends]), axis=0).max())
    size = max(extent, *(float(batch.size.max()) for batch in batches))
    points = np.concatenate([starts, ends])
    # every point becomes the first one of its cluster
    neighbours = cKDTree(points).query_ball_point(points, SAME_POINT * size)
    labels = np.array([min(group) for group in neighbours])
    balance = np.bincount(labels[: len(starts)], minlength=len(points))
    balance -= np.bincount(labels[len(starts) :], minlength=len(points))
    loose = np.flatnonzero(balance)
    if len(loose):
        what = "starts" if balance[loose[0]] > 0 else "ends"
        raise GeometryError(
            f"a signed function needs closed curves, but a piece {what} at {shown(points[loose[0]])}, where "
            "no other piece continues it; close the curve, or use the unsigned function"
        )
    snapped = points[labels]
    result, position = [], 0
    for batch in batches:
        rows = slice(position, position + len(batch.start))
        position = rows.stop
        result.append(replace(batch, start=snapped[: len(starts)][rows], end=snapped[len(starts) :][rows]))
    return tuple(result)
