"""The section `geometry`: named shapes and the domain made of them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PlainSerializer, ValidationInfo, WithJsonSchema, model_validator

from rfm.app.domain import DomainExpression
from rfm.app.expressions import ExpressionError
from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import check_name, fail, shown
from rfm.app.schema.shapes import ShapeSpec
from rfm.app.source import nearest


def _domain(value: Any) -> DomainExpression:
    if not isinstance(value, str):
        raise fail(f"must be an expression of shapes such as outer - inner, got {shown(value)}")
    try:
        return DomainExpression.parse(value)
    except ExpressionError as error:
        raise fail(error.message, offset=error.offset) from None


Domain = Annotated[
    DomainExpression,
    BeforeValidator(_domain),
    PlainSerializer(lambda domain: domain.text, return_type=str),
    WithJsonSchema({"type": "string", "description": "shapes joined by & | - ~ and parentheses"}),
]


class Geometry(Strict):
    """Shapes by name and the domain as an expression of them."""

    shapes: dict[str, ShapeSpec] = Field(description="name: {kind: arguments}")
    domain: Domain

    @model_validator(mode="after")
    def _names(self, info: ValidationInfo) -> Geometry:
        if not self.shapes:
            raise fail("needs at least one shape", key=("shapes",))
        for name in self.shapes:
            wrong = check_name(name, "shape")
            if wrong:
                raise fail(wrong, key=("shapes", name))
        for name, offset in self.domain.names.items():
            if name not in self.shapes:
                message = f"unknown shape {name!r}; {nearest(name, self.shapes, 'shapes')}"
                raise fail(message, value=("domain",), offset=offset)
        for name in self.shapes:
            if name not in self.domain.names:
                raise fail(
                    f"the shape {name!r} is not used by the domain; use it or remove it", key=("shapes", name)
                )
        return self
