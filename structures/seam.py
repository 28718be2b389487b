r"""A structure continued periodically: u(x + T) = c u(x) with all derivatives, for psi with the same property.

The coefficients of a structure (its weight, its data) need not be periodic although the conditions are: the weight of
a hole knows nothing of the hole's images.  Around the seam, the face B = A + T, they pass from what they are before it
to what they are behind A,

.. math:: a_{per}(x) = a(x) + S_B(x)\,\bigl(a(x - T) - a(x)\bigr) + S_A(x)\,\bigl(a(x + T) - a(x)\bigr),
          \qquad S_B = S(t),\; S_A = 1 - S(t + T),

with a step S from 0 to 1 of m continuous derivatives that begins before B and ends behind A.  A convex combination of
structures that satisfy the conditions satisfies them, and of positive weights is positive.  Then

.. math:: u = a_{per}\psi + b_{per}, \qquad b(x \mp T) \text{ with the factor } c^{\pm 1} = c,

c being 1 or -1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import comb

import numpy as np

from rfm.calculus.jets import Jet
from rfm.calculus.selection import where
from rfm.calculus.types import Field, Value
from structures.field_expression import Constant, FieldExpr, field
from structures.operator import Operator


@dataclass(frozen=True)
class Step:
    r"""0 below 0, 1 above 1, in between :math:`t^{m+1} \sum_{k \le m} \binom{m+k}{k} (1 - t)^k`: m smooth derivatives.

    It is a function of one coordinate, t = (x[axis] - start) / length.
    """

    axis: int
    start: float
    length: float
    order: int

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        t = (coords[self.axis] - self.start) * (1.0 / self.length)
        rest = 1.0 - t
        total: Value = float(comb(2 * self.order, self.order))
        for k in range(self.order - 1, -1, -1):
            total = total * rest + float(comb(self.order + k, k))
        plain = t.value if isinstance(t, Jet) else t
        return where(plain > 0.0, where(plain < 1.0, t ** (self.order + 1) * total, 1.0), 0.0)


@dataclass(frozen=True)
class Seam:
    """Where a structure passes from one period to the next.

    Attributes
    ----------
    axis, lower, upper
        The faces A and B are x[axis] = lower and upper.
    before, behind
        Lengths over which it passes, in front of B and behind A.
    order
        m, continuous derivatives of the step.
    """

    axis: int
    lower: float
    upper: float
    before: float
    behind: float
    order: int

    @property
    def period(self) -> float:
        """T."""
        return self.upper - self.lower

    def step(self, turns: int) -> Step:
        """S of a point, or of its image `turns` periods further."""
        start = self.upper - self.before - turns * self.period
        return Step(self.axis, start, self.before + self.behind, self.order)

    def continued(self, f: FieldExpr, factor: float = 1.0) -> FieldExpr:
        """Return the field with f(x + T) = factor f(x) that is f away from the seam."""
        if isinstance(f, Constant) and factor == 1.0:
            return f
        return field(_Continued(f, self, factor))


@dataclass(frozen=True, eq=False)
class _Continued:
    of: Field
    seam: Seam
    factor: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates; images count only where their step does, elsewhere they may be undefined."""
        value = self.of(*coords)
        for turns, gone in ((0, -self.seam.period), (1, self.seam.period)):
            step = self.seam.step(turns)(*coords)
            share = 1.0 - step if turns else step
            plain = share.value if isinstance(share, Jet) else share
            with np.errstate(all="ignore"):
                image = self.factor * self.of(*shifted(coords, self.seam.axis, gone))
                value = value + where(plain != 0.0, share * (image - value), 0.0)
        return value


def shifted(coords: tuple[Value, ...], axis: int, distance: float) -> tuple[Value, ...]:
    """Coordinates of the points moved along an axis."""
    return tuple(x + distance if k == axis else x for k, x in enumerate(coords))


def across(operator: Operator, seam: Seam, factor: float) -> Operator:
    """Return the structure with u(x + T) = factor u(x) for every psi with that property; see the module."""
    terms = tuple(replace(term, coefficient=seam.continued(term.coefficient)) for term in operator.terms)
    return replace(operator, offset=seam.continued(operator.offset, factor), terms=terms)
