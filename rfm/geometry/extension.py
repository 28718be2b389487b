"""Extension of boundary data into the domain, constant along normals.

Notation: w is normalised on the part (``rfm.geometry.distance``); ``f*(x) = f(x - w grad w)`` agrees
with f on the part and has zero normal derivative there; source: Shapiro, Acta Numerica 2007, (7.2).
"""

from __future__ import annotations

from dataclasses import dataclass

from rfm.calculus.jets import gradient
from rfm.calculus.types import Field, Value


def extend(field: Field, distance: Field, dim: int) -> Field:
    """Return the extension (7.2) of boundary data.

    Parameters
    ----------
    field
        Data, defined near the part.
    distance
        Function normalised (at least to first order) on the part.
    dim
        Number of coordinates.
    """
    return Extended(field, distance, gradient(distance, dim))


@dataclass(frozen=True, eq=False)
class Extended:
    """Equation (7.2)."""

    field: Field
    distance: Field
    slopes: tuple[Field, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value of the data at (about) the nearest point of the part."""
        value = self.distance(*coords)
        nearest = (x - value * slope(*coords) for x, slope in zip(coords, self.slopes, strict=True))
        return self.field(*nearest)
