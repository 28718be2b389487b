"""Lifting: from functions of some coordinates to functions of more, constant along the others.

The Cartesian product of sets is the intersection of two cylinders over them: with f on the first
coordinates and g on the rest, ``f(x) ^ g(y)`` is positive exactly in the product (Shapiro, Acta Numerica
2007, Theorem 3, with the product as one more set operation of the predicate).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rfm.calculus.types import Array, Field, Value
from rfm.geometry.support import Support
from rfm.geometry.surface import Surface

_PARALLEL = 1e-14


@dataclass(frozen=True)
class Lifted:
    """A field of the coordinates ``start <= k < stop``, constant along the others; slopes stay."""

    field: Field
    start: int
    stop: int

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.field(*coords[self.start : self.stop])


def lifted(surface: Surface, start: int, stop: int) -> Surface:
    """Cylinder over a surface; its label and what is known of its function stay."""
    pieces = tuple(replace(piece, where=Lifted(piece.where, start, stop)) for piece in surface.pieces)
    return replace(surface, function=Lifted(surface.function, start, stop), pieces=pieces)


def product_reach(first: Support, second: Support, split: int) -> Support:
    """Reach of a product: the sum of the reaches in either set of coordinates.

    Parameters
    ----------
    first, second
        Reaches of the factors, for unit directions.
    split
        Number of coordinates of the first factor.
    """

    def reach(directions: Array) -> Array:
        parts = (first, directions[:, :split]), (second, directions[:, split:])
        return np.asarray(np.sum([_homogeneous(support, part) for support, part in parts], axis=0))

    return reach


def _homogeneous(support: Support, directions: Array) -> Array:
    """Reach in directions of any length; none where the length is zero."""
    length = np.linalg.norm(directions, axis=1)
    along = length > _PARALLEL
    result = np.zeros(len(directions))
    if along.any():
        result[along] = length[along] * support(directions[along] / length[along, None])
    return result
