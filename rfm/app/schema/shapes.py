"""Shapes of a case: one kind with its arguments, and how it is moved.

The keys of a kind are the arguments of its constructor in :mod:`rfm.geometry.primitives`; angles are in
degrees here and in radians there.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, get_args

from pydantic import BeforeValidator, GetJsonSchemaHandler, ValidationInfo, WithJsonSchema, model_validator
from pydantic_core import CoreSchema

from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import (
    DIMENSION_WORDS,
    Corners,
    Datum,
    Number,
    Positive,
    PositiveVector,
    Vector,
    fail,
    scope_of,
    shown,
    vector,
    within,
)


class Kind(Strict):
    """Arguments of one kind of shape.

    Attributes
    ----------
    dimension
        2 or 3; 0 for a kind of either dimension.
    """

    dimension: ClassVar[int] = 0

    def arguments(self) -> dict[str, Any]:
        """Arguments for the constructor: those that were given, angles in radians."""
        given = {
            name: getattr(self, name) for name in type(self).model_fields if name in self.model_fields_set
        }
        return {name: math.radians(v) if name == "angle" else v for name, v in given.items() if v is not None}


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


def _vertices(value: Any, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    if not isinstance(value, list | tuple):
        raise fail(f"must be a list of points, got {shown(value)}")
    if len(value) < 3:
        raise fail(f"needs at least 3 vertices, got {len(value)}")
    return tuple(within(i, vector, item, info) for i, item in enumerate(value))


class Polygon(Kind):
    """Polygon by its vertices in order; its sides are edge0, edge1, ... from each vertex to the next."""

    dimension = 2
    vertices: Annotated[
        tuple[tuple[float, ...], ...],
        BeforeValidator(_vertices),
        WithJsonSchema({"type": "array", "items": {"type": "array"}, "minItems": 3}),
    ]


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
        if self.box is None and scope_of(info).dimension is None:
            raise fail("needs a box such as [[-1, -1], [1, 1]], which also tells the dimension")
        return self


class Rotation(Strict):
    """Turn by `angle` degrees, counter-clockwise, about `center` (the origin) and, in space, about `axis`."""

    angle: Number
    center: Vector | None = None
    axis: Vector | None = None

    @model_validator(mode="before")
    @classmethod
    def _plain_angle(cls, value: Any, info: ValidationInfo) -> Any:
        if not isinstance(value, dict):
            return {"angle": value}
        if "axis" in value and scope_of(info).dimension == 2:
            raise fail("a rotation of the plane has no axis, only a center", key=("axis",))
        return value

    @model_validator(mode="after")
    def _axis_in_space(self, info: ValidationInfo) -> Rotation:
        if scope_of(info).dimension == 3 and self.axis is None:
            raise fail("a rotation in space needs an axis: {angle: 30, axis: [0, 0, 1]}")
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Allow a plain number, which is the angle."""
        return {"anyOf": [{"type": ["number", "string"]}, handler.resolve_ref_schema(handler(core))]}


class ShapeSpec(Strict):
    """One shape: exactly one kind; then it is scaled, rotated and moved, in this order."""

    half_plane: HalfPlane | None = None
    disk: Disk | None = None
    ellipse: Ellipse | None = None
    rectangle: Rectangle | None = None
    strip: Strip | None = None
    polygon: Polygon | None = None
    half_space: HalfSpace | None = None
    ball: Ball | None = None
    ellipsoid: Ellipsoid | None = None
    box: Box | None = None
    slab: Slab | None = None
    cylinder: Cylinder | None = None
    cone: Cone | None = None
    torus: Torus | None = None
    function: Function | None = None
    scale: Positive | None = None
    rotate: Rotation | None = None
    move: Vector | None = None

    @model_validator(mode="after")
    def _one_kind(self, info: ValidationInfo) -> ShapeSpec:
        name = self.one_of(KIND_NAMES, "a kind of shape")
        kind, dimension = getattr(self, name), scope_of(info).dimension
        if dimension and kind.dimension and kind.dimension != dimension:
            words = DIMENSION_WORDS
            message = f"{name} is {words[kind.dimension]}, the other shapes are {words[dimension]}"
            raise fail(message, key=(name,))
        return self

    @property
    def kind(self) -> str:
        """Name of the kind."""
        return next(name for name in KIND_NAMES if getattr(self, name) is not None)

    @property
    def given(self) -> Kind:
        """Arguments of the kind."""
        kind: Kind = getattr(self, self.kind)
        return kind


MODIFIERS = ("scale", "rotate", "move")

KIND_NAMES = tuple(name for name in ShapeSpec.model_fields if name not in MODIFIERS)

KINDS: dict[str, type[Kind]] = {
    name: get_args(ShapeSpec.model_fields[name].annotation)[0] for name in KIND_NAMES
}
"""Model of each kind by its name."""
