"""Distances: functions normalised on a part of the boundary.

Notation: w is *normalised to order m* when ``w = 0``, ``dw/dn = 1`` and ``d^k w/dn^k = 0`` for
k = 2..m on the part, n the inward unit normal; source: Shapiro, Acta Numerica 2007, equations (4.9)
and (4.10), and Theorem 4 (R0-functions of normalised functions are normalised away from corners).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from math import factorial, prod

from rfm.calculus.functions import sqrt
from rfm.calculus.jets import derivative, gradient, multi_indices
from rfm.calculus.r_systems import R0
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.part import Part, union
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface
from rfm.geometry.vanishing import factors


def normalise(field: Field, dim: int, order: int = 1) -> Field:
    """Normalise a function whose gradient does not vanish on its zero set.

    Order 1 is (4.9), ``f / sqrt(f^2 + |grad f|^2)``; higher orders remove one normal derivative after
    the other, (4.10).

    Raises
    ------
    GeometryError
        When the order is not at least 1.
    """
    if order < 1:
        raise GeometryError(f"order of normalisation must be at least 1, got {order}")
    first = Normalised(field, gradient(field, dim))
    current: Field = first
    for degree in range(2, order + 1):
        current = _corrected(current, first, dim, degree)
    return current


def distance(shape: Shape, part: Part | Iterable[Part], order: int = 1) -> Field:
    """Return a function that is zero on a part, positive elsewhere in the shape, with unit normal slope.

    Smooth except at corners of the part, where no normal exists.  The factors of a weight, each
    normalised, joined by R0-conjunction (which keeps the normalisation: Theorem 4); orders above 1
    by (4.10).  The constant 1 for an empty part.
    """
    wanted = part if isinstance(part, Part) else union(part)
    dim = shape.dimension
    table: dict[Surface, Field] = {}

    def function(surface: Surface) -> Field:
        if surface not in table:
            table[surface] = surface.function if surface.normalised else normalise(surface.function, dim)
        return table[surface]

    fields = tuple(factor.field for factor in factors(shape.expression, wanted, R0, function))
    if not fields:
        return lambda *coords: 1.0
    joined = Nearest(fields)
    return joined if order == 1 else normalise(joined, dim, order)


@dataclass(frozen=True, eq=False)
class Normalised:
    """Equation (4.9)."""

    field: Field
    slopes: tuple[Field, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value = self.field(*coords)
        slopes = [slope(*coords) for slope in self.slopes]
        return value / sqrt(reduce(lambda total, s: total + s * s, slopes, value * value))


@dataclass(frozen=True, eq=False)
class Nearest:
    """R0-conjunction of normalised fields."""

    fields: tuple[Field, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return R0.conjunction(*(field(*coords) for field in self.fields))


def _corrected(field: Field, first: Field, dim: int, degree: int) -> Field:
    """One step of (4.10): ``w - (1/k!) w1^k D_k w``, D_k the k-th derivative along grad w1."""
    slopes = gradient(first, dim)
    alphas = [alpha for alpha in multi_indices(dim, degree) if sum(alpha) == degree]
    terms = [(alpha, derivative(field, alpha)) for alpha in alphas]

    def corrected(*coords: Value) -> Value:
        along = [slope(*coords) for slope in slopes]
        total: Value = 0.0
        for alpha, partial in terms:
            factor = 1.0 / prod(factorial(power) for power in alpha)
            for component, power in zip(along, alpha, strict=True):
                for _ in range(power):
                    factor = factor * component
            total = total + factor * partial(*coords)
        return field(*coords) - first(*coords) ** degree * total

    return corrected
