"""Points in every face, edge and vertex of an arrangement of lines and circles.

On each of them every Boolean expression of the curves has one truth value, so these points decide
whether an expression is the given set: its sign (minimum and maximum of the signs -1, 0, 1) must be 0 at
boundary points, 1 inside, -1 outside.  Zeros elsewhere would mean that the function is not properly signed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.carriers import Plane, Sphere
from rfm.geometry.outlines.arcs import circle_circle, circle_line, line_line


@dataclass(frozen=True, eq=False)
class Curve:
    """A line ``n . x = q`` or (``radius``) a circle."""

    point: Array
    radius: float
    offset: float = 0.0

    def distance(self, points: Array) -> Array:
        """Distance of points ``(n, 2)``."""
        if self.radius:
            return np.asarray(np.abs(np.hypot(*(points - self.point).T) - self.radius))
        return np.asarray(np.abs(points @ self.point - self.offset))

    def at(self, parameters: Array) -> Array:
        """Points at angles, or at positions along the line."""
        if self.radius:
            return self.point + self.radius * np.stack([np.cos(parameters), np.sin(parameters)], axis=1)
        along = np.array([-self.point[1], self.point[0]])
        return np.asarray(self.offset * self.point + parameters[:, None] * along)

    def parameters(self, points: Array) -> Array:
        """Inverse of :meth:`at`."""
        if self.radius:
            return np.asarray(np.arctan2(*(points - self.point).T[::-1]))
        return np.asarray(points @ np.array([-self.point[1], self.point[0]]))

    def normals(self, points: Array) -> Array:
        """Unit normals at points of the curve."""
        if self.radius:
            return np.asarray((points - self.point) / self.radius)
        return np.broadcast_to(self.point, points.shape)


def curve(carrier: Plane | Sphere) -> Curve:
    """Curve on which a carrier of the plane vanishes."""
    if isinstance(carrier, Sphere):
        return Curve(np.array(carrier.center), carrier.radius)
    return Curve(np.array(carrier.normal), 0.0, carrier.offset)


def representatives(curves: list[Curve], extent: float) -> Array:
    """At least one point on every vertex, edge and face of the arrangement, ``(n, 2)``."""
    vertices = [
        point
        for i, first in enumerate(curves)
        for second in curves[i + 1 :]
        for point in _common(first, second)
        if np.isfinite(point).all()
    ]
    corners = np.array(vertices).reshape(-1, 2)
    found = [corners]
    for number, one in enumerate(curves):
        own = corners[one.distance(corners) <= 1e-9 * extent]
        middles = one.at(_between(np.sort(one.parameters(own)), bool(one.radius), extent))
        others = [other.distance(middles) for k, other in enumerate(curves) if k != number]
        room = np.min(others, axis=0, initial=extent if not one.radius else one.radius)
        step = 0.3 * room[:, None] * one.normals(middles)
        found += [middles, middles + step, middles - step]
    return np.concatenate(found)


def _between(parameters: Array, closed: bool, extent: float) -> Array:
    """Parameters between those of the vertices, and beyond the outermost ones."""
    if not len(parameters):
        return np.zeros(1)
    gaps = np.diff(parameters) > 1e-12 * (1.0 if closed else extent)
    inner = 0.5 * (parameters[1:] + parameters[:-1])[gaps]
    if closed:
        return np.append(inner, 0.5 * (parameters[0] + parameters[-1]) + math.pi)
    return np.concatenate([[parameters[0] - extent], inner, [parameters[-1] + extent]])


def _common(first: Curve, second: Curve) -> list[Array]:
    if first.radius and second.radius:
        return circle_circle(first.point, first.radius, second.point, second.radius)
    if first.radius or second.radius:
        circle, line = (first, second) if first.radius else (second, first)
        return circle_line(circle.point, circle.radius, line.point, line.offset)
    return line_line(first.point, first.offset, second.point, second.offset)
