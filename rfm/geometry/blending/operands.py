"""What blends work on: shapes as single functions with unit slope, and how a blended shape is put together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import sqrt
from rfm.calculus.jets import derivatives
from rfm.calculus.r_systems import R0
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.blending.clearance import cleared
from rfm.geometry.checks import shown
from rfm.geometry.shape import Shape, single
from rfm.geometry.support import Support
from rfm.geometry.surface import Surface
from rfm.geometry.vanishing import Composition

OPERATIONS = {"union": 1.0, "intersection": -1.0}
"""Sign of the root in the R-function of an operation."""


@dataclass(frozen=True, eq=False)
class Levelled:
    """``f / sqrt(|grad f|^2 + (f/L)^2)``, L the size of the feature: unit slope at the zeros, at most L.

    Shapiro, Acta Numerica 2007, equation (4.9), made independent of the unit of length.
    """

    field: Field
    size: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value, *slopes = derivatives(self.field, coords, 1)[: len(coords) + 1]
        scaled = value * (1.0 / self.size)
        return value / sqrt(sum((s * s for s in slopes), scaled * scaled))


def levelled(surface: Surface) -> Field:
    """Return the surface's function with unit slope at its zeros."""
    if surface.normalised:
        return surface.function
    return Levelled(surface.function, surface.size if math.isfinite(surface.size) else 1.0)


def function_of(shape: Shape) -> Field:
    """One function of a shape, with unit slope on its boundary: R0-functions of its surfaces.

    Smooth for a shape of one surface; for others its corners stay.
    """
    surfaces = {surface: levelled(surface) for surface in shape.surfaces}
    return Composition(shape.expression, R0, surfaces.__getitem__)


def size_of(shapes: Sequence[Shape]) -> float:
    """Smallest feature size of shapes."""
    return min(surface.size for shape in shapes for surface in shape.surfaces)


def require_operands(shapes: Sequence[Shape], operation: str) -> float:
    """Check the shapes and the name of an operation, return its sign.

    Raises
    ------
    GeometryError
        For less than two shapes, different dimensions, or an unknown operation.
    """
    if len(shapes) < 2:
        raise GeometryError(f"a blend needs at least two shapes, got {len(shapes)}")
    if len({shape.dimension for shape in shapes}) > 1:
        raise GeometryError("shapes of dimension 2 and 3 cannot be blended")
    if operation not in OPERATIONS:
        raise GeometryError(f"operation must be one of {', '.join(OPERATIONS)}, got {operation!r}")
    return OPERATIONS[operation]


def require_small(name: str, value: float, shapes: Sequence[Shape]) -> None:
    """Refuse a length that exceeds the smallest feature of the shapes.

    Raises
    ------
    GeometryError
        With both lengths.
    """
    limit = size_of(shapes)
    if value > limit:
        raise GeometryError(
            f"{name} must not exceed the size of the shapes ({limit:.6g}), got {shown(value)}"
        )


def blended(shapes: Sequence[Shape], field: Field, sign: float, margin: float) -> Shape:
    """Shape of one surface: a blend of shapes that reaches at most a little beyond their union.

    Parameters
    ----------
    shapes
        What was blended.
    field
        The function of the blend.
    sign
        Of the operation: -1 for an intersection.
    margin
        How far beyond the sharp operation the blend reaches; 0 when it only removes.
    """
    d = shapes[0].dimension
    join = support.either if sign > 0.0 else support.common
    reach = join(*(shape.reach for shape in shapes))
    surface = Surface((), field, size=size_of(shapes))
    return single(surface, d, widened(reach, field, margin, d, "the blend") if margin > 0.0 else reach)


def widened(reach: Support, field: Field, margin: float, dimension: int, what: str) -> Support:
    """Reach of a set that grew out of one with a known reach, by about ``margin``."""
    box = support.bounding_box(reach, dimension)
    if not box.finite:
        return support.minkowski_sum(reach, support.ball(np.zeros(dimension), margin))
    return support.aligned(cleared(field, box, margin, what))
