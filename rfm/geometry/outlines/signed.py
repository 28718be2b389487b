"""A properly signed function from two expressions, of a set and of its complement.

Notation: phi is an expression of the set S, upsilon one of its complement, ``w_phi`` and ``w_upsilon`` their
R-functions.  Each is positive only in its own set, but may vanish inside it (two boxes that share a face:
their union is zero on the face).  Where w_phi vanishes inside S, w_upsilon is negative, unless it vanishes there
as well; so ``w_phi - w_upsilon`` is positive inside, negative outside and zero on the boundary alone, provided
that the two have no zeros in common off the boundary (Shapiro, Acta Numerica 16 (2007), section 5).  The
negation of phi itself will not do for upsilon: it has the same zeros.
"""

from __future__ import annotations

from dataclasses import dataclass

from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape


@dataclass(frozen=True, eq=False)
class SignedDifference:
    """``w_phi - w_upsilon``."""

    inside: Field
    outside: Field

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.inside(*coords) - self.outside(*coords)


def signed_difference(shape: Shape, complement: Shape) -> Field:
    """Return ``w_phi - w_upsilon``, the memberships of a set and of its complement, found in different ways.

    Parameters
    ----------
    shape
        The set; its membership is w_phi.
    complement
        The complement, by another expression than ``~shape``.

    Raises
    ------
    GeometryError
        When the dimensions differ, or the complement is just the negated expression.
    """
    if shape.dimension != complement.dimension:
        raise GeometryError(
            f"the set has dimension {shape.dimension}, the complement {complement.dimension}: they must be equal"
        )
    if complement.expression == shape.expression.negated():
        raise GeometryError("the complement is the negation of the same expression: it has the same zeros")
    return SignedDifference(shape.membership, complement.membership)
