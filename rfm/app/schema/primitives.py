"""Primitive shapes of a case, one model for each kind.

The keys of a kind are the arguments of its constructor in :mod:`rfm.geometry.primitives`; angles are in
degrees here and in radians there.
"""

from __future__ import annotations

from pydantic import ValidationInfo, model_validator

from rfm.app.schema.kind import Kind
from rfm.app.schema.scalars import (
    Corners,
    Datum,
    Number,
    Positive,
    PositiveVector,
    Vector,
    fail,
    scope_of,
)


class Interval(Kind):
    """Numbers between two ends, bottom and top; a factor of products such as disk @ interval."""

    dimension = 1
    min: Number
    max: Number

    @model_validator(mode="after")
    def _ordered(self) -> Interval:
        if self.max <= self.min:
            raise fail(f"must exceed min, got {self.max:g} and min {self.min:g}", value=("max",))
        return self


class Plane(Kind):
    """Everything on the side of a line or plane into which the normal points."""

    point: Vector
    normal: Vector


class HalfPlane(Plane):
    """Points of the plane on the side of a line into which the normal points."""

    dimension = 2


class HalfSpace(Plane):
    """Points of space on the side of a plane into which the normal points."""

    dimension = 3


class Round(Kind):
    """Everything closer to the center than the radius."""

    center: Vector
    radius: Positive


class Disk(Round):
    """Disk."""

    dimension = 2


class Ball(Round):
    """Ball."""

    dimension = 3


class Ellipse(Kind):
    """Ellipse; `angle` turns its first semi-axis from the x axis."""

    dimension = 2
    center: Vector
    semi_axes: PositiveVector
    angle: Number = 0.0


class Ellipsoid(Kind):
    """Ellipsoid with semi-axes along x, y, z, turned by `angle` about `axis`."""

    dimension = 3
    center: Vector
    semi_axes: PositiveVector
    angle: Number = 0.0
    axis: Vector = (0.0, 0.0, 1.0)


class Block(Kind):
    """Everything between two corners."""

    min: Vector
    max: Vector

    @model_validator(mode="after")
    def _ordered(self) -> Block:
        for axis, low, high in zip("xyz", self.min, self.max, strict=False):
            if high <= low:
                raise fail(f"must exceed min in {axis}, got {high:g} and min {low:g}", value=("max",))
        return self


class Rectangle(Block):
    """Axis-parallel rectangle with the sides left, right, bottom, top."""

    dimension = 2


class Box(Block):
    """Axis-parallel box with the faces left, right (x), front, back (y), bottom, top (z)."""

    dimension = 3


class Layer(Kind):
    """Everything closer than half the width to a line or plane; sides lower and upper along the normal."""

    point: Vector
    normal: Vector
    width: Positive


class Strip(Layer):
    """Strip of the plane."""

    dimension = 2


class Slab(Layer):
    """Slab of space."""

    dimension = 3


class Cylinder(Kind):
    """Round cylinder about an axis; infinite without `height`, else with surfaces lateral, bottom, top."""

    dimension = 3
    center: Vector
    axis: Vector
    radius: Positive
    height: Positive | None = None


class Cone(Kind):
    """Round cone with its tip at `apex`, opening along `axis`; surfaces lateral and base."""

    dimension = 3
    apex: Vector
    axis: Vector
    radius: Positive
    height: Positive


class Torus(Kind):
    """Ring around an axis: a tube of `minor_radius` around a circle of `major_radius`."""

    dimension = 3
    center: Vector
    axis: Vector
    major_radius: Positive
    minor_radius: Positive


class Function(Kind):
    """Where an expression of the coordinates is positive; `box` must contain it when it is bounded."""

    expression: Datum
    box: Corners | None = None

    @model_validator(mode="after")
    def _dimension_known(self, info: ValidationInfo) -> Function:
        if self.box is None and scope_of(info).shape_dimension is None:
            raise fail("needs a box such as [[-1, -1], [1, 1]], which also tells the dimension")
        return self
