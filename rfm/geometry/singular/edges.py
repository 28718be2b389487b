"""All edges of a solid, as ordered points on them, and the vertices where they end.

Boxes of the domain in which two surfaces meet and matter are found by interval bounds (none is missed at their size);
every such box is a start for its pair of surfaces.  From a start the curve f = g = 0 is followed both ways: predicted
along the tangent grad f x grad g, corrected by Gauss-Newton steps, with a step that keeps the polygon of points close
to the curve.  It ends at a vertex beyond which the boundary of the *final* shape has no edge there
(:mod:`rfm.geometry.singular.creases`), or where it closes.  Vertices are the common zeros of three surfaces, isolated
and certified (:mod:`rfm.geometry.singular.roots`).

Notation: x a point on the curve, t its unit tangent, h the step, size the longest side of the box.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.box import Box
from rfm.geometry.gauss_newton import nearest_zeros
from rfm.geometry.logic import Logic
from rfm.geometry.shape import Shape
from rfm.geometry.singular.boxes import crowded, search_box, tuples_in
from rfm.geometry.singular.creases import crease
from rfm.geometry.singular.roots import common_zeros, distinct
from rfm.geometry.singular.tracing import Path, distance_to, trace
from rfm.geometry.surface import Surface

DEPTH = 5
"""Halvings of the box: the resolution of starts and the largest first step."""
VERTEX_DEPTH = 4
ACCURACY = 1e-4
"""Distance of the polygon of points from the curve, relative to the size."""


@dataclass(frozen=True, eq=False)
class Edge:
    """A curve on which two surfaces of the boundary meet at an angle.

    Attributes
    ----------
    surfaces
        The two surfaces.
    points
        Points along the edge in order, shape (n, 3), each accurate to rounding; the last repeats the first when it is
        closed.
    angles
        Interior angle in radians at the middle of each piece, shape (n - 1,).
    closed
        Whether it is a loop.
    """

    surfaces: tuple[Surface, Surface]
    points: Array
    angles: Array
    closed: bool

    @property
    def length(self) -> float:
        """Length of the polygon of its points."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())


def edges(shape: Shape, box: Box | None = None, accuracy: float = ACCURACY) -> tuple[Edge, ...]:
    """Find every edge of a solid.

    Parameters
    ----------
    shape
        The shape.
    box
        Where to search; the shape's box by default.
    accuracy
        How close the polygon of points stays to the edge, relative to the size of the box.

    Raises
    ------
    GeometryError
        The shape is not a solid, is unbounded and no box is given, or `accuracy` is not between 0 and 0.1.
    """
    if shape.dimension != 3:
        raise GeometryError(f"edges are for solids, this shape has dimension {shape.dimension}: use corners")
    if not 0 < accuracy <= 0.1:
        raise GeometryError(f"accuracy must be above 0 and at most 0.1, got {accuracy:g}")
    logic = Logic(shape.expression, shape.surfaces)
    lower, upper = search_box(shape, box)
    size = float((upper - lower).max())
    meetings = _vertices(logic, lower, upper)
    boxes_lower, boxes_upper, mask = crowded(logic, lower, upper, 2, DEPTH)
    found: list[Edge] = []
    for (i, j), rows in tuples_in(mask, 2).items():
        ends = [points for triple, points in meetings.items() if i in triple and j in triple]
        path = Path(
            logic, i, j, distinct(np.concatenate([np.empty((0, 3)), *ends]), 1e-9 * size), size, accuracy
        )
        found += _along_pair(path, boxes_lower[rows], boxes_upper[rows])
    return tuple(found)


def vertices(shape: Shape, box: Box | None = None) -> Array:
    """Points (n, 3) where three or more surfaces meet and an edge of the boundary ends or bends."""
    ends = [edge.points[[0, -1]] for edge in edges(shape, box) if not edge.closed]
    size = float((np.subtract(*reversed(search_box(shape, box)))).max())
    return distinct(np.concatenate([np.empty((0, 3)), *ends]), 1e-7 * size)


def _vertices(logic: Logic, lower: Array, upper: Array) -> dict[tuple[int, ...], Array]:
    """Common zeros of three surfaces by the numbers of the surfaces."""
    boxes_lower, boxes_upper, mask = crowded(logic, lower, upper, 3, VERTEX_DEPTH)
    found = {}
    for triple, rows in tuples_in(mask, 3).items():
        fields = [logic.surfaces[i].function for i in triple]
        zeros = common_zeros(fields, boxes_lower[rows], boxes_upper[rows])
        found[triple] = np.concatenate([zeros.points, zeros.contacts])
    return found


def _along_pair(path: Path, lower: Array, upper: Array) -> list[Edge]:
    """Edges of one pair of surfaces through the boxes (n, 3)."""
    centres, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    starts = _starts(path, centres, half)
    found = []
    while len(starts):
        points, closed = trace(path, starts[0], float(half.max()))
        starts = starts[1:][distance_to(points, starts[1:]) > 4 * path.tolerance]
        if len(points) > 1:
            middles = path.corrected(0.5 * (points[1:] + points[:-1]))
            angles = crease(path.logic, path.first, path.second, middles).angle
            surfaces = (path.logic.surfaces[path.first], path.logic.surfaces[path.second])
            found.append(Edge(surfaces, points, angles, closed))
    return found


def _starts(path: Path, centres: Array, half: Array) -> Array:
    """Points of the edge in or beside the boxes."""
    points = distinct(nearest_zeros(path.fields, centres, path.size), path.tolerance)
    away = (np.abs(points[:, None] - centres) / half).max(axis=2).min(axis=1, initial=np.inf)
    points = points[away < 1.5]
    return np.asarray(points[path.sharp(points)]) if len(points) else points
