"""Trimming: from a carrier, a function that vanishes on a piece of it only.

Notation: ``f`` is zero on the carrier and positive inside the domain; ``t`` is positive on the piece
that is kept.  Both functions below are zero on the piece ``f = 0, t >= 0`` and keep the slope of f
there; source: Shapiro, Acta Numerica 2007, section 5, equation (5.1).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt as root

from rfm.calculus.functions import sqrt
from rfm.calculus.r_systems import R0
from rfm.calculus.types import Field, Value


def trimmed(f: Value, t: Value) -> Value:
    """Equation (5.1): ``sqrt(f^2 + (sqrt(t^2 + f^4) - t)^2 / 4)``.

    Positive everywhere but on the piece, hence like ``|f|`` near it, with a kink across the boundary:
    good as a distance, not as a weight whose integrand is continued beyond the boundary.
    """
    squared = f * f
    excess = sqrt(t * t + squared * squared) - t
    return sqrt(squared + 0.25 * (excess * excess))


def trimmed_inside(f: Value, t: Value) -> Value:
    """Trim for the inside of the domain: ``f v (-(f + t) / sqrt 2)`` with the R0-disjunction.

    Zero on the piece and positive elsewhere *in the closed domain* (where f >= 0 near the piece, or
    t < 0).  Unlike (5.1) it changes sign across the piece, so it is smooth on both sides of the
    boundary and only the ends of the piece are singular.  The price is a second zero set, f = -t < 0,
    which lies outside the domain.
    """
    return R0.disjunction(f, (f + t) * (-1.0 / root(2.0)))


@dataclass(frozen=True, eq=False)
class Trimmed:
    """The field :func:`trimmed_inside` of two fields."""

    field: Field
    where: Field

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return trimmed_inside(self.field(*coords), self.where(*coords))
