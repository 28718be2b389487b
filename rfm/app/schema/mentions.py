"""Which shapes mention which: unknown names, cycles, unused shapes, dimensions that do not fit."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from rfm.app.domain import DomainExpression
from rfm.app.schema.derived import Derived
from rfm.app.schema.scalars import Scope, fail
from rfm.app.schema.shapes import ShapeSpec
from rfm.app.source import nearest
from rfm.app.yaml_reader import Path

Shapes = Mapping[str, ShapeSpec]


def check_names(expression: DomainExpression, shapes: Shapes, path: Path) -> None:
    """Refuse an expression with a name that no shape has.

    Raises
    ------
    PydanticCustomError
        At the name, which stands in the value at `path` of the section `geometry`.
    """
    for name, offset in expression.names.items():
        if name not in shapes:
            raise fail(
                f"unknown shape {name!r}; {nearest(name, shapes, 'shapes')}", value=path, offset=offset
            )


def used_names(domain: DomainExpression, shapes: Shapes, more: Collection[str] = ()) -> set[str]:
    """Names that the domain mentions, or `more`, or a shape that these mention, and so on.

    Raises
    ------
    PydanticCustomError
        For an unknown name or a cycle, at the mention.
    """
    used: set[str] = set()
    for name in shapes:
        _follow(name, shapes, set(), ())
    for name in (*domain.names, *(name for name in sorted(more) if name in shapes)):
        _follow(name, shapes, used, ())
    return used


def dimensions_of(shapes: Shapes, scope: Scope) -> dict[str, int]:
    """Dimension of every shape; what they are made of must fit.

    Raises
    ------
    PydanticCustomError
        At the mention of a shape with a dimension that does not fit.
    """
    found: dict[str, int] = {}
    for name in shapes:
        _dimension(name, shapes, scope, found)
    return found


def _follow(name: str, shapes: Shapes, done: set[str], waiting: tuple[str, ...]) -> None:
    """Add a name and all that it leads to."""
    if name in done:
        return
    spec = shapes[name]
    for path, expression in spec.operands():
        place = ("shapes", name, spec.kind, *path)
        check_names(expression, shapes, place)
        for other, offset in expression.names.items():
            chain = (*waiting, name)
            if other in chain:
                circle = " -> ".join([*chain[chain.index(other) :], other])
                raise fail(
                    f"the shapes are made of each other in a circle: {circle}", value=place, offset=offset
                )
            _follow(other, shapes, done, chain)
    done.add(name)


def _dimension(name: str, shapes: Shapes, scope: Scope, found: dict[str, int]) -> int:
    if name in found:
        return found[name]
    spec, result = shapes[name], 0
    for path, expression in spec.operands():
        for other in expression.names:
            _dimension(other, shapes, scope, found)
        place = ("shapes", name, spec.kind, *path)
        try:
            operand = expression.dimension(found)
        except ValueError as error:
            raise fail(str(error), value=place) from None
        given = spec.given
        wrong = given.refuse(operand) if isinstance(given, Derived) else None
        if wrong is None and result and operand != result:
            wrong = f"shapes of dimension {result} and {operand} cannot be combined"
        if wrong is not None:
            raise fail(wrong, value=place)
        result = operand
    found[name] = spec.given.dimension or result or _told(spec, scope)
    return found[name]


def _told(spec: ShapeSpec, scope: Scope) -> int:
    """Dimension of a function: that of its box, or that of the case."""
    box = getattr(spec.given, "box", None)
    return len(box[0]) if box is not None else scope.dimension or 2
