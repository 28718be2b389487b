"""What must be known before a case can be validated: the values of its parameters and its dimension."""

from __future__ import annotations

from collections import Counter
from typing import Any

from rfm.app.domain import DomainExpression
from rfm.app.expressions import Expression, ExpressionError
from rfm.app.schema.scalars import Scope, check_name, shown
from rfm.app.schema.shapes import KINDS
from rfm.app.source import Document
from rfm.errors import CaseError

MAX_PARAMETERS = 500


def scope_of_document(document: Document) -> tuple[Scope, list[CaseError]]:
    """Scope of a case and the errors in its parameters."""
    values, errors = parameters(document)
    found, product = dimension(document.data)
    return Scope(values, found, product), errors


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


def dimension(data: dict[str, Any]) -> tuple[int | None, bool]:
    """Dimension of the domain of a case that has not been validated, and whether it multiplies shapes.

    Without a product it is that of most shapes; None when no shape tells it.
    """
    geometry = data.get("geometry")
    shapes = geometry.get("shapes") if isinstance(geometry, dict) else None
    if not isinstance(geometry, dict) or not isinstance(shapes, dict):
        return None, False
    found = {name: _dimension_of(shape) for name, shape in shapes.items() if isinstance(shape, dict)}
    known = {name: item for name, item in found.items() if item}
    try:
        domain = DomainExpression.parse(geometry["domain"])
    except (CaseError, KeyError, TypeError, AttributeError):
        domain = None  # the validation of the domain says what is wrong, also with its dimension
    if domain is not None and domain.product:
        try:
            return domain.dimension(known), True
        except (ValueError, KeyError):
            return None, True
    counts = Counter(item for item in known.values() if item > 1)
    return counts.most_common(1)[0][0] if counts else None, False


def _dimension_of(shape: dict[str, Any]) -> int | None:
    for name, arguments in shape.items():
        kind = KINDS.get(name)
        if kind is not None and kind.dimension:
            return kind.dimension
        box = arguments.get("box") if isinstance(arguments, dict) else None
        if name == "function" and isinstance(box, list) and box and isinstance(box[0], list):
            return len(box[0]) if len(box[0]) in (2, 3) else None
    return None
