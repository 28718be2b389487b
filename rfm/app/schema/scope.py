"""What must be known before a case can be validated: the values of its parameters and its dimension."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from rfm.app.expressions import Expression, ExpressionError
from rfm.app.schema.dimensions import dimensions, parsed
from rfm.app.schema.scalars import Scope, check_name, shown
from rfm.app.source import Document
from rfm.errors import CaseError

MAX_PARAMETERS = 500


def scope_of_document(document: Document) -> tuple[Scope, list[CaseError]]:
    """Scope of a case and the errors in its parameters."""
    values, errors = parameters(document)
    scope = scope_of_shapes(document.data, values)
    return replace(scope, mentioned=in_regions(document.data)), errors


def parameters(document: Document) -> tuple[dict[str, float], list[CaseError]]:
    """Values of the parameters; each may be an expression of those before it.

    A parameter in error gets the value 1, so that it causes no further errors where it is used.
    """
    given = document.data.get("parameters")
    values: dict[str, float] = {}
    errors: list[CaseError] = []
    if not isinstance(given, dict):
        return values, errors
    if len(given) > MAX_PARAMETERS:
        errors.append(document.error(("parameters",), f"more than {MAX_PARAMETERS} parameters", key=True))
    for name, value in list(given.items())[:MAX_PARAMETERS]:
        path = ("parameters", name)
        wrong = check_name(name, "parameter")
        if wrong:
            errors.append(document.error(path, wrong, key=True))
            continue
        try:
            values[name] = _parameter(value, values)
        except ExpressionError as error:
            errors.append(document.error(path, error.message, offset=error.offset))
        except ValueError as error:
            errors.append(document.error(path, str(error)))
        values.setdefault(name, 1.0)
    return values, errors


def _parameter(value: Any, earlier: dict[str, float]) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"must be a number or an expression of earlier parameters, got {shown(value)}")
    constant = Expression(str(value), earlier, ()).constant
    if constant is None or isinstance(constant, bool):
        raise ValueError("must be a number, not a condition")
    return float(constant)


def in_regions(data: dict[str, Any]) -> frozenset[str]:
    """Names in the regions of the inclusions of a case that has not been validated."""
    equation = data.get("equation")
    found: set[str] = set()
    for given in equation.values() if isinstance(equation, dict) else ():
        inclusions = given.get("inclusions") if isinstance(given, dict) else None
        for item in inclusions if isinstance(inclusions, list) else ():
            if isinstance(item, dict):
                found.update(re.findall(r"\w+", str(item.get("region", ""))))
    return frozenset(found)


def scope_of_shapes(data: dict[str, Any], values: dict[str, float]) -> Scope:
    """Scope with the dimension of the domain of a case that has not been validated.

    Without a product it is that of most shapes the domain names; None when none of them tells it.
    """
    geometry = data.get("geometry")
    shapes = geometry.get("shapes") if isinstance(geometry, dict) else None
    if not isinstance(geometry, dict) or not isinstance(shapes, dict):
        return Scope(values)
    known, domain = dimensions(shapes), parsed(geometry.get("domain"))
    named = shapes if domain is None else domain.names
    mentioned = {name for value in shapes.values() for name in _mentioned(value)}
    own = tuple((shapes[name], known[name]) for name in known if name in mentioned and name not in named)
    if domain is not None and domain.product:
        try:
            return Scope(values, domain.dimension(known), True, own)
        except (ValueError, KeyError):
            return Scope(values, None, True, own)
    counts = Counter(item for name, item in known.items() if item > 1 and (name in named or not own))
    return Scope(values, counts.most_common(1)[0][0] if counts else None, False, own)


def _mentioned(value: Any) -> Iterator[str]:
    """Names in the texts of a shape's arguments that may be shapes."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            yield from _mentioned(item)
    elif isinstance(value, str):
        expression = parsed(value)
        yield from expression.names if expression is not None else ()
