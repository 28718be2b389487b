"""Dimensions of the shapes of a case, before anything of it is validated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rfm.app.domain import DomainExpression
from rfm.app.schema.derived import Derived
from rfm.app.schema.shapes import KINDS
from rfm.errors import CaseError


def dimensions(shapes: Mapping[str, Any]) -> dict[str, int]:
    """Dimension of every shape that tells it, itself or by what it is made of."""
    found: dict[str, int] = {}
    for name in shapes:
        _find(name, shapes, found, ())
    return found


def parsed(text: Any) -> DomainExpression | None:
    """Parse an expression of shapes; None when it is none, which its validation will say."""
    try:
        return DomainExpression.parse(text)
    except (CaseError, TypeError, AttributeError):
        return None


def _find(name: str, shapes: Mapping[str, Any], found: dict[str, int], waiting: tuple[str, ...]) -> None:
    given = shapes.get(name)
    if name in found or name in waiting or not isinstance(given, dict):
        return
    for key, arguments in given.items():
        kind = KINDS.get(key)
        dimension = None
        if kind is not None and kind.dimension:
            dimension = kind.dimension
        elif kind is not None and issubclass(kind, Derived):
            dimension = _of_operands(arguments, shapes, found, (*waiting, name))
        elif key == "function":
            dimension = _of_box(arguments)
        if dimension:
            found[name] = dimension


def _of_operands(
    arguments: Any, shapes: Mapping[str, Any], found: dict[str, int], waiting: tuple[str, ...]
) -> int | None:
    """Dimension of a shape that is made of others."""
    of = arguments.get("of") if isinstance(arguments, dict) else None
    expression = parsed(of[0] if isinstance(of, list) and of else of)
    if expression is None:
        return None
    for name in expression.names:
        _find(name, shapes, found, waiting)
    try:
        return expression.dimension(found)
    except (ValueError, KeyError):
        return None


def _of_box(arguments: Any) -> int | None:
    box = arguments.get("box") if isinstance(arguments, dict) else None
    if isinstance(box, list) and box and isinstance(box[0], list) and len(box[0]) in (2, 3):
        return len(box[0])
    return None
