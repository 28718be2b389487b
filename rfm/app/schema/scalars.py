"""The kinds of value that keys of a case take: numbers, expressions, names, choices and points.

Each kind is an annotated type whose validator accepts what the user may write, folds expressions of
parameters, and words its own error.  The names that expressions may use come from the `Scope` that is
the context of the validation.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BeforeValidator, PlainSerializer, ValidationInfo, WithJsonSchema
from pydantic_core import PydanticCustomError

from rfm.app.expressions import RESERVED, Expression, ExpressionError
from rfm.app.expressions.vocabulary import COORDINATES
from rfm.app.source import nearest
from rfm.app.yaml_reader import Path

FROM_EXACT = "from exact"

Item = TypeVar("Item")

DIMENSION_WORDS = {1: "one-dimensional", 2: "two-dimensional", 3: "three-dimensional"}


@dataclass(frozen=True)
class Scope:
    """What the expressions of one case may mention.

    Attributes
    ----------
    parameters
        Values of the parameters of the case.
    dimension
        Dimension of its domain; None while it is unknown, then coordinates are not counted.
    product
        Whether the domain multiplies shapes, whose dimensions are then less than its own.
    own
        Raw values of the shapes that only other shapes mention, each with its dimension.
    mentioned
        Names in the regions of inclusions.
    """

    parameters: Mapping[str, float] = field(default_factory=dict)
    dimension: int | None = None
    product: bool = False
    own: tuple[tuple[Any, int], ...] = ()
    mentioned: frozenset[str] = frozenset()

    @property
    def shape_dimension(self) -> int | None:
        """Dimension of every shape; None when it is not known or when they differ."""
        return None if self.product else self.dimension

    def coordinates(self) -> tuple[str, ...]:
        """Coordinates that have a meaning in this case."""
        return COORDINATES[: self.dimension or 3]

    def absent(self) -> dict[str, str]:
        """Remarks for the variables that have none."""
        remarks = {"t": "there is no time t in a steady problem"}
        if self.dimension is not None:
            coordinates = ", ".join(self.coordinates())
            kind = DIMENSION_WORDS[self.dimension]
            for name in COORDINATES[self.dimension :]:
                remarks[name] = f"{name!r} is no coordinate of this {kind} case (only {coordinates})"
        return remarks


def fail(
    message: str, *, offset: int | None = None, value: Path | None = None, key: Path | None = None
) -> PydanticCustomError:
    """Error of a validator.

    Parameters
    ----------
    message
        What is wrong and the remedy.
    offset
        Character of the text where it is wrong.
    value, key
        Path from the validated value to the value, or to the key, that is wrong.
    """
    context = {"message": message, "offset": offset, "inner": value or key, "at_key": key is not None}
    return PydanticCustomError("case", "{message}", context)


def shown(value: Any) -> str:
    """Value as the user wrote it, shortened."""
    words = {None: "null", True: "true", False: "false"}
    if value is None or isinstance(value, bool):
        return words[value]
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    text = repr(value) if isinstance(value, str) else f"{value:g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."


_DIMENSION: ContextVar[int | None] = ContextVar("dimension", default=None)


@contextmanager
def inside(dimension: int | None) -> Iterator[None]:
    """Validate what belongs to a shape of another dimension than the domain; None changes nothing."""
    token = _DIMENSION.set(dimension if dimension is not None else _DIMENSION.get())
    try:
        yield
    finally:
        _DIMENSION.reset(token)


def scope_of(info: ValidationInfo) -> Scope:
    """Scope of the validation; an empty one when there is none."""
    scope = info.context if isinstance(info.context, Scope) else Scope()
    own = _DIMENSION.get()
    return scope if own is None else replace(scope, dimension=own, product=False)


def _text(value: Any, expected: str) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise fail(f"must be {expected}, got {shown(value)}")
    if isinstance(value, str):
        return value
    if not math.isfinite(value):
        raise fail(f"must be finite, got {value}")
    return repr(value)


def _expression(text: str, info: ValidationInfo, variables: tuple[str, ...]) -> Expression:
    scope = scope_of(info)
    try:
        return Expression(text, scope.parameters, variables, scope.absent())
    except ExpressionError as error:
        raise fail(error.message, offset=error.offset) from None


# Numbers ------------------------------------------------------------------------------------------


def _number(value: Any, info: ValidationInfo) -> float:
    expression = _expression(_text(value, "a number or an expression of parameters"), info, ())
    if expression.is_condition or expression.constant is None:
        raise fail("must be a number, not a condition")
    return float(expression.constant)


def _bounded(check: Callable[[float], bool], wanted: str) -> Callable[[Any, ValidationInfo], float]:
    def validate(value: Any, info: ValidationInfo) -> float:
        number = _number(value, info)
        if not check(number):
            raise fail(f"must be {wanted}, got {number:g}")
        return number

    return validate


_NUMBER_SCHEMA = WithJsonSchema(
    {"type": ["number", "string"], "description": "number, or expression of parameters"}
)

Number = Annotated[float, BeforeValidator(_number), _NUMBER_SCHEMA]
positive = _bounded(lambda v: v > 0, "positive")
Positive = Annotated[float, BeforeValidator(positive), _NUMBER_SCHEMA]
NonNegative = Annotated[float, BeforeValidator(_bounded(lambda v: v >= 0, "at least 0")), _NUMBER_SCHEMA]


def integer(minimum: int, maximum: int) -> Any:
    """Type of the whole numbers from `minimum` to `maximum`."""

    def validate(value: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise fail(f"must be a whole number from {minimum} to {maximum}, got {shown(value)}")
        if not minimum <= value <= maximum:
            raise fail(f"must be from {minimum} to {maximum}, got {value}")
        return value

    schema = {"type": "integer", "minimum": minimum, "maximum": maximum}
    return Annotated[int, BeforeValidator(validate), WithJsonSchema(schema)]


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise fail(f"must be true or false, got {shown(value)}")
    return value


Truth = Annotated[bool, BeforeValidator(_truth), WithJsonSchema({"type": "boolean"})]


# Points -------------------------------------------------------------------------------------------


def vector(value: Any, info: ValidationInfo) -> tuple[float, ...]:
    """Coordinates of a point or direction, as many as the shapes have dimensions."""
    scope = scope_of(info)
    dimension = scope.shape_dimension
    if not isinstance(value, list | tuple):
        raise fail(f"must be a list of {dimension or '2 or 3'} numbers, got {shown(value)}")
    if len(value) != (dimension or len(value)) or not 3 >= len(value) >= 2 - scope.product:
        raise fail(f"must have {dimension or '2 or 3'} coordinates, got {len(value)}")
    return tuple(within(i, _number, item, info) for i, item in enumerate(value))


def within(
    index: int | str, validator: Callable[[Any, ValidationInfo], Item], item: Any, info: ValidationInfo
) -> Item:
    """Validate an item of a list, so that an error points to the item."""
    try:
        return validator(item, info)
    except PydanticCustomError as error:
        context = error.context or {}
        inner = (index, *(context.get("inner") or ()))
        raise fail(str(context["message"]), offset=context.get("offset"), value=inner) from None


_VECTOR_SCHEMA = WithJsonSchema(
    {"type": "array", "items": {"type": ["number", "string"]}, "minItems": 2, "maxItems": 3}
)

Vector = Annotated[tuple[float, ...], BeforeValidator(vector), _VECTOR_SCHEMA]


def _positive_vector(value: Any, info: ValidationInfo) -> tuple[float, ...]:
    numbers = vector(value, info)
    if min(numbers) <= 0:
        raise fail(f"must be positive, got {min(numbers):g}")
    return numbers


PositiveVector = Annotated[tuple[float, ...], BeforeValidator(_positive_vector), _VECTOR_SCHEMA]


def _corners(value: Any, info: ValidationInfo) -> tuple[tuple[float, ...], tuple[float, ...]]:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise fail("must be two corners such as [[0, 0], [1, 1]]")
    lower, upper = (within(i, vector, item, info) for i, item in enumerate(value))
    if len(lower) != len(upper) or any(b <= a for a, b in zip(lower, upper, strict=False)):
        raise fail(f"the second corner must exceed the first in every coordinate, got {lower} and {upper}")
    return lower, upper


Corners = Annotated[
    tuple[tuple[float, ...], tuple[float, ...]],
    BeforeValidator(_corners),
    WithJsonSchema({"type": "array", "items": {"type": "array"}, "minItems": 2, "maxItems": 2}),
]


# Expressions --------------------------------------------------------------------------------------


def validate_datum(value: Any, info: ValidationInfo) -> Expression:
    """Validate a number or an expression of the coordinates."""
    text = _text(value, "a number or an expression")
    expression = _expression(text, info, scope_of(info).coordinates())
    if expression.is_condition:
        raise fail("must be a number, not a condition; write where(condition, 1, 0)")
    return expression


def _datum_or_exact(value: Any, info: ValidationInfo) -> Expression | str:
    return FROM_EXACT if value == FROM_EXACT else validate_datum(value, info)


def _comparison(value: Any, info: ValidationInfo) -> Expression:
    expression = _expression(_text(value, "a comparison such as x > 0.2"), info, scope_of(info).coordinates())
    try:
        expression.condition(scope_of(info).dimension or 3)
    except ExpressionError as error:
        raise fail(error.message, offset=error.offset) from None
    return expression


def written(value: Expression | str) -> str | float:
    """Write a plain number as a number, everything else as text."""
    if isinstance(value, str):
        return value
    try:
        number = float(value.text)
    except ValueError:
        return value.text
    return int(number) if number.is_integer() and abs(number) < 2**53 else number


WRITTEN = PlainSerializer(written, return_type=Any)
_DATUM_SCHEMA = WithJsonSchema({"type": ["number", "string"], "description": "number or expression"})
_EXACT_SCHEMA = WithJsonSchema(
    {"type": ["number", "string"], "description": "number, expression, or 'from exact'"}
)

Datum = Annotated[Expression, BeforeValidator(validate_datum), WRITTEN, _DATUM_SCHEMA]
DatumOrExact = Annotated[
    Expression | Literal["from exact"], BeforeValidator(_datum_or_exact), WRITTEN, _EXACT_SCHEMA
]
Comparison = Annotated[
    Expression,
    BeforeValidator(_comparison),
    WRITTEN,
    WithJsonSchema({"type": "string", "description": "comparison such as x > 0.2"}),
]


# Names --------------------------------------------------------------------------------------------

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)


def check_name(name: str, what: str) -> str | None:
    """Return what is wrong with a name the user chose for a `what`, or None."""
    import keyword

    if not _NAME.fullmatch(name) or len(name) > 60:
        return f"{name!r} is no name for a {what}: letters, digits and _ only, no digit first"
    if name in RESERVED or keyword.iskeyword(name):
        return f"{name!r} is reserved; choose another name for the {what}"
    return None


def choice(*names: str, missing: Mapping[str, str] | None = None) -> Any:
    """Type of the given names; `missing` words the refusal of names that are known but not built."""

    def validate(value: Any) -> str:
        if not isinstance(value, str):
            raise fail(f"must be one of {', '.join(names)}; got {shown(value)}")
        if missing and value in missing:
            raise fail(missing[value])
        if value not in names:
            raise fail(f"unknown name {value!r}; {nearest(value, names, 'choices')}")
        return value

    return Annotated[str, BeforeValidator(validate), WithJsonSchema({"type": "string", "enum": list(names)})]


def _string(value: Any) -> str:
    if isinstance(value, list | dict | bool) or value is None:
        raise fail(f"must be a text, got {shown(value)}")
    return "".join(c if c.isprintable() else " " for c in str(value))


Text = Annotated[str, BeforeValidator(_string), WithJsonSchema({"type": "string"})]


def _part_names(value: Any) -> tuple[str, ...]:
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list | tuple) or not names or not all(isinstance(name, str) for name in names):
        raise fail(f"must be the name of a part or a list of names, got {shown(value)}")
    for i, name in enumerate(names):
        if name in names[:i]:
            raise fail(f"names {name!r} twice")
    return tuple(names)


PartNames = Annotated[
    tuple[str, ...],
    BeforeValidator(_part_names),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}),
]
