"""Points: their function is the distance, of unit slope in every direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import guarded_power
from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry.boundaries.pieces import Joined, Pieces, dot
from rfm.geometry.boundaries.segments import SAME_POINT, checked_points
from rfm.geometry.checks import shown


@dataclass(frozen=True, eq=False)
class Points(Pieces):
    """Points (n, d)."""

    position: Array

    def functions(self, *coords: Value) -> Value:
        """See :class:`Pieces`."""
        offsets = [x - c for x, c in zip(coords, self.position.T, strict=True)]
        return guarded_power(dot(offsets, offsets), 0.5)


def points(positions: Sequence[Sequence[float]] | Array, *, p: int = 2) -> Joined:
    """Join points (n, d) of the plane or of space.

    Raises
    ------
    GeometryError
        When two points coincide: joined with itself a point would lose its unit slope.
    """
    array = checked_points(positions, "a set of points", 1)
    order = np.lexsort(array.T)
    gaps = np.linalg.norm(np.diff(array[order], axis=0), axis=1)
    extent = float(np.ptp(array, axis=0).max())
    same = np.flatnonzero(gaps <= SAME_POINT * extent)
    if len(same):
        i, j = sorted(order[same[0] : same[0] + 2].tolist())
        raise GeometryError(f"points {i} and {j} are the same point {shown(array[i])}")
    return Joined((Points(array),), p)
