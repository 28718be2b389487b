"""Distances: functions normalised on a part of the boundary.

Notation: w is *normalised to order m* as in ``rfm.geometry.normalisation``; source: Shapiro, Acta Numerica 2007,
equations (4.9) and (4.10), and Theorem 4 (R0-functions of normalised functions are normalised away from corners).
"""

from __future__ import annotations

from collections.abc import Iterable

from rfm.calculus.r_systems import R0
from rfm.calculus.types import Field
from rfm.geometry.normalisation import normalise, raised
from rfm.geometry.part import Part, union
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface
from rfm.geometry.vanishing import Joined, factors


def distance(shape: Shape, part: Part | Iterable[Part], order: int = 1) -> Field:
    """Return a function that is zero on a part, positive elsewhere in the shape, with unit normal slope.

    Smooth except at corners of the part, where no normal exists.  The factors of a weight, each
    normalised, joined by R0-conjunction (which keeps the normalisation: Theorem 4), whatever the systems
    of the shape's operations; orders above 1 by (4.10).  The constant 1 for an empty part.

    Raises
    ------
    GeometryError
        When the order is not at least 1.
    """
    wanted = part if isinstance(part, Part) else union(part)
    dim = shape.dimension
    table: dict[Surface, Field] = {}

    def function(surface: Surface) -> Field:
        if surface not in table:
            table[surface] = surface.function if surface.normalised else normalise(surface.function, dim)
        return table[surface]

    fields = tuple(factor.field for factor in factors(shape.expression.plain(), wanted, R0, function))
    return raised(Joined(fields, R0), dim, order) if fields else lambda *coords: 1.0
