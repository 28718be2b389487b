"""Operators as polynomials in w: what a differential operator sees of them on w = 0.

    u = sum_{k=0..m} w^k / k! U_k,    du/dx_j = sum_k w^k / k! (dU_k/dx_j + dw/dx_j U_{k+1}).

On the part w = 0 only the level U_0 remains, so the boundary value of an operator of order k applied to u
contains U_0, ..., U_k and no more of their derivatives than needed.  Written out as one field, u = psi +
w^2/2 F has the derivatives of F in every condition of third order, multiplied with w: they vanish on the
part, and the levels never write them down.

Notation: w vanishes on the part with unit inward slope; U_k (*levels*) are affine operators
(:mod:`structures.operator`).  Levels of index above m are zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

from rfm.calculus.types import Field
from structures.field_expression import FieldExpr, differentiate, field, unit
from structures.operator import Operator, differentiated, known


@dataclass(frozen=True, eq=False)
class Layers:
    """The operator sum w^k / k! U_k; see the module's docstring.

    Attributes
    ----------
    w
        Zero on the part.
    levels
        U_0, ..., U_m.
    """

    w: FieldExpr
    levels: tuple[Operator, ...]

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return self.levels[0].dimension

    @property
    def trace(self) -> Operator:
        """U_0: equal to u on the part."""
        return self.levels[0]

    def total(self) -> Operator:
        """Return u as one operator."""
        result = self.levels[0]
        for k, level in enumerate(self.levels[1:], 1):
            result = result + (self.w**k / float(factorial(k))) * level
        return result

    def raised(self, k: int, change: Operator) -> Layers:
        """Return u + w^k / k! ``change``."""
        levels = list(self.levels) + [known(self.dimension, 0.0)] * (k + 1 - len(self.levels))
        levels[k] = levels[k] + change
        return Layers(self.w, tuple(levels))

    def __add__(self, other: Layers) -> Layers:
        """Add level by level."""
        count = max(len(self.levels), len(other.levels))
        pairs = zip(_padded(self, count), _padded(other, count), strict=True)
        return Layers(self.w, tuple(a + b for a, b in pairs))

    def __sub__(self, other: Layers) -> Layers:
        """Subtract level by level."""
        return self + (-1.0) * other

    def __mul__(self, factor: Field | FieldExpr | float) -> Layers:
        """Multiply every level with a field or a number."""
        return Layers(self.w, tuple(field(factor) * level for level in self.levels))

    def __rmul__(self, factor: Field | FieldExpr | float) -> Layers:
        """Multiply with a field on the left."""
        return self * factor


def layer(w: Field | FieldExpr, levels: Sequence[Operator]) -> Layers:
    """Return sum w^k / k! U_k."""
    return Layers(field(w), tuple(levels))


def slopes(w: Field | FieldExpr, dimension: int) -> tuple[FieldExpr, ...]:
    """Return the components of grad w: on w = 0 the unit normal into the domain."""
    return tuple(differentiate(w, unit(dimension, axis)) for axis in range(dimension))


def partial(u: Layers, axis: int) -> Layers:
    """Return du/dx_axis."""
    slope = differentiate(u.w, unit(u.dimension, axis))
    above = [*u.levels[1:], None]
    levels = [
        differentiated(level, axis) + slope * upper if upper is not None else differentiated(level, axis)
        for level, upper in zip(u.levels, above, strict=True)
    ]
    return Layers(u.w, tuple(levels))


def directional(direction: Sequence[FieldExpr | float], u: Layers) -> Layers:
    """Return sum_j direction_j du/dx_j."""
    terms = [component * partial(u, axis) for axis, component in enumerate(direction)]
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


def _padded(u: Layers, count: int) -> list[Operator]:
    return [*u.levels, *[known(u.dimension, 0.0)] * (count - len(u.levels))]
