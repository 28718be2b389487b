"""The section `geometry`: named shapes and the domain made of them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from rfm.app.schema.base import Strict
from rfm.app.schema.mentions import check_names, dimensions_of, used_names
from rfm.app.schema.references import ShapeExpression
from rfm.app.schema.scalars import Scope, check_name, fail, scope_of, shown
from rfm.app.schema.shapes import OwnShape
from rfm.app.source import nearest
from rfm.calculus import r_systems
from rfm.errors import RfmError


def _system(value: Any) -> str:
    if not isinstance(value, str):
        raise fail(f"must be the name of a system of R-functions, got {shown(value)}")
    try:
        r_systems.system(value)
    except RfmError as error:
        message = str(error)
        if message.startswith("unknown"):
            message = f"unknown name {value!r}; {nearest(value, r_systems.NAMES, 'systems')}"
        raise fail(message) from None
    return value


System = Annotated[str, BeforeValidator(_system), WithJsonSchema({"type": "string"})]


class Geometry(Strict):
    """Shapes by name and the domain as an expression of them."""

    shapes: dict[str, OwnShape] = Field(description="name: {kind: arguments}")
    domain: ShapeExpression
    membership: System = Field(
        default="r1", description="R-functions of the domain's function, where no operation names its own"
    )

    @model_validator(mode="after")
    def _names(self, info: ValidationInfo) -> Geometry:
        if not self.shapes:
            raise fail("needs at least one shape", key=("shapes",))
        for name in self.shapes:
            wrong = check_name(name, "shape")
            if wrong:
                raise fail(wrong, key=("shapes", name))
        check_names(self.domain, self.shapes, ("domain",))
        used = used_names(self.domain, self.shapes, scope_of(info).mentioned)
        for name in self.shapes:
            if name not in used:
                raise fail(
                    f"the shape {name!r} is not used by the domain; use it or remove it", key=("shapes", name)
                )
        self._check_dimension(scope_of(info))
        return self

    def _check_dimension(self, scope: Scope) -> None:
        """Refuse operations that do not fit the dimensions, and a domain on a line."""
        dimensions = dimensions_of(self.shapes, scope)
        try:
            total = self.domain.dimension(dimensions)
        except ValueError as error:
            raise fail(str(error), value=("domain",)) from None
        if total == 1:
            raise fail("the domain is one-dimensional; multiply it: disk @ interval", value=("domain",))
