"""Primitives of space.

Every constructor returns a :class:`~rfm.geometry.shape.Shape`; the surface functions are those of
``rfm.geometry.carriers``.  Angles are in radians.
"""

from __future__ import annotations

import numpy as np

from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.carriers import Torus, plane, quadric
from rfm.geometry.checks import number, positive, shown, unit, vector
from rfm.geometry.primitives_2d import (
    Vector,
    aligned_block,
    axes_lengths,
    linear_half,
    parallel_pair,
    quadric_ellipsoid,
    round_ball,
)
from rfm.geometry.shape import Shape, meet, single
from rfm.geometry.similarity import frame, rodrigues
from rfm.geometry.surface import Surface


def half_space(point: Vector, normal: Vector) -> Shape:
    """Return the side of the plane through ``point`` into which ``normal`` points."""
    return linear_half(point, normal, 3)


def ball(center: Vector, radius: float) -> Shape:
    """Open ball; one surface."""
    return round_ball(center, radius, 3)


def ellipsoid(center: Vector, semi_axes: Vector, angle: float = 0.0, axis: Vector = (0.0, 0.0, 1.0)) -> Shape:
    """Ellipsoid with semi-axes along x, y, z, then turned by ``angle`` about ``axis``; one surface."""
    middle, lengths = vector("center", center, 3), axes_lengths(semi_axes, 3)
    turn = rodrigues(unit("axis", axis, 3), number("angle", angle))
    return quadric_ellipsoid(middle, lengths, turn.T)


def box(min: Vector, max: Vector) -> Shape:
    """Axis-parallel box; surfaces left, right (x), front, back (y), bottom, top (z)."""
    return aligned_block(min, max, (("left", "right"), ("front", "back"), ("bottom", "top")))


def slab(point: Vector, normal: Vector, width: float) -> Shape:
    """Points closer than ``width / 2`` to the plane through ``point``; surfaces lower, upper along ``normal``."""
    return parallel_pair(point, normal, width, 3)


def cylinder(center: Vector, axis: Vector, radius: float, height: float | None = None) -> Shape:
    """Round cylinder around the line through ``center``; with ``height``, cut ``height / 2`` either way.

    Surfaces lateral and, when finite, bottom and top (in the direction of ``axis``).
    """
    middle, direction = vector("center", center, 3), unit("axis", axis, 3)
    radius = positive("radius", radius)
    rows = frame(direction)
    across = quadric(0.5 * radius, np.full(2, -0.5 / radius), rows[:2], middle)
    lateral = Surface(("lateral",), across, degree=2, size=radius, normalised=True, peak=0.5 * radius)
    disk = support.disk_across(middle, direction, radius)
    if height is None:
        return single(lateral, 3, support.minkowski_sum(disk, support.line(0.0 * middle, direction)))
    half = 0.5 * positive("height", height)
    level = float(direction @ middle)
    bottom = Surface(("bottom",), plane(direction, level - half), degree=1, size=half, normalised=True)
    top = Surface(("top",), plane(-direction, -level - half), degree=1, size=half, normalised=True)
    ends = support.points(half * np.array([-direction, direction]))
    return meet([lateral, bottom, top], 3, support.minkowski_sum(disk, ends))


def cone(apex: Vector, axis: Vector, radius: float, height: float) -> Shape:
    """Round cone with its tip at ``apex``; its base has ``radius`` at distance ``height`` along ``axis``.

    Surfaces lateral and base.  The lateral function ``((m t)^2 - s^2) / (2 radius sqrt(1 + m^2))``,
    ``m = radius / height``, has slope 1 at the base; a plane through the tip removes the second nappe.
    """
    tip, direction = vector("apex", apex, 3), unit("axis", axis, 3)
    radius, height = positive("radius", radius), positive("height", height)
    slope = radius / height
    scale = 0.5 / (radius * np.hypot(1.0, slope))
    rows = frame(direction)
    function = quadric(0.0, scale * np.array([-1.0, -1.0, slope**2]), rows, tip)
    lateral = Surface(("lateral",), function, degree=2, size=0.5 * radius)
    level = float(direction @ tip)
    half = 0.5 * height
    base = Surface(("base",), plane(-direction, -level - height), degree=1, size=half, normalised=True)
    nappe = Surface(("nappe",), plane(direction, level), degree=1, size=half, normalised=True, auxiliary=True)
    rim = support.disk_across(tip + height * direction, direction, radius)
    return meet([lateral, base, nappe], 3, support.either(support.points(tip[None, :]), rim))


def torus(center: Vector, axis: Vector, major_radius: float, minor_radius: float) -> Shape:
    """Ring torus: a tube of ``minor_radius`` around a circle of ``major_radius``; one surface."""
    middle, direction = vector("center", center, 3), unit("axis", axis, 3)
    major, minor = positive("major_radius", major_radius), positive("minor_radius", minor_radius)
    if minor >= major:
        raise GeometryError(
            f"minor_radius must be smaller than major_radius, got {shown(minor_radius)} and {shown(major_radius)}"
        )
    first, second, along = (plane(row, float(row @ middle)) for row in frame(direction))
    function = Torus(major, minor, (first, second), along)
    surface = Surface((), function, degree=4, size=minor, peak=0.5 * minor)
    ring = support.disk_across(middle, direction, major)
    return single(surface, 3, support.minkowski_sum(ring, support.ball(0.0 * middle, minor)))
