r"""Signed functions of closed boundaries: positive inside, negative outside, zero on the boundary.

Notation: w >= 0 is the joint function of the pieces, W the winding number of the boundary about a point; the
field is w where W is not zero and -w where it is.  Inside is hence every point that the boundary goes around
a number of times other than zero, also where it crosses itself.

On a piece itself w changes like ``|f|``, f its carrier, and the field like f or -f: its derivatives exist there
too.  At points that lie on the boundary up to rounding the sign is taken from f, not from W, so that the
derivatives are right there as well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.jet import value_of
from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry.boundaries.pieces import Curves, Joined, Sided
from rfm.geometry.boundaries.winding import closed, winding_number

ON_BOUNDARY = 1e-13
"""Where w is less than this, relative to the extent of the boundary, a point is on it up to rounding."""

BESIDE = 1e-6
"""Distance, relative to its size, at which the inner side of a piece is looked up."""

Winding = Callable[..., Array]


@dataclass(frozen=True, eq=False)
class Signed:
    """The signed field of a closed boundary.

    Parameters
    ----------
    boundary
        The unsigned field.
    winding
        Winding number of the boundary about points, given by arrays of their coordinates.
    inward
        For each batch, +1 for pieces with the inside on the positive side, -1 on the negative one, 0 where both
        sides are alike (n,).
    tolerance
        Where the unsigned field is smaller, a point counts as a point of the boundary.
    """

    boundary: Joined
    winding: Winding
    inward: tuple[Array, ...]
    tolerance: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        w = self.boundary(*coords)
        value = value_of(w)
        if isinstance(value, Interval):
            return self._enclosure(w, value, coords)
        points = np.broadcast_arrays(*[np.asarray(value_of(x), dtype=np.float64) for x in coords])
        sign = np.asarray(np.where(np.abs(self.winding(*points)) > 0.5, 1.0, -1.0))
        near = np.broadcast_to(np.asarray(value) <= self.tolerance, sign.shape)
        if near.any():
            sign[near] = self._side([x[near] for x in points], sign[near])
        return w * (sign if sign.ndim else float(sign))

    def _enclosure(self, w: Value, value: Interval, coords: Sequence[Value]) -> Value:
        """Bounds over boxes: a box clear of the boundary lies on one side of it."""
        boxes = [Interval.of(value_of(x)) for x in coords]
        middles = np.broadcast_arrays(*[np.asarray(box.middle, dtype=np.float64) for box in boxes])
        inside = np.abs(self.winding(*middles)) > 0.5
        clear = value.lo > 0.0
        return w * Interval(np.where(clear & inside, 1.0, -1.0), np.where(clear & ~inside, -1.0, 1.0))

    def _side(self, points: Sequence[Array], sign: Array) -> Array:
        """Sign at points of the boundary: from the carrier of the nearest piece, + on it."""
        nearest = np.full(sign.shape, np.inf)
        for batch, inward in zip(self.boundary.batches, self.inward, strict=True):
            wide = [x[:, None] for x in points]
            w = np.asarray(batch.functions(*wide))
            index = w.argmin(axis=1)[:, None]
            side = np.where(cast(Sided, batch).side(*wide) >= 0.0, 1.0, -1.0) * inward
            w, side = (np.take_along_axis(a, index, axis=1)[:, 0] for a in (w, side))
            sign = np.where((w < nearest) & (side != 0.0), side, sign)
            nearest = np.minimum(nearest, w)
        return sign


def signed(boundary: Joined) -> Signed:
    """Signed field of closed curves of the plane, positive inside.

    Parameters
    ----------
    boundary
        Pieces of curves that continue each other to closed curves; several of them make holes when they run in
        opposite senses.

    Raises
    ------
    GeometryError
        When the pieces have no sides (points, curves in space) or leave a curve open.
    """
    curves = [batch for batch in boundary.batches if isinstance(batch, Curves) and batch.start.shape[1] == 2]
    if len(curves) != len(boundary.batches):
        raise GeometryError("a signed function needs closed curves in the plane or a closed surface")
    batches = closed(curves)
    corners = np.concatenate([points for batch in batches for points in (batch.start, batch.end)])

    def winding(x: Any, y: Any) -> Array:
        return winding_number(batches, x, y)

    return with_sign(Joined(batches, boundary.p), winding, float(np.abs(corners).max()))


def with_sign(boundary: Joined, winding: Winding, extent: float) -> Signed:
    """Signed field from the winding number; `extent` bounds the coordinates of the boundary."""
    inward = []
    for batch in boundary.batches:
        sided = cast(Sided, batch)
        points, normals = sided.samples()
        step = BESIDE * sided.size[:, None] * normals
        left, right = (np.abs(winding(*(points + s * step).T)) > 0.5 for s in (1.0, -1.0))
        inward.append(left.astype(np.float64) - right)
    return Signed(boundary, winding, tuple(inward), ON_BOUNDARY * extent)
