"""Primitives of the plane.

Every constructor returns a :class:`~rfm.geometry.shape.Shape`; the surface functions are those of
``rfm.geometry.carriers``.  Angles are in radians.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.box import Box
from rfm.geometry.carriers import Plane, Sphere, plane, quadric
from rfm.geometry.checks import number, positive, shown, unit, vector
from rfm.geometry.shape import Shape, meet, single
from rfm.geometry.surface import Surface

Vector = Sequence[float] | Array


def half_plane(point: Vector, normal: Vector) -> Shape:
    """Return the side of the line through ``point`` into which ``normal`` points."""
    return linear_half(point, normal, 2)


def disk(center: Vector, radius: float) -> Shape:
    """Open disk; one surface."""
    return round_ball(center, radius, 2)


def ellipse(center: Vector, semi_axes: Vector, angle: float = 0.0) -> Shape:
    """Ellipse with its first semi-axis turned by ``angle`` from the x axis; one surface."""
    middle, lengths = vector("center", center, 2), axes_lengths(semi_axes, 2)
    angle = number("angle", angle)
    cos, sin = np.cos(angle), np.sin(angle)
    return quadric_ellipsoid(middle, lengths, np.array([[cos, sin], [-sin, cos]]))


def rectangle(min: Vector, max: Vector) -> Shape:
    """Axis-parallel rectangle; surfaces left, right (x), bottom, top (y)."""
    return aligned_block(min, max, (("left", "right"), ("bottom", "top")))


def strip(point: Vector, normal: Vector, width: float) -> Shape:
    """Points closer than ``width / 2`` to the line through ``point``; surfaces lower, upper along ``normal``."""
    return parallel_pair(point, normal, width, 2)


def linear_half(point: Vector, normal: Vector, dimension: int) -> Shape:
    """Half-plane or half-space."""
    base, inward = vector("point", point, dimension), unit("normal", normal, dimension)
    function = plane(inward, float(inward @ base))
    surface = Surface((), function, degree=1, normalised=True)
    return single(surface, dimension, support.half_space(base, inward), support.half_space(base, -inward))


def round_ball(center: Vector, radius: float, dimension: int) -> Shape:
    """Disk or ball."""
    middle, radius = vector("center", center, dimension), positive("radius", radius)
    function = Sphere(tuple(middle.tolist()), radius)
    surface = Surface((), function, degree=2, size=radius, normalised=True, peak=0.5 * radius)
    return single(surface, dimension, support.ball(middle, radius))


def quadric_ellipsoid(center: Array, lengths: Array, rows: Array) -> Shape:
    """Ellipse or ellipsoid with orthonormal axis directions ``rows``.

    ``s/2 (1 - sum_j (rows_j . (x - center) / lengths_j)^2)`` with s the shortest semi-axis: slope 1 at
    the ends of that axis, ``s / lengths_j`` at the others.
    """
    shortest = float(lengths.min())
    factors = -0.5 * shortest / lengths**2
    function = quadric(0.5 * shortest, factors, rows, center)
    alike = bool(np.all(lengths == shortest))
    surface = Surface((), function, degree=2, size=shortest, normalised=alike, peak=0.5 * shortest)
    return single(surface, len(center), support.ellipsoid(center, lengths[:, None] * rows))


def aligned_block(lower: Vector, upper: Vector, names: tuple[tuple[str, str], ...]) -> Shape:
    """Rectangle or box; ``names`` are the labels at the lower and upper end of every axis."""
    dimension = len(names)
    low, high = vector("min", lower, dimension), vector("max", upper, dimension)
    if not (low < high).all():
        raise GeometryError(
            f"max must exceed min in every component, got min {shown(low)}, max {shown(high)}"
        )
    surfaces = []
    for axis, (first, second) in enumerate(names):
        normal = np.eye(dimension)[axis]
        size = 0.5 * float(high[axis] - low[axis])
        for label, function in (
            (first, plane(normal, float(low[axis]))),
            (second, plane(-normal, -float(high[axis]))),
        ):
            surfaces.append(Surface((label,), function, degree=1, size=size, normalised=True))
    box = Box(tuple(low.tolist()), tuple(high.tolist()))
    return meet(surfaces, dimension, support.aligned(box))


def parallel_pair(point: Vector, normal: Vector, width: float, dimension: int) -> Shape:
    """Strip or slab."""
    base, direction = vector("point", point, dimension), unit("normal", normal, dimension)
    half = 0.5 * positive("width", width)
    level = float(direction @ base)
    functions: dict[str, Plane] = {
        "lower": plane(direction, level - half),
        "upper": plane(-direction, -level - half),
    }
    surfaces = [
        Surface((label,), function, degree=1, size=half, normalised=True)
        for label, function in functions.items()
    ]
    sides = [support.half_space(base - sign * half * direction, sign * direction) for sign in (1.0, -1.0)]
    return meet(surfaces, dimension, support.common(*sides))


def axes_lengths(semi_axes: Vector, dimension: int) -> Array:
    """Check semi-axes."""
    lengths = vector("semi_axes", semi_axes, dimension)
    if not (lengths > 0.0).all():
        raise GeometryError(f"semi_axes must be positive, got {shown(lengths)}")
    return lengths
