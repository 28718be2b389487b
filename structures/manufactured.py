"""Boundary data that do not hand the solver the answer.

With a known solution one is tempted to extend its boundary values by the solution itself.  Then
u0 is the solution, psi = 0, and the solver has nothing to do: every error measured is rounding.  The data
of a part are its values *on* the part; any field with these values will do, and an honest test
takes one that is wrong inside.  Here it is

    g = exact + weight * q,

which has the values of ``exact`` where the weight vanishes and misses it by order one elsewhere, so that
psi must become a generic smooth function (-q when the structure's weight is the same).  q is fixed, has
several scales, no symmetry, and is not a polynomial, so no spline space reproduces it.

Notation: xi_k = (x_k - c_k) / h_k, c the centre and h_k the half widths of a box around the domain.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import exp, sin
from rfm.calculus.types import Field, Value
from rfm.geometry.box import Box
from structures.contact import finite_box
from structures.field_expression import FieldExpr, field

# Slopes and phases without rational relations to each other or to the coordinate axes.
_GROWTH = (0.53, -0.31, 0.37)
_WAVE = (0.91, 1.73, -1.13)
_PHASE = 0.41
_MEAN = 1.2


@dataclass(frozen=True)
class GenericField:
    """q(xi) = exp(a . xi) (1.2 + sin(b . xi + 0.41)) / 1.2 with fixed generic a, b: smooth and of order one."""

    center: tuple[float, ...]
    half_width: tuple[float, ...]

    def __call__(self, *coords: Value) -> Value:
        """Evaluate at coordinates of any kind."""
        xi = [(x - c) / h for x, c, h in zip(coords, self.center, self.half_width, strict=True)]
        growth = sum(a * t for a, t in zip(_GROWTH, xi, strict=False))
        wave = sum(b * t for b, t in zip(_WAVE, xi, strict=False))
        return exp(growth) * (_MEAN + sin(wave + _PHASE)) / _MEAN


def generic_field(box: Box) -> GenericField:
    """Return the fixed q of order one in the coordinates of ``box``."""
    finite = finite_box(box)
    lower, upper = np.array(finite.lower), np.array(finite.upper)
    half = np.where(upper > lower, (upper - lower) / 2, 1.0)
    return GenericField(tuple(((lower + upper) / 2).tolist()), tuple(half.tolist()))


def manufactured_extension(exact: Field, weight: Field, box: Box) -> FieldExpr:
    """Return ``exact + weight * q``: the values of ``exact`` on weight = 0, order one away from it inside.

    Parameters
    ----------
    exact
        The known solution.
    weight
        Zero on the parts that carry the data.
    box
        Finite box around the domain; fixes the scale of q.
    """
    return field(exact) + field(weight) * generic_field(box)
