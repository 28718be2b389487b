"""Shapes given by their boundary: polygons, outlines of lines and arcs, polyhedra."""

from __future__ import annotations

import re
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from rfm.app.schema.base import Strict
from rfm.app.schema.kind import Kind
from rfm.app.schema.scalars import Number, Truth, Vector, fail, shown, vector, within

Points = tuple[tuple[float, ...], ...]


def _points(value: Any, info: ValidationInfo, fewest: int) -> Points:
    if not isinstance(value, list | tuple):
        raise fail(f"must be a list of points, got {shown(value)}")
    if len(value) < fewest:
        raise fail(f"needs at least {fewest} vertices, got {len(value)}")
    return tuple(within(i, vector, item, info) for i, item in enumerate(value))


def _ring(value: Any, info: ValidationInfo) -> Points:
    return _points(value, info, 3)


def _rings(value: Any, info: ValidationInfo) -> tuple[Points, ...]:
    if not isinstance(value, list | tuple):
        raise fail(f"must be a list of holes, each a list of points, got {shown(value)}")
    return tuple(within(i, _ring, item, info) for i, item in enumerate(value))


def _ends(value: Any, info: ValidationInfo) -> Points:
    return _points(value, info, 2)


class Polygon(Kind):
    """Polygon by its vertices in order, with sides edge0, edge1, ...; sides of holes are hole0.edge0, ..."""

    dimension = 2
    vertices: Annotated[
        Points,
        BeforeValidator(_ring),
        WithJsonSchema({"type": "array", "items": {"type": "array"}, "minItems": 3}),
    ]
    holes: Annotated[
        tuple[Points, ...],
        BeforeValidator(_rings),
        WithJsonSchema({"type": "array", "items": {"type": "array", "minItems": 3}}),
    ] = ()


class Arc(Strict):
    """Circular arc in the place of an edge, by one of bulge, through, radius, center."""

    bulge: Number | None = None
    through: Vector | None = None
    radius: Number | None = None
    center: Vector | None = None
    clockwise: Truth = False

    @model_validator(mode="after")
    def _one_way(self) -> Arc:
        if self.one_of(("bulge", "through", "radius", "center"), "an arc") != "center" and self.clockwise:
            raise fail("only an arc given by its center needs it", key=("clockwise",))
        return self


class Outline(Kind):
    """Lines and circular arcs through vertices in order; the edges named in `arcs` are arcs."""

    dimension = 2
    vertices: Annotated[
        Points,
        BeforeValidator(_ends),
        WithJsonSchema({"type": "array", "items": {"type": "array"}, "minItems": 2}),
    ]
    arcs: dict[str, Arc] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _edges_exist(self) -> Outline:
        last = len(self.vertices) - 1
        for name in self.arcs:
            if not re.fullmatch(r"edge(0|[1-9]\d*)", name) or int(name.removeprefix("edge")) > last:
                raise fail(
                    f"there is no edge {name!r}: the edges are edge0 to edge{last}", key=("arcs", name)
                )
        return self

    def arguments(self) -> dict[str, Any]:
        """Arguments for the constructor."""
        arcs = {int(name.removeprefix("edge")): arc.model_dump() for name, arc in self.arcs.items()}
        return {"vertices": self.vertices, "arcs": arcs}


def _chain(value: Any, info: ValidationInfo) -> tuple[int, ...]:
    if not isinstance(value, list | tuple) or not all(type(item) is int for item in value):
        raise fail(f"must be a list of numbers of vertices, got {shown(value)}")
    return tuple(value)


def _faces(value: Any, info: ValidationInfo) -> tuple[tuple[int, ...], ...]:
    if not isinstance(value, list | tuple):
        raise fail(f"must be a list of faces, each a list of numbers of vertices, got {shown(value)}")
    return tuple(within(i, _chain, item, info) for i, item in enumerate(value))


def _corners(value: Any, info: ValidationInfo) -> Points:
    return _points(value, info, 4)


class Polyhedron(Kind):
    """Polyhedron by its vertices and plane faces, lists of numbers of vertices (from 0) in order."""

    dimension = 3
    vertices: Annotated[
        Points,
        BeforeValidator(_corners),
        WithJsonSchema({"type": "array", "items": {"type": "array"}, "minItems": 4}),
    ]
    faces: Annotated[
        tuple[tuple[int, ...], ...],
        BeforeValidator(_faces),
        WithJsonSchema(
            {"type": "array", "items": {"type": "array", "items": {"type": "integer"}}, "minItems": 4}
        ),
    ]
