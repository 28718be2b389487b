"""The registry of primitives by kind, and the primitive given by a formula.

``KINDS`` maps the names of a case file to constructors; their keyword arguments are the arguments
of the case file (angles, there, are converted to radians by the reader of the file).
"""

from __future__ import annotations

from collections.abc import Callable

from rfm.calculus.types import Field
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.box import Box
from rfm.geometry.checks import positive, shown
from rfm.geometry.primitives_2d import Vector
from rfm.geometry.shape import Shape, single
from rfm.geometry.surface import Surface
from rfm.lazy import Registry


def function(
    expression: Field,
    box: Box | tuple[Vector, Vector] | None = None,
    *,
    dimension: int | None = None,
    degree: int | None = None,
    size: float | None = None,
) -> Shape:
    """Points at which a smooth field is positive.

    Parameters
    ----------
    expression
        The field; its gradient must not vanish on the boundary.
    box
        A box that contains the set, as a `Box` or its two corners; None when the set is unbounded.
    dimension
        Number of coordinates; that of the box by default.
    degree
        Total degree when the field is a polynomial, otherwise None.
    size
        Feature size; by default half the shortest side of the box.

    Raises
    ------
    GeometryError
        When neither a box nor a dimension is given, or the two differ.
    """
    if box is not None and not isinstance(box, Box):
        lower, upper = box
        box = Box(tuple(map(float, lower)), tuple(map(float, upper)))
    if dimension is None:
        if box is None:
            raise GeometryError("a function shape needs a box such as [[-1, -1], [1, 1]] (or its dimension)")
        dimension = box.dimension
    if dimension not in (2, 3):
        raise GeometryError(f"dimension must be 2 or 3, got {shown(dimension)}")
    if box is not None and box.dimension != dimension:
        raise GeometryError(f"the box has dimension {box.dimension}, the function {dimension}")
    if box is not None and box.empty:
        raise GeometryError(f"max must exceed min in every component, got min {box.lower}, max {box.upper}")
    reach = support.everything if box is None else support.aligned(box)
    if size is None:
        size = 1.0 if box is None or not box.finite else 0.5 * min(box.size)
    surface = Surface((), expression, degree=degree, size=positive("size", size))
    return single(surface, dimension, reach)


KINDS: Registry[Callable[..., Shape]] = Registry(
    {
        "interval": "rfm.geometry.primitives_1d:interval",
        "half_plane": "rfm.geometry.primitives_2d:half_plane",
        "disk": "rfm.geometry.primitives_2d:disk",
        "ellipse": "rfm.geometry.primitives_2d:ellipse",
        "rectangle": "rfm.geometry.primitives_2d:rectangle",
        "strip": "rfm.geometry.primitives_2d:strip",
        "polygon": "rfm.geometry.outlines.polygon:polygon",
        "outline": "rfm.geometry.outlines.outline:outline",
        "half_space": "rfm.geometry.primitives_3d:half_space",
        "ball": "rfm.geometry.primitives_3d:ball",
        "ellipsoid": "rfm.geometry.primitives_3d:ellipsoid",
        "box": "rfm.geometry.primitives_3d:box",
        "slab": "rfm.geometry.primitives_3d:slab",
        "cylinder": "rfm.geometry.primitives_3d:cylinder",
        "cone": "rfm.geometry.primitives_3d:cone",
        "torus": "rfm.geometry.primitives_3d:torus",
        "polyhedron": "rfm.geometry.outlines.polyhedron:polyhedron",
        "curve": "rfm.geometry.boundaries.curve:curve",
        "function": "rfm.geometry.primitives:function",
    }
)
