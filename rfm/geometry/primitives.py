"""The registry of primitives by kind, and the primitive given by a formula.

``KINDS`` maps the names of a case file to constructors; their keyword arguments are the arguments
of the case file (angles, there, are converted to radians by the reader of the file).
"""

from __future__ import annotations

from collections.abc import Callable
from types import MappingProxyType

from rfm.calculus.types import Field
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.boundaries.curve import curve
from rfm.geometry.box import Box
from rfm.geometry.checks import positive, shown
from rfm.geometry.outlines.outline import outline
from rfm.geometry.outlines.polygon import polygon
from rfm.geometry.outlines.polyhedron import polyhedron
from rfm.geometry.primitives_1d import interval
from rfm.geometry.primitives_2d import Vector, disk, ellipse, half_plane, rectangle, strip
from rfm.geometry.primitives_3d import ball, box, cone, cylinder, ellipsoid, half_space, slab, torus
from rfm.geometry.shape import Shape, single
from rfm.geometry.surface import Surface


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


KINDS: MappingProxyType[str, Callable[..., Shape]] = MappingProxyType(
    {
        "interval": interval,
        "half_plane": half_plane,
        "disk": disk,
        "ellipse": ellipse,
        "rectangle": rectangle,
        "strip": strip,
        "polygon": polygon,
        "outline": outline,
        "half_space": half_space,
        "ball": ball,
        "ellipsoid": ellipsoid,
        "box": box,
        "slab": slab,
        "cylinder": cylinder,
        "cone": cone,
        "torus": torus,
        "polyhedron": polyhedron,
        "curve": curve,
        "function": function,
    }
)
