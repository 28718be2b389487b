"""Values that mention shapes by their names, and vectors of space in a plane case."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer, ValidationInfo, WithJsonSchema

from rfm.app.domain import DomainExpression
from rfm.app.expressions import ExpressionError
from rfm.app.schema.scalars import fail, inside, shown, vector, within

_WRITTEN = PlainSerializer(lambda shape: shape.text, return_type=str)


def shape_expression(value: Any) -> DomainExpression:
    """Expression of named shapes."""
    if not isinstance(value, str):
        raise fail(f"must be an expression of shapes such as outer - inner, got {shown(value)}")
    try:
        return DomainExpression.parse(value)
    except ExpressionError as error:
        raise fail(error.message, offset=error.offset) from None


ShapeExpression = Annotated[
    DomainExpression,
    BeforeValidator(shape_expression),
    _WRITTEN,
    WithJsonSchema({"type": "string", "description": "shapes joined by operations and parentheses"}),
]


def _shapes(value: Any, info: ValidationInfo) -> tuple[DomainExpression, ...]:
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise fail(f"must be a list of at least two shapes such as [a, b], got {shown(value)}")
    return tuple(
        within(i, lambda item, _: shape_expression(item), item, info) for i, item in enumerate(value)
    )


Shapes = Annotated[
    tuple[DomainExpression, ...],
    BeforeValidator(_shapes),
    PlainSerializer(lambda shapes: [shape.text for shape in shapes], return_type=list),
    WithJsonSchema({"type": "array", "items": {"type": "string"}, "minItems": 2}),
]


def _space_vector(value: Any, info: ValidationInfo) -> tuple[float, ...]:
    with inside(3):
        return vector(value, info)


SpaceVector = Annotated[
    tuple[float, ...],
    BeforeValidator(_space_vector),
    WithJsonSchema({"type": "array", "items": {"type": ["number", "string"]}, "minItems": 3, "maxItems": 3}),
]
