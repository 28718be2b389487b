r"""Arcs of parabolas, in the plane and in space: Bezier curves of degree two.

Notation: the arc is ``P(r) = o + r a_1 + r^2 a_2``, 0 <= r <= 1.  The skew coordinates (r, s) of its plane with
``x = o + r a_1 + s a_2`` turn the parabola into s = r^2, so that ``g = s - r^2`` is its carrier, zero nowhere
else and with a gradient that vanishes nowhere; ``f = g / |grad g|`` is normalised.  The strip 0 <= r <= 1
holds the arc and nothing else of the parabola: it is trimmed by that strip, intersected with a ball that
holds the arc with room to spare, so that the function grows with the distance along the branches too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import sqrt
from rfm.calculus.types import Array, Value
from rfm.geometry.boundaries.ends import (
    ball_function,
    conjunction_on_carrier,
    trimmed_around,
    trimmed_carrier,
)
from rfm.geometry.boundaries.pieces import Curves, dot

HALF = np.array(0.5)


@dataclass(frozen=True, eq=False)
class Parabolas(Curves):
    """Arcs with ends, dual vectors of a_1 and a_2 (n, 2, d), lengths (n,) and balls around them."""

    dual: Array
    length: Array
    center: Array
    radius: Array

    @property
    def size(self) -> Array:
        """Half the mean of the speeds at the ends: about half the length."""
        return 0.5 * self.length

    def functions(self, *coords: Value) -> Value:
        """See :class:`Pieces`."""
        offsets = [x - c for x, c in zip(coords, self.start.T, strict=True)]
        r, g = self._skew(offsets)
        slopes = [
            second - 2.0 * r * first for first, second in zip(*self.dual.transpose(1, 2, 0), strict=True)
        ]
        f = g / sqrt(dot(slopes, slopes))
        squared = f * f
        if len(coords) == 3:
            normal = np.cross(self.dual[:, 0], self.dual[:, 1])
            height = dot(offsets, (normal / np.linalg.norm(normal, axis=1)[:, None]).T)
            squared = squared + height * height
        t = slab(r, self.length, self.center, self.radius, squared, coords)
        if len(coords) == 2:
            return trimmed_carrier(f * self._sense, t, self.size)
        return trimmed_around(squared, t, self.size)

    def side(self, *coords: Array) -> Array:
        """Positive on the left: inside a parabola that turns left."""
        _, g = self._skew([x - c for x, c in zip(coords, self.start.T, strict=True)])
        return np.asarray(g * self._sense)

    def samples(self) -> tuple[Array, Array]:
        """Points at r = 1/2 and left normals."""
        basis = np.linalg.inv(self.dual).transpose(0, 2, 1)
        tangent = basis[:, 0] + basis[:, 1]
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
        points = self.start + 0.5 * basis[:, 0] + 0.25 * basis[:, 1]
        return points, normal / np.linalg.norm(normal, axis=1)[:, None]

    def bulge(self, x: Array, y: Array, left: Array) -> Array:
        """One between arc and chord, as for arcs of circles."""
        sense = self._sense
        return np.where((self.side(x, y) * sense > 0.0) & (left == (sense < 0.0)), sense, 0.0)

    def reach(self, directions: Array) -> Array:
        """See :class:`Curves`; the vertex of ``n . P(r)`` where it is on the arc."""
        linear, square = (directions @ vectors.T for vectors in np.linalg.inv(self.dual).transpose(2, 0, 1))
        with np.errstate(divide="ignore", invalid="ignore"):
            r = np.clip(np.nan_to_num(-0.5 * linear / square), 0.0, 1.0)
        inner = directions @ self.start.T + (linear + square * r) * r
        return np.asarray(np.maximum(super().reach(directions), inner.max(axis=1)))

    @property
    def _sense(self) -> Array:
        """Tell the way it turns: +1 to the left."""
        return np.asarray(np.sign(np.linalg.det(self.dual)))

    def _skew(self, offsets: list[Value]) -> tuple[Value, Value]:
        r, s = (dot(offsets, self.dual[:, k].T) for k in (0, 1))
        return r, s - r * r


def slab(
    r: Value, length: Array, center: Array, radius: Array, squared: Value, coords: Sequence[Value]
) -> Value:
    """Trimming function of 0 <= r <= 1 inside the balls, for a carrier whose function has this square.

    Parameters
    ----------
    r
        Skew coordinate, which runs from 0 to 1 along the piece.
    length
        Unit of length of r.
    center, radius
        Balls with room around the pieces, (n, d) and (n,).
    squared
        Square of the carrier's normalised function.
    coords
        The coordinates.
    """
    middle = r - 0.5
    offsets = [x - c for x, c in zip(coords, center.T, strict=True)]
    ball = ball_function(dot(offsets, offsets), radius)
    return conjunction_on_carrier(ball_function(middle * middle, HALF) * length, ball, squared, radius)


def parabola(control: Array) -> Parabolas:
    """Arc with three control points (3, d) that do not lie on a line, as a batch of one."""
    first, second = 2.0 * (control[1] - control[0]), control[0] - 2.0 * control[1] + control[2]
    dual = np.linalg.pinv(np.stack([first, second])).T
    length = 0.5 * (np.linalg.norm(first) + np.linalg.norm(first + 2.0 * second))
    center, radius = ball_around(control)
    return Parabolas(control[:1], control[2:], dual[None], np.array([length]), center, radius)


def ball_around(control: Array) -> tuple[Array, Array]:
    """Centre (1, d) and radius (1,) of a ball of twice the size of the control points."""
    center = 0.5 * (control.min(axis=0) + control.max(axis=0))
    return center[None], np.asarray(2.0 * np.linalg.norm(control - center, axis=1).max(keepdims=True))
