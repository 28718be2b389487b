"""Shapes of a case: one kind with its arguments, and how it is moved."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, get_args

from pydantic import (
    BeforeValidator,
    GetJsonSchemaHandler,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    WrapValidator,
    model_validator,
)
from pydantic_core import CoreSchema

from rfm.app.domain import DomainExpression
from rfm.app.schema.base import Strict
from rfm.app.schema.curves import Curve
from rfm.app.schema.derived import (
    Blend,
    BoundedBlend,
    Cyclic,
    Derived,
    DisplacementBlend,
    Extrude,
    Offset,
    Projection,
    Repeat,
    RepeatSeries,
    Revolve,
    Screw,
    Section,
    Shell,
    Sweep,
)
from rfm.app.schema.kind import Kind
from rfm.app.schema.outlines import Outline, Polygon, Polyhedron
from rfm.app.schema.primitives import (
    Ball,
    Box,
    Cone,
    Cylinder,
    Disk,
    Ellipse,
    Ellipsoid,
    Function,
    HalfPlane,
    HalfSpace,
    Interval,
    Rectangle,
    Slab,
    Strip,
    Torus,
)
from rfm.app.schema.scalars import (
    DIMENSION_WORDS,
    Number,
    Positive,
    Vector,
    fail,
    inside,
    scope_of,
    shown,
    vector,
    within,
)
from rfm.app.yaml_reader import Path


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
        if "axis" in value and scope_of(info).shape_dimension == 2:
            raise fail("a rotation of the plane has no axis, only a center", key=("axis",))
        return value

    @model_validator(mode="after")
    def _axis_in_space(self, info: ValidationInfo) -> Rotation:
        if scope_of(info).shape_dimension == 3 and self.axis is None:
            raise fail("a rotation in space needs an axis: {angle: 30, axis: [0, 0, 1]}")
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Allow a plain number, which is the angle."""
        return {"anyOf": [{"type": ["number", "string"]}, handler.resolve_ref_schema(handler(core))]}


class Mirroring(Strict):
    """Reflection in the line or plane through `point` across `normal`."""

    point: Vector
    normal: Vector


class Tapering(Strict):
    """Sections scaled linearly from 1 at height `start` to `factor` at height `end`."""

    start: Number
    end: Number
    factor: Positive


def _matrix(value: Any, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:
    dimension = scope_of(info).shape_dimension
    if not isinstance(value, list | tuple) or len(value) != (dimension or len(value)):
        raise fail(
            f"must be a list of {dimension or '2 or 3'} rows such as [[1, 0], [0, 1]], got {shown(value)}"
        )
    return tuple(within(i, vector, item, info) for i, item in enumerate(value))


class AffineMap(Strict):
    """The map x -> matrix x + shift."""

    matrix: Annotated[
        tuple[tuple[float, ...], ...],
        BeforeValidator(_matrix),
        WithJsonSchema({"type": "array", "items": {"type": "array"}, "minItems": 2, "maxItems": 3}),
    ]
    shift: Vector | None = None


class ShapeSpec(Strict):
    """One shape: exactly one kind; then tapered, twisted, mapped, mirrored, scaled, rotated, moved, in this order."""

    half_plane: HalfPlane | None = None
    disk: Disk | None = None
    ellipse: Ellipse | None = None
    rectangle: Rectangle | None = None
    strip: Strip | None = None
    polygon: Polygon | None = None
    outline: Outline | None = None
    half_space: HalfSpace | None = None
    ball: Ball | None = None
    ellipsoid: Ellipsoid | None = None
    box: Box | None = None
    slab: Slab | None = None
    cylinder: Cylinder | None = None
    cone: Cone | None = None
    torus: Torus | None = None
    polyhedron: Polyhedron | None = None
    interval: Interval | None = None
    curve: Curve | None = None
    function: Function | None = None
    blend: Blend | None = None
    displacement_blend: DisplacementBlend | None = None
    bounded_blend: BoundedBlend | None = None
    offset: Offset | None = None
    shell: Shell | None = None
    repeat: Repeat | None = None
    repeat_series: RepeatSeries | None = None
    cyclic: Cyclic | None = None
    sweep: Sweep | None = None
    extrude: Extrude | None = None
    revolve: Revolve | None = None
    screw: Screw | None = None
    section: Section | None = None
    projection: Projection | None = None
    taper: Tapering | None = None
    twist: Number | None = None
    affine: AffineMap | None = None
    mirror: Mirroring | None = None
    scale: Positive | None = None
    rotate: Rotation | None = None
    move: Vector | None = None

    @model_validator(mode="after")
    def _one_kind(self, info: ValidationInfo) -> ShapeSpec:
        name = self.one_of(KIND_NAMES, "a kind of shape")
        kind, dimension = getattr(self, name), scope_of(info).shape_dimension
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

    def operands(self) -> Iterator[tuple[Path, DomainExpression]]:
        """Return expressions of the shapes it is made of, each with its place in the kind."""
        given = self.given
        if isinstance(given, Derived):
            yield from given.operands()


def _in_its_dimension(value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> ShapeSpec:
    """Validate a shape that only others mention in its own dimension."""
    own = next((dimension for raw, dimension in scope_of(info).own if raw is value), None)
    with inside(own):
        spec: ShapeSpec = handler(value)
    return spec


OwnShape = Annotated[ShapeSpec, WrapValidator(_in_its_dimension)]

MODIFIERS = ("taper", "twist", "affine", "mirror", "scale", "rotate", "move")
"""In the order in which they are applied."""

KIND_NAMES = tuple(name for name in ShapeSpec.model_fields if name not in MODIFIERS)

KINDS: dict[str, type[Kind]] = {
    name: get_args(ShapeSpec.model_fields[name].annotation)[0] for name in KIND_NAMES
}
"""Model of each kind by its name."""
