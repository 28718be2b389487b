"""Offsets and shells.

Notation: d is the distance, positive outward.  Every surface is moved by d along its normal, so convex
corners stay sharp (they are mitred, not rounded).  Exact for lines and planes, circles, spheres, round
cylinders and tori, whose functions stay polynomials; any other function f becomes ``w + d``, w its version of
unit slope (4.9), which is right to first order in d.  With ``f = (R^2 - s^2)/(2R)`` the offset of a round surface is
``(2 R f + 2 R d + d^2) / (2 (R + d))``.  The shell of thickness t is the set without its offset by -t.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.blending.operands import levelled, widened
from rfm.geometry.carriers import Plane, Sphere, Torus
from rfm.geometry.checks import number, positive, shown
from rfm.geometry.shape import Membership, Shape
from rfm.geometry.surface import Surface


@dataclass(frozen=True, eq=False)
class Shifted:
    """The field ``factor * field + shift``."""

    field: Field
    factor: float
    shift: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value = self.field(*coords)
        return (value if self.factor == 1.0 else self.factor * value) + self.shift


def offset(of: Shape, distance: float) -> Shape:
    """Move the boundary of a shape outward, or inward for a negative distance; labels stay.

    Raises
    ------
    GeometryError
        For a distance that makes a feature vanish: the shape itself inward, a hole in it outward.
    """
    distance = number("distance", distance)
    solid = {literal.surface for literal in of.expression.literals() if literal.positive}
    holes = {literal.surface for literal in of.expression.literals() if not literal.positive}
    if solid & holes:
        raise GeometryError("a shape that lies on both sides of one of its surfaces has no offset")
    if distance < 0.0:
        _require(min((s.size for s in solid), default=-distance), -distance, "shape", distance)
    elif distance > 0.0:
        _require(
            min((s.size for s in holes if s.degree != 1), default=2 * distance), distance, "hole", distance
        )
    signed = {surface: distance if surface in solid else -distance for surface in solid | holes}
    expression = of.expression.mapped(lambda surface: moved(surface, signed[surface]))
    if distance <= 0.0:
        return Shape(of.dimension, expression, of.reach)
    field = Membership(expression)
    return Shape(of.dimension, expression, widened(of.reach, field, distance, of.dimension, "the offset"))


def shell(of: Shape, thickness: float) -> Shape:
    """Hollow shape: the layer of the given thickness inside the boundary; its inner surfaces are ``inner...``.

    Raises
    ------
    GeometryError
        For a thickness that is not positive or as large as the of.
    """
    thickness = positive("thickness", thickness)
    return of - offset(of, -thickness).named("inner")


def moved(surface: Surface, distance: float) -> Surface:
    """Move one surface by a distance away from its inner side."""
    if distance == 0.0:
        return surface
    size = surface.size + distance
    function = surface.function
    if isinstance(function, Plane):
        length = sum(component**2 for component in function.normal) ** 0.5
        return replace(
            surface, function=Plane(function.normal, function.offset - distance * length), size=size
        )
    if isinstance(function, Torus):
        # a scaled one has its functions scaled along: the minor radius is the size
        return replace(
            surface, function=replace(function, minor=function.minor + distance), size=size, peak=0.5 * size
        )
    if isinstance(function, Sphere):
        return replace(surface, function=replace(function, radius=size), size=size, peak=0.5 * size)
    if surface.normalised and surface.degree == 2 and surface.peak == 0.5 * surface.size:
        radius = surface.size
        around = Shifted(function, radius / size, (2.0 * radius + distance) * distance / (2.0 * size))
        return replace(surface, function=around, size=size, peak=0.5 * size)
    return replace(
        surface,
        function=Shifted(levelled(surface), 1.0, distance),
        degree=None,
        size=size,
        normalised=False,
        peak=surface.peak + distance,
    )


def _require(size: float, needed: float, what: str, distance: float) -> None:
    if needed >= size:
        raise GeometryError(f"distance {shown(distance)} makes the {what} vanish: its size is {size:.6g}")
