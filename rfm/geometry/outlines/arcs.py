"""Circular arcs between two points, and where lines and arcs meet.

Notation: an arc runs from a to b and sweeps the angle ``theta`` (positive counter-clockwise) about its
center; its *bulge* is ``tan(theta / 4)`` as in DXF files: 0 for a line, 1 for half a circle with its middle
to the right of the chord.  With L the length of the chord, ``r = L (1 + bulge^2) / (4 |bulge|)`` and the
height of the arc above its chord is ``|bulge| L / 2``.  The *lens* is the set between arc and chord.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.checks import number, shown, vector

_REACH = 1e-9
"""Relative difference allowed between the distances of a center to the ends of its arc."""


@dataclass(frozen=True, eq=False)
class Edge:
    """A line (bulge 0) or an arc from one point to another; ``index`` is the edge of the outline."""

    start: Array
    end: Array
    bulge: float
    index: int

    @property
    def chord(self) -> Array:
        """Vector from start to end."""
        return np.asarray(self.end - self.start)

    @property
    def length(self) -> float:
        """Length of the chord."""
        return float(np.hypot(*self.chord))

    @property
    def left(self) -> Array:
        """Unit normal to the left of the chord."""
        return np.array([-self.chord[1], self.chord[0]]) / self.length

    @property
    def center(self) -> Array:
        """Center of the circle."""
        height = self.length * (1.0 - self.bulge**2) / (4.0 * self.bulge)
        return np.asarray(0.5 * (self.start + self.end) + height * self.left)

    @property
    def radius(self) -> float:
        """Radius of the circle."""
        return self.length * (1.0 + self.bulge**2) / (4.0 * abs(self.bulge))

    @property
    def middle(self) -> Array:
        """Point half-way along."""
        return np.asarray(0.5 * (self.start + self.end) - 0.5 * self.bulge * self.length * self.left)

    @property
    def lens_area(self) -> float:
        """Area between arc and chord, positive to the right of the chord."""
        sweep = 4.0 * math.atan(self.bulge)
        return 0.5 * self.radius**2 * (sweep - math.sin(sweep)) if self.bulge else 0.0

    def reversed(self) -> Edge:
        """Return the edge walked backwards."""
        return Edge(self.end, self.start, -self.bulge, self.index)

    def straight(self) -> Edge:
        """Return the chord as an edge."""
        return Edge(self.start, self.end, 0.0, self.index)

    def halves(self) -> tuple[Edge, Edge]:
        """Both halves of an arc."""
        middle, bulge = self.middle, math.tan(0.5 * math.atan(self.bulge))
        return Edge(self.start, middle, bulge, self.index), Edge(middle, self.end, bulge, self.index)

    def beyond(self, points: Array) -> Array:
        """How far points lie beyond the chord, on the side of the arc."""
        return np.asarray(-math.copysign(1.0, self.bulge) * ((points - self.start) @ self.left))

    def in_lens(self, points: Array, margin: float = 0.0) -> NDArray[np.bool_]:
        """Which points ``(n, 2)`` lie between chord and arc, ``margin`` at most outside."""
        if not self.bulge:
            return np.zeros(len(points), dtype=bool)
        deep = self.radius - np.hypot(*(points - self.center).T)
        return np.asarray((deep > -margin) & (self.beyond(points) > -margin))

    def distance(self, points: Array) -> Array:
        """Distance of points ``(n, 2)`` to the edge."""
        ends = np.minimum(np.hypot(*(points - self.start).T), np.hypot(*(points - self.end).T))
        if self.bulge:
            around = np.abs(np.hypot(*(points - self.center).T) - self.radius)
            return np.asarray(np.where(self.beyond(points) > 0.0, np.minimum(around, ends), ends))
        along = np.clip((points - self.start) @ self.chord / self.length**2, 0.0, 1.0)
        return np.asarray(np.hypot(*(points - self.start - along[:, None] * self.chord).T))


def bulge_of(start: Array, end: Array, given: Mapping[str, Any], name: str) -> float:
    """Bulge of an arc from one of ``bulge``, ``through``, ``radius``, ``center`` (with ``clockwise``).

    Raises
    ------
    GeometryError
        When none or several are given, or the arc does not exist.
    """
    kinds = [key for key in ("bulge", "through", "radius", "center") if given.get(key) is not None]
    if len(kinds) != 1:
        raise GeometryError(f"{name}: an arc needs exactly one of bulge, through, radius, center")
    chord = end - start
    length = float(np.hypot(*chord))
    if kinds[0] == "bulge":
        return number(f"{name}: bulge", given["bulge"])
    if kinds[0] == "through":
        point = vector(f"{name}: through", given["through"], 2)
        before, after = point - start, end - point
        turn = math.atan2(before[0] * after[1] - before[1] * after[0], float(before @ after))
        if min(np.hypot(*before), np.hypot(*after)) <= 1e-12 * length or abs(turn) > math.pi - 1e-9:
            raise GeometryError(f"{name}: no arc passes through {shown(point)} between its ends")
        return math.tan(0.5 * turn)
    if kinds[0] == "radius":
        radius = number(f"{name}: radius", given["radius"])
        if abs(radius) < 0.5 * length * (1.0 - _REACH):
            raise GeometryError(
                f"{name}: radius {shown(radius)} is too small, its ends are {shown(length)} apart: "
                f"at least {shown(0.5 * length)} is needed"
            )
        return math.copysign(math.tan(0.5 * math.asin(min(1.0, 0.5 * length / abs(radius)))), radius)
    return _about(
        start, end, vector(f"{name}: center", given["center"], 2), bool(given.get("clockwise")), name
    )


def _about(start: Array, end: Array, center: Array, clockwise: bool, name: str) -> float:
    first, second = start - center, end - center
    reach = [float(np.hypot(*first)), float(np.hypot(*second))]
    if abs(reach[0] - reach[1]) > _REACH * max(reach) or not min(reach):
        raise GeometryError(
            f"{name}: the arc about {shown(center)} does not reach its end: "
            f"its ends are {shown(reach[0])} and {shown(reach[1])} away"
        )
    sweep = math.atan2(first[0] * second[1] - first[1] * second[0], float(first @ second))
    if clockwise and sweep > 0.0:
        sweep -= 2.0 * math.pi
    elif not clockwise and sweep < 0.0:
        sweep += 2.0 * math.pi
    return math.tan(0.25 * sweep)


def meeting(first: Edge, second: Edge, tolerance: float) -> Array | None:
    """Find a point that two edges share other than a common end; None when there is none."""
    points = [first.start, first.end, second.start, second.end, *_crossings(first, second)]
    candidates = np.array(points)
    near = (first.distance(candidates) <= tolerance) & (second.distance(candidates) <= tolerance)
    for a in (first.start, first.end):
        for b in (second.start, second.end):
            if np.hypot(*(a - b)) <= tolerance:
                near &= np.hypot(*(candidates - a).T) > 4.0 * tolerance
    return np.asarray(candidates[near][0]) if near.any() else None


def _crossings(first: Edge, second: Edge) -> Sequence[Array]:
    if first.bulge and second.bulge:
        return circle_circle(first.center, first.radius, second.center, second.radius)
    if first.bulge or second.bulge:
        arc, line = (first, second) if first.bulge else (second, first)
        return circle_line(arc.center, arc.radius, line.left, float(line.left @ line.start))
    return line_line(
        first.left, float(first.left @ first.start), second.left, float(second.left @ second.start)
    )


def line_line(m: Array, p: float, n: Array, q: float) -> list[Array]:
    """Common point of the lines ``m . x = p`` and ``n . x = q``."""
    across = m[0] * n[1] - m[1] * n[0]
    if abs(across) < 1e-12:
        return []
    return [np.array([p * n[1] - q * m[1], m[0] * q - n[0] * p]) / across]


def circle_line(center: Array, radius: float, n: Array, q: float) -> list[Array]:
    """Common points of a circle and the line ``n . x = q`` (one where they touch, to rounding)."""
    height = q - float(n @ center)
    half = math.sqrt(max(0.0, radius**2 - height**2))
    if abs(height) > radius * (1.0 + 1e-12):
        return []
    foot, along = center + height * n, np.array([-n[1], n[0]])
    return [foot + half * along, foot - half * along]


def circle_circle(center: Array, radius: float, other: Array, other_radius: float) -> list[Array]:
    """Common points of two circles; none when they are the same."""
    apart = other - center
    distance = float(np.hypot(*apart))
    if distance <= 1e-12 * max(radius, other_radius):
        return []
    n = apart / distance
    height = 0.5 * (distance + (radius**2 - other_radius**2) / distance)
    return circle_line(center, radius, n, float(n @ center) + height)
