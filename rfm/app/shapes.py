"""From the shapes of a case to their geometry: kinds, shapes made of shapes, and how they are moved."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.app.case import Case
from rfm.app.expressions.nodes import polynomial_degree
from rfm.app.schema.derived import Derived
from rfm.app.schema.primitives import Function
from rfm.app.schema.shapes import MODIFIERS, ShapeSpec
from rfm.app.yaml_reader import Path
from rfm.errors import CaseError, RfmError

if TYPE_CHECKING:
    from rfm.app.domain import DomainExpression
    from rfm.geometry.shape import Shape


def build_shapes(case: Case) -> dict[str, Shape]:
    """Shapes of a case by name, each after those that it is made of.

    Raises
    ------
    CaseError
        At the argument that a constructor refuses.
    """
    from rfm.geometry.predicate import shape as substitute

    built: dict[str, Shape] = {}

    def operand(expression: DomainExpression) -> Shape:
        for name in expression.names:
            of(name)
        return substitute(expression.predicate, {name: built[name] for name in expression.names})

    def of(name: str) -> None:
        if name not in built:
            built[name] = _shape(case, name, case.geometry.shapes[name], operand)

    for name in case.geometry.shapes:
        of(name)
    return built


def _shape(case: Case, name: str, spec: ShapeSpec, operand: Callable[[DomainExpression], Shape]) -> Shape:
    from rfm.geometry.derived import DERIVED
    from rfm.geometry.primitives import KINDS

    kind, given = spec.kind, spec.given
    path: Path = ("geometry", "shapes", name, kind)
    try:
        if isinstance(given, Derived):
            arguments = given.made_of(operand)
            shape = DERIVED[kind](**arguments)
        else:
            arguments = _function(case, given, path) if isinstance(given, Function) else given.arguments()
            shape = KINDS[kind](**arguments)
    except CaseError:
        raise
    except RfmError as error:
        raise _argument_error(case, path, given.arguments(), str(error)) from error
    path = path[:-1]
    for key in MODIFIERS:
        value = getattr(spec, key)
        if value is not None:
            try:
                shape = _MODIFIED[key](shape, value)
            except RfmError as error:
                raise case.error((*path, key), str(error)) from error
    return shape.named(name)


def _tapered(shape: Shape, value: Any) -> Shape:
    from rfm.geometry.transforms import taper

    return taper(shape, value.start, value.end, value.factor)


def _twisted(shape: Shape, degrees: float) -> Shape:
    from rfm.geometry.transforms import twist

    return twist(shape, float(np.deg2rad(degrees)))


def _mapped(shape: Shape, value: Any) -> Shape:
    from rfm.geometry.transforms import affine

    return affine(shape, value.matrix, value.shift)


def _mirrored(shape: Shape, value: Any) -> Shape:
    from rfm.geometry.transforms import mirror

    return mirror(shape, value.point, value.normal)


_MODIFIED: dict[str, Callable[[Any, Any], Any]] = {
    "taper": _tapered,
    "twist": _twisted,
    "affine": _mapped,
    "mirror": _mirrored,
    "scale": lambda shape, factor: shape.scale(factor),
    "rotate": lambda shape, turn: shape.rotate(np.deg2rad(turn.angle), axis=turn.axis, center=turn.center),
    "move": lambda shape, vector: shape.move(vector),
}


def _function(case: Case, given: Function, path: Path) -> dict[str, Any]:
    from rfm.geometry.box import Box

    dimension = len(given.box[0]) if given.box is not None else case.dimension
    field = given.expression.field(dimension, (*path, "expression"))
    arguments = {"expression": field, "dimension": dimension, "degree": polynomial_degree(field.node)}
    return {**arguments, "box": Box(*given.box)} if given.box is not None else arguments


def _argument_error(case: Case, path: Path, arguments: dict[str, Any], message: str) -> CaseError:
    """Error of a constructor; a message that begins with an argument is placed at its key."""
    match = re.match(r"(\w+) (.*)", message, re.DOTALL)
    if match and match[1] in arguments:
        return case.error((*path, match[1]), match[2])
    if len(arguments) == 1:
        return case.error((*path, *arguments), message)
    return case.error(path, message, key=True)
