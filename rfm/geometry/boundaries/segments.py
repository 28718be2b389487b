r"""Segments and polylines, in the plane and in space.

Notation: c is the middle of a segment, u its unit direction, R half its length, s = u . (x - c).  The carrier is
the line, f the (signed, in the plane) distance to it; the trimming function is that of the ball around
c through both ends, of linear growth (``ends.ball_function``), as Shapiro trims a line by a disk.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry.boundaries.ends import ball_function, trimmed_around, trimmed_carrier
from rfm.geometry.boundaries.pieces import Curves, Joined, dot
from rfm.geometry.checks import shown

SAME_POINT = 1e-12
"""Points closer than this, relative to the extent of the curve, are one point."""


@dataclass(frozen=True, eq=False)
class Segments(Curves):
    """Segments with ends and unit directions (n, d) and half lengths (n,)."""

    direction: Array
    half: Array

    @property
    def middle(self) -> Array:
        """Middles, (n, d)."""
        return 0.5 * (self.start + self.end)

    @property
    def size(self) -> Array:
        """Half the length."""
        return self.half

    def functions(self, *coords: Value) -> Value:
        """See :class:`Pieces`."""
        offsets = [x - c for x, c in zip(coords, self.middle.T, strict=True)]
        along = dot(offsets, self.direction.T)
        if len(coords) == 2:
            f = self._across(offsets)
            return trimmed_carrier(f, ball_function(f * f + along * along, self.half), self.half)
        rests = [o - along * u for o, u in zip(offsets, self.direction.T, strict=True)]
        squared = dot(rests, rests)
        return trimmed_around(squared, ball_function(squared + along * along, self.half), self.half)

    def side(self, *coords: Array) -> Array:
        """Signed distance to the lines, positive on the left."""
        side: Array = self._across([x - c for x, c in zip(coords, self.middle.T, strict=True)])
        return side

    def samples(self) -> tuple[Array, Array]:
        """Middles and left normals."""
        return self.middle, np.stack([-self.direction[:, 1], self.direction[:, 0]], axis=1)

    def bulge(self, x: Array, y: Array, left: Array) -> Array:
        """Nothing lies between a segment and its chord."""
        return np.zeros(1)

    def _across(self, offsets: Sequence[Value]) -> Value:
        return offsets[1] * self.direction[:, 0] - offsets[0] * self.direction[:, 1]


def segment(start: Sequence[float], end: Sequence[float]) -> Joined:
    """Segment between two points of the plane or of space.

    Raises
    ------
    GeometryError
        When the points coincide.
    """
    return polyline([start, end])


def polyline(points: Sequence[Sequence[float]] | Array, *, closed: bool = False, p: int = 2) -> Joined:
    """Join the segments between consecutive points (n, d); of the last and the first too when `closed`.

    Raises
    ------
    GeometryError
        For fewer than two (closed: three) points, points that are not finite, and segments of length zero.
    """
    return Joined((segments(points, closed=closed),), p)


def segments(points: Sequence[Sequence[float]] | Array, *, closed: bool = False) -> Segments:
    """Batch of the segments between consecutive points, see :func:`polyline`."""
    path = checked_points(points, "a polyline", 3 if closed else 2)
    following = np.roll(path, -1, axis=0)
    if not closed:
        path, following = path[:-1], following[:-1]
    chords = following - path
    lengths = np.linalg.norm(chords, axis=1)
    extent = float(np.ptp(np.concatenate([path, following]), axis=0).max())
    short = np.flatnonzero(lengths <= SAME_POINT * extent)
    if len(short):
        i, j = short[0], (short[0] + 1) % len(points)
        raise GeometryError(
            f"segment {i} has length zero: points {i} and {j} are the same point {shown(path[i])}"
        )
    return Segments(path, following, chords / lengths[:, None], 0.5 * lengths)


def checked_points(points: Sequence[Sequence[float]] | Array, owner: str, least: int) -> Array:
    """Points as an array (n, d) with d = 2 or 3 and at least so many rows."""
    try:
        array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise GeometryError(f"the points of {owner} must be a list of pairs or triples of numbers")
    wrong = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(wrong):
        raise GeometryError(f"point {wrong[0]} of {owner} must be finite, got {shown(array[wrong[0]])}")
    if len(array) < least:
        raise GeometryError(f"{owner} needs at least {least} points, got {len(array)}")
    return array
