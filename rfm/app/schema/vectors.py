"""Data with several components: lists of numbers and expressions, one entry for each coordinate."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer, ValidationInfo, WithJsonSchema

from rfm.app.expressions import Expression
from rfm.app.schema.scalars import FROM_EXACT, fail, scope_of, shown, validate_datum, within, written

Entry = Expression | str | None
"""An entry of a vector: an expression, 'from exact', or None where the component is free."""

_ENTRY_SCHEMA = {"type": ["number", "string"]}


def _list(
    value: Any, info: ValidationInfo, entry: Callable[[Any, ValidationInfo], Entry]
) -> tuple[Entry, ...]:
    dimension = scope_of(info).dimension
    if len(value) != (dimension or len(value)) or len(value) not in (2, 3):
        raise fail(f"must have {dimension or '2 or 3'} components, got {len(value)}")
    return tuple(within(i, entry, item, info) for i, item in enumerate(value))


def _components(value: Any, info: ValidationInfo) -> tuple[Entry, ...]:
    if not isinstance(value, list | tuple):
        raise fail(f"must be a list with one entry for each coordinate, got {shown(value)}")
    return _list(value, info, validate_datum)


def _components_or_exact(value: Any, info: ValidationInfo) -> tuple[Entry, ...] | str:
    return FROM_EXACT if value == FROM_EXACT else _components(value, info)


def _prescribed_entry(value: Any, info: ValidationInfo) -> Entry:
    return value if value is None or value == FROM_EXACT else validate_datum(value, info)


def _prescribed(value: Any, info: ValidationInfo) -> Entry | tuple[Entry, ...]:
    if not isinstance(value, list | tuple):
        return FROM_EXACT if value == FROM_EXACT else validate_datum(value, info)
    entries = _list(value, info, _prescribed_entry)
    if all(entry is None for entry in entries):
        raise fail("leaves every component free; write `traction: [0, 0]` for a part without load")
    return entries


def _field(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, dict):
        return {str(name): within(str(name), _field, item, info) for name, item in value.items()}
    return (
        _list(value, info, validate_datum) if isinstance(value, list | tuple) else validate_datum(value, info)
    )


def _written(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _written(item) for name, item in value.items()}
    if isinstance(value, tuple):
        return [None if entry is None else written(entry) for entry in value]
    return written(value)


WRITTEN = PlainSerializer(_written, return_type=Any)
_LIST = {"type": "array", "items": _ENTRY_SCHEMA, "minItems": 2, "maxItems": 3}
_LIST_WITH_NULL = {**_LIST, "items": {"type": ["number", "string", "null"]}}

Components = Annotated[tuple[Expression, ...], BeforeValidator(_components), WRITTEN, WithJsonSchema(_LIST)]
ComponentsOrExact = Annotated[
    tuple[Expression, ...] | str,
    BeforeValidator(_components_or_exact),
    WRITTEN,
    WithJsonSchema({"anyOf": [_LIST, {"const": FROM_EXACT}]}),
]
Prescribed = Annotated[
    Expression | str | tuple[Expression | str | None, ...],
    BeforeValidator(_prescribed),
    WRITTEN,
    WithJsonSchema({"anyOf": [_ENTRY_SCHEMA, _LIST_WITH_NULL]}),
]
FieldData = Annotated[
    Expression | tuple[Expression, ...] | dict[str, Any],
    BeforeValidator(_field),
    WRITTEN,
    WithJsonSchema(
        {
            "anyOf": [
                _ENTRY_SCHEMA,
                _LIST,
                {"type": "object", "additionalProperties": {"anyOf": [_ENTRY_SCHEMA, _LIST]}},
            ]
        }
    ),
]
