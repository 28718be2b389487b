r"""Circular arcs and circles, in the plane and in space.

Notation: an arc has centre c, radius R and half opening b (pi for a circle); m is the unit vector to its middle,
e the one from there counter-clockwise in its plane, h the height above the plane (in space).  The
carrier is the circle, ``f = (R^2 - r^2) / sqrt(2 (R^2 + r^2))`` with r in its plane; in space
f^2 + h^2 takes the place of f^2.

Up to a half circle the arc is trimmed by the ball around its middle through its ends; a longer one by the
outside of the ball around the opposite point.  Either meets the circle at the angle b'/2, b' = min(b,
pi - b), so t is divided by cos(b'/2): it too is normalised at the ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import where
from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry.boundaries.ends import ball_function, trimmed_around, trimmed_carrier
from rfm.geometry.boundaries.pieces import Curves, Joined, dot
from rfm.geometry.boundaries.segments import SAME_POINT, checked_points
from rfm.geometry.checks import number, positive, shown, vector

ON_CIRCLE = 1e-9
"""Relative deviation of the radii of the two ends of an arc that is put down to rounding."""


@dataclass(frozen=True, eq=False)
class Arcs(Curves):
    """Arcs with ends, centres, axes m and e (n, d), radii, half openings and senses (+1 or -1), (n,) each."""

    center: Array
    toward_middle: Array
    across: Array
    radius: Array
    half_opening: Array
    sense: Array

    @property
    def size(self) -> Array:
        """Radius of the trimming ball; that of a circle for a whole one."""
        ball = 2.0 * self.radius * np.sin(0.5 * np.minimum(self.half_opening, np.pi - self.half_opening))
        return np.where(self._whole, self.radius, ball)

    @property
    def _whole(self) -> Array:
        return np.asarray(self.half_opening == np.pi)

    def functions(self, *coords: Value) -> Value:
        """See :class:`Pieces`."""
        offsets = [x - c for x, c in zip(coords, self.center.T, strict=True)]
        first, second = dot(offsets, self.toward_middle.T), dot(offsets, self.across.T)
        if len(coords) == 2:
            f = ball_function(dot(offsets, offsets), self.radius) * self.sense
            return trimmed_carrier(f, self._trim(first, second * second), self.size)
        f = ball_function(first * first + second * second, self.radius)
        height = dot(offsets, np.cross(self.toward_middle, self.across).T)
        height = height * height
        t = self._trim(first, second * second + height)
        return trimmed_around(f * f + height, t, self.size)

    def _trim(self, first: Value, rest: Value) -> Value:
        """Positive around the arc; `rest` is the squared distance to the line along m."""
        size, long = self.size, self.half_opening > 0.5 * np.pi
        away = first - np.where(long, -self.radius, self.radius)
        narrow = np.where(long, np.pi - self.half_opening, self.half_opening)
        t = ball_function(away * away + rest, size) * (np.where(long, -1.0, 1.0) / np.cos(0.5 * narrow))
        return where(self._whole, size, t)

    def side(self, *coords: Array) -> Array:
        """Positive on the left of the arcs."""
        level = sum((x - c) ** 2 for x, c in zip(coords, self.center.T, strict=True))
        return np.asarray(self.sense * (self.radius**2 - level) / (2.0 * self.radius))

    def bulge(self, x: Array, y: Array, left: Array) -> Array:
        """One between arc and chord: inside the circle, and on the right of the chord when counter-clockwise."""
        inside = self.side(x, y) * self.sense > 0.0
        return np.where(inside & (self._whole | (left == (self.sense < 0.0))), self.sense, 0.0)

    def samples(self) -> tuple[Array, Array]:
        """Middles and left normals."""
        return self.center + self.radius[:, None] * self.toward_middle, -self.sense[
            :, None
        ] * self.toward_middle

    def reach(self, directions: Array) -> Array:
        """See :class:`Curves`; the farthest point of the circle where it is on the arc."""
        first, second = directions @ self.toward_middle.T, directions @ self.across.T
        on = np.abs(np.arctan2(second, first)) <= self.half_opening
        far = directions @ self.center.T + self.radius * np.hypot(first, second)
        return np.asarray(np.maximum(super().reach(directions), np.where(on, far, -np.inf).max(axis=1)))


def arc(center: Sequence[float], radius: float, start: float, end: float) -> Joined:
    """Arc of the plane between two angles in radians, counter-clockwise when `end` exceeds `start`.

    Raises
    ------
    GeometryError
        When the radius is not positive, the angles are equal, or differ by more than a full turn.
    """
    middle = vector("center", center, 2)
    radius = positive("radius", radius)
    start, end = number("start", start), number("end", end)
    opening = end - start
    if opening == 0.0:
        raise GeometryError(f"an arc from angle {start:g} to the same angle is a point")
    if abs(opening) > 2.0 * math.pi * (1.0 + ON_CIRCLE):
        raise GeometryError(f"an arc opens by at most a full turn, 2 pi, got {opening:g}")
    angle = 0.5 * (start + end)
    frame = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    half = math.pi if abs(opening) > 2.0 * math.pi * (1.0 - ON_CIRCLE) else 0.5 * abs(opening)
    return Joined((_single(middle, frame, radius, half, math.copysign(1.0, opening)),))


def circle(center: Sequence[float], radius: float) -> Joined:
    """Circle of the plane."""
    return arc(center, radius, 0.0, 2.0 * math.pi)


def arc_about(
    center: Sequence[float], start: Sequence[float], end: Sequence[float], *, clockwise: bool = False
) -> Joined:
    """Arc of the plane about a centre from one point to another; a circle when they coincide.

    Raises
    ------
    GeometryError
        When the centre is one of the points, or they are not at the same distance from it.
    """
    middle, first, last = vector("center", center, 2), vector("start", start, 2), vector("end", end, 2)
    radii = [float(np.linalg.norm(point - middle)) for point in (first, last)]
    for name, length in zip(("start", "end"), radii, strict=True):
        if length <= SAME_POINT * max(radii):
            raise GeometryError(f"the {name} of the arc is its center {shown(middle)}: the radius is zero")
    if abs(radii[1] - radii[0]) > ON_CIRCLE * radii[0]:
        raise GeometryError(
            f"the end {shown(last)} is not on the arc: its distance from the center is {radii[1]:.10g}, "
            f"that of the start {radii[0]:.10g}"
        )
    begin, finish = (math.atan2(*(point - middle)[::-1]) for point in (first, last))
    opening = (finish - begin) % (2.0 * math.pi)
    if clockwise or opening == 0.0:
        opening = opening - 2.0 * math.pi if clockwise else 2.0 * math.pi
    return arc(middle.tolist(), 0.5 * (radii[0] + radii[1]), begin, begin + opening)


def arc_through(start: Sequence[float], middle: Sequence[float], end: Sequence[float]) -> Joined:
    """Arc from `start` through `middle` to `end`, in the plane or in space.

    Raises
    ------
    GeometryError
        When two of the points coincide or the three lie on a line.
    """
    a, b, c = checked_points([start, middle, end], "an arc", 3)
    first, second = b - a, c - a
    sides = np.linalg.norm([first, c - b, second], axis=1)
    if sides.min() <= SAME_POINT * sides.max():
        raise GeometryError("the three points of an arc must differ, got " + shown([a, b, c]))
    # the circumcentre a + s first + t second is equally far from all three
    gram = np.array([[first @ first, first @ second], [first @ second, second @ second]])
    if np.linalg.det(gram) <= ON_CIRCLE**2 * sides.max() ** 4:
        raise GeometryError("the three points of an arc lie on a line: " + shown([a, b, c]))
    s, t = np.linalg.solve(gram, 0.5 * np.diagonal(gram))
    center = a + s * first + t * second
    radius = float(np.linalg.norm(a - center))
    x = (a - center) / radius
    # of the two chords the one farther from x tells the plane best
    y = max((ray - (ray @ x) * x for ray in (first, second)), key=np.linalg.norm)
    y = y / np.linalg.norm(y)
    turns = [math.atan2(float(ray @ y), float(ray @ x)) % (2.0 * math.pi) for ray in (b - center, c - center)]
    turn = turns[1]
    if turns[0] > turn:  # the other way round the middle comes before the end
        y, turn = -y, 2.0 * math.pi - turn
    angle = 0.5 * turn
    axes = np.array([x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle)])
    if len(a) == 2 and axes[0, 0] * axes[1, 1] < axes[0, 1] * axes[1, 0]:
        return Joined((_single(center, axes * [[1.0], [-1.0]], radius, angle, -1.0),))
    return Joined((_single(center, axes, radius, angle, 1.0),))


def _single(center: Array, frame: Array, radius: float, half_opening: float, sense: float) -> Arcs:
    offsets = [
        radius * (math.cos(half_opening) * frame[0] + side * sense * math.sin(half_opening) * frame[1])
        for side in (-1.0, 1.0)
    ]
    start, end = (np.asarray(center + offset)[None] for offset in offsets)
    numbers = (np.array([number]) for number in (radius, half_opening, sense))
    return Arcs(
        start, start if half_opening == math.pi else end, center[None], frame[:1], frame[1:], *numbers
    )
