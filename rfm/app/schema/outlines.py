"""Shapes given by their boundary: polygons."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from rfm.app.schema.kind import Kind
from rfm.app.schema.scalars import fail, shown, vector, within

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
