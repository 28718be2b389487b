"""The sections `expect`, `study`, `probes` and `integrals`: what is asked of the result."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any, ClassVar

from pydantic import (
    BeforeValidator,
    Field,
    GetJsonSchemaHandler,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import CoreSchema

from rfm.app.expressions import Expression, ExpressionError
from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import WRITTEN, NonNegative, Number, PartNames, fail, scope_of, shown

DOMAIN = "domain"

QUANTITIES = ("flux", "area")
"""What an integral can be of besides an expression."""

UNKNOWNS = ("u", "ux", "uy", "uz")
"""Names of the unknown in an integrand: u of a scalar, the others of a vector."""


class Expectation(Strict):
    """An upper limit, or a value with a tolerance to either side."""

    limit: Number | None = Field(default=None, description="the result must not exceed it")
    value: Number | None = None
    tolerance: NonNegative | None = None

    @model_validator(mode="before")
    @classmethod
    def _plain_limit(cls, value: Any) -> Any:
        if isinstance(value, dict):
            return value
        if value is None or isinstance(value, list | bool):
            raise fail(f"must be an upper limit or {{value: ..., tolerance: ...}}, got {shown(value)}")
        return {"limit": value}

    @model_validator(mode="after")
    def _complete(self) -> Expectation:
        if (self.limit is None) == (self.value is None):
            raise fail("must be an upper limit or {value: ..., tolerance: ...}")
        if (self.value is None) != (self.tolerance is None):
            raise fail("value and tolerance go together")
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Allow a plain number, which is the limit."""
        return {"anyOf": [{"type": ["number", "string"]}, handler.resolve_ref_schema(handler(core))]}


def whole_numbers(minimum: int, maximum: int) -> Any:
    """Type of a list of distinct whole numbers in increasing order."""

    def validate(value: Any) -> tuple[int, ...]:
        if not isinstance(value, list | tuple) or not value:
            raise fail(f"must be a list of whole numbers, got {shown(value)}")
        for item in value:
            if isinstance(item, bool) or not isinstance(item, int) or not minimum <= item <= maximum:
                raise fail(f"must hold whole numbers from {minimum} to {maximum}, got {shown(item)}")
        if any(b <= a for a, b in pairwise(value)):
            raise fail("must increase")
        return tuple(value)

    items = {"type": "integer", "minimum": minimum, "maximum": maximum}
    schema = WithJsonSchema({"type": "array", "items": items, "minItems": 1})
    return Annotated[tuple[int, ...], BeforeValidator(validate), schema]


def _varied(value: Any) -> dict[str, tuple[Any, ...]]:
    if not isinstance(value, dict) or not value:
        raise fail(f"must be a mapping from keys such as parameters.R to lists of values, got {shown(value)}")
    for key, values in value.items():
        if not isinstance(values, list | tuple) or not values:
            raise fail(f"must be a list of values, got {shown(values)}", value=(key,))
        for i, item in enumerate(values):
            if item in values[:i]:
                raise fail(f"holds {shown(item)} twice", value=(key, i))
        if key.partition(".")[0] in ("rfm", "study"):
            raise fail(f"a study cannot vary {key!r}; vary a key of the problem", key=(key,))
    return {key: tuple(values) for key, values in value.items()}


Varied = Annotated[
    dict[str, tuple[Any, ...]],
    BeforeValidator(_varied),
    WithJsonSchema({"type": "object", "additionalProperties": {"type": "array", "minItems": 1}}),
]


class Study(Strict):
    """Runs of `rfm study`: every combination; the value of the case where one is not given."""

    vary: Varied | None = Field(default=None, description="lists of values by dotted key of the case")
    grid: whole_numbers(1, 100_000) | None = None  # type: ignore[valid-type]
    degree: whole_numbers(1, 40) | None = None  # type: ignore[valid-type]

    @model_validator(mode="after")
    def _something(self) -> Study:
        if self.grid is None and self.degree is None and self.vary is None:
            raise fail("needs a list of grids, degrees or both, or lists of values under vary")
        for name in ("grid", "degree"):
            if getattr(self, name) is not None and f"discretization.{name}" in (self.vary or {}):
                key = ("vary", f"discretization.{name}")
                raise fail(f"the study gives the {name} twice; remove one", key=key)
        return self


def _integrand(value: Any, info: ValidationInfo) -> Expression | str:
    if value in QUANTITIES:
        return str(value)
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise fail(f"must be {', '.join(QUANTITIES)} or an expression, got {shown(value)}")
    scope = scope_of(info)
    try:
        expression = Expression(
            str(value), scope.parameters, (*scope.coordinates(), *UNKNOWNS), scope.absent()
        )
    except ExpressionError as error:
        raise fail(error.message, offset=error.offset) from None
    if expression.is_condition:
        raise fail("must be a number, not a condition; write where(condition, 1, 0)")
    return expression


class Integral(Strict):
    """An integral over a part of the boundary or over the domain."""

    refused: ClassVar[dict[str, str]] = {}

    on: PartNames = Field(description="part, list of parts, all, or domain")
    of: Annotated[
        Expression | str,
        BeforeValidator(_integrand),
        WRITTEN,
        WithJsonSchema(
            {"type": ["string", "number"], "description": "flux, area, or expression with u (ux, uy, uz)"}
        ),
    ] = Field(
        description="flux (k du/dn, sigma n), area, or an expression of the coordinates and u (ux, uy, uz)"
    )

    @model_validator(mode="after")
    def _meaningful(self) -> Integral:
        if DOMAIN in self.on and len(self.on) > 1:
            raise fail(
                "'domain' stands alone, it cannot be combined with parts of the boundary", value=("on",)
            )
        if "rest" in self.on:
            raise fail("'rest' belongs to boundary conditions; name the parts", value=("on",))
        if DOMAIN in self.on and self.of == "flux":
            raise fail("a flux passes through a part of the boundary, not the domain", value=("of",))
        return self
