"""Regions inside closed curves of lines, arcs, Bezier and B-spline curves."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema, model_validator

from rfm.app.schema.base import Strict
from rfm.app.schema.kind import Kind
from rfm.app.schema.scalars import Vector, fail, shown, vector, within

Points = tuple[tuple[float, ...], ...]

CONTROL = {"type": "array", "items": {"type": "array"}}


def _control(value: Any, info: ValidationInfo) -> Points:
    if not isinstance(value, list | tuple) or not value:
        raise fail(f"must be a list of points, got {shown(value)}")
    return tuple(within(i, vector, item, info) for i, item in enumerate(value))


Control = Annotated[Points, BeforeValidator(_control), WithJsonSchema(CONTROL)]


class CurvePiece(Strict):
    """One piece, from where the last one ended: its end, or its points, the last of which is the end."""

    line: Vector | None = None
    arc: Control | None = None
    bezier: Control | None = None
    spline: Control | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> CurvePiece:
        self.one_of(tuple(type(self).model_fields), "a piece")
        return self

    def plain(self) -> dict[str, Any]:
        """Return the kind and its points."""
        return self.model_dump(exclude_none=True)


class Curve(Kind):
    """Region inside a closed curve of pieces piece0, piece1, ...; a line closes it where it is open."""

    dimension = 2
    start: Vector
    pieces: tuple[CurvePiece, ...]

    def arguments(self) -> dict[str, Any]:
        """Arguments for the constructor."""
        return {"start": self.start, "pieces": [piece.plain() for piece in self.pieces]}
