r"""The criterion of singular points: functions that vanish where the R-function of a shape is not smooth.

An R-operation on two functions f, g is analytic except where its criterion kappa(f, g) vanishes: for the systems with a
root, R_0, R_alpha, R_p, that is where f = g = 0, and kappa is the radicand or a multiple of it.  A shape is a tree of
such operations; with kappa_i of the i-th one

.. math:: K = \prod_i \kappa_i

vanishes exactly where some operation is singular.  Not all of these points are corners of the shape: two circles may
cross inside a third.  Those on the final boundary satisfy K = 0 and w = 0, w the R-function of the whole shape, and
still may be smooth; :func:`rfm.geometry.singular.corners.corners` finds the ones that are not.

An operation of n operands counts as n - 1 of two, combined from the left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

from rfm.calculus.r_systems import R0, RSystem
from rfm.calculus.types import Field, Value
from rfm.geometry.expression import Conjunction, Disjunction, Expression, Literal
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface


@dataclass(frozen=True, eq=False)
class Operation:
    """An R-operation of two operands in the expression of a shape.

    Attributes
    ----------
    kind
        ``intersection`` or ``union``.
    first, second
        The operands; the first may itself be the result of an operation.
    system
        The system of R-functions.
    """

    kind: str
    first: Expression
    second: Expression
    system: RSystem

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """Surfaces that occur in the operands."""
        return tuple(dict.fromkeys((*self.first.surfaces(), *self.second.surfaces())))

    def kappa(self, *coords: Value) -> Value:
        """Criterion of this operation at the coordinates."""
        system = self.system.at(*coords)
        return system.kappa(value(self.first, system, coords), value(self.second, system, coords))


@dataclass(frozen=True, eq=False)
class Criterion:
    """K, the product of the criteria of all operations; 1 for a shape of one surface."""

    operations: tuple[Operation, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return reduce(lambda a, b: a * b, [one.kappa(*coords) for one in self.operations], 1.0)


def operations(shape: Shape, system: RSystem = R0) -> tuple[Operation, ...]:
    """R-operations of a shape's expression, inner ones first.

    Parameters
    ----------
    shape
        The shape.
    system
        The system of R-functions that evaluates it.
    """
    return tuple(_below(shape.expression, system))


def criterion(shape: Shape, system: RSystem = R0) -> Field:
    """Return K of a shape as a field."""
    return Criterion(operations(shape, system))


def value(expression: Expression, system: RSystem, coords: Sequence[Value]) -> Value:
    """R-function of an expression at coordinates."""
    return expression.fold(
        lambda surface, positive: surface.function(*coords) if positive else -surface.function(*coords),
        lambda terms: system.conjunction(*terms),
        lambda terms: system.disjunction(*terms),
    )


def _below(expression: Expression, system: RSystem) -> list[Operation]:
    if isinstance(expression, Literal):
        return []
    if not isinstance(expression, Conjunction | Disjunction):
        raise TypeError("an expression is a Literal, a Conjunction or a Disjunction")
    node = type(expression)
    kind = "intersection" if isinstance(expression, Conjunction) else "union"
    found = [inner for term in expression.terms for inner in _below(term, system)]
    for count in range(1, len(expression.terms)):
        head = expression.terms[:count]
        first = head[0] if count == 1 else node(head)
        found.append(Operation(kind, first, expression.terms[count], system))
    return found
