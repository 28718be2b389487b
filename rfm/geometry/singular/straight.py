r"""Corners between two straight pieces of boundary, in closed form.

The common zero of two lines is known without a search, so this costs a fraction of a millisecond where
:func:`rfm.geometry.singular.corners.corners`, which finds all corners of any shape, needs ten.

Notation: at a corner with interior angle omega polar coordinates are counted so that :math:`\theta = 0` on the *first*
edge, :math:`\theta = \omega` on the *second*, and the domain lies at :math:`0 < \theta < \omega`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import partials
from rfm.calculus.types import Array
from rfm.geometry.expression import Disjunction, Expression, Node
from rfm.geometry.logic import Integers, Logic
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface

ON_LINE = 1e-11
"""A surface passes through a point when it vanishes within this fraction of the shape's size."""
PARALLEL = 1e-7
"""Sine of the angle below which two lines have no corner."""


@dataclass(frozen=True)
class StraightCorner:
    """A corner between two lines, no other surface passing.

    Attributes
    ----------
    point
        Its coordinates.
    start
        Direction of the first edge, as an angle to the x axis.
    angle
        Interior angle omega.
    first, second
        Surfaces of the edges at theta = 0 and theta = omega.
    """

    point: tuple[float, float]
    start: float
    angle: float
    first: Surface
    second: Surface

    @property
    def reentrant(self) -> bool:
        """Whether the interior angle is above 180 degrees."""
        return self.angle > math.pi


def straight_corners(shape: Shape) -> tuple[StraightCorner, ...]:
    """Find the re-entrant corners of a plane shape between two lines.

    A shape without a union has none: an intersection of half-planes (and of anything else) is convex at the corners of
    its lines.

    Parameters
    ----------
    shape
        The shape; one in space has none.

    Returns
    -------
    tuple of StraightCorner
        In lexicographic order of their points.
    """
    lines = [i for i, surface in enumerate(shape.surfaces) if surface.degree == 1]
    if shape.dimension != 2 or len(lines) < 2 or not _has_union(shape.expression) or not shape.box.finite:
        return ()
    logic, size = Logic(shape.expression, shape.surfaces), max(shape.box.size)
    forms = _forms([shape.surfaces[i] for i in lines])
    points, pairs = _crossings(forms, shape, size)
    values = np.empty((len(points), len(shape.surfaces)))
    values[:, lines] = points @ forms[:, 1:].T + forms[:, 0]
    for i in set(range(len(shape.surfaces))) - set(lines):
        values[:, i] = partials(shape.surfaces[i].function, tuple(points.T), 0)[0]
    active = np.abs(values) <= ON_LINE * size
    signs = np.where(active, 0, np.sign(values)).astype(np.int8)
    rows = np.flatnonzero(active.sum(axis=1) == 2)
    inside = logic.table(signs[rows], np.array(lines)[pairs[rows]])
    found = []
    for row, sectors in zip(rows, inside, strict=True):
        if sectors.sum() == 3:
            sides = np.where(int(np.argmin(sectors)) >> np.arange(2) & 1, 1.0, -1.0)
            pair = pairs[row]
            found.append(
                _corner(
                    points[row], sides[:, None] * forms[pair, 1:], [shape.surfaces[lines[i]] for i in pair]
                )
            )
    return tuple(sorted(found, key=lambda corner: corner.point))


def landmarks(shape: Shape) -> Array:
    """Points (n, 2) of the boundary where two of its lines cross, in the box of a shape."""
    forms = _forms([surface for surface in shape.surfaces if surface.degree == 1])
    points, _ = _crossings(forms, shape, max(shape.box.size))
    return points[on_boundary(shape, points)]


def on_boundary(shape: Shape, points: Array) -> NDArray[np.bool_]:
    """Which of the points (n, 2), known to lie on surfaces, lie on the boundary."""
    values = np.broadcast_to(np.asarray(shape.sign(*points.T), dtype=float), len(points))
    return np.asarray(np.abs(values) <= 1e-10 * max(shape.box.size))


def _has_union(expression: Expression) -> bool:
    return isinstance(expression, Node) and (
        isinstance(expression, Disjunction) or any(_has_union(term) for term in expression.terms)
    )


def _forms(lines: list[Surface]) -> Array:
    """Signed distances to lines as affine forms (constant, slopes), shape (n, 3)."""
    origin = (np.zeros(1), np.zeros(1))
    forms = np.array([partials(line.function, origin, 1)[:, 0] for line in lines]).reshape(-1, 3)
    return np.asarray(forms / np.linalg.norm(forms[:, 1:], axis=1, keepdims=True))


def _crossings(forms: Array, shape: Shape, size: float) -> tuple[Array, Integers]:
    """Points (n, 2) in the box of a shape where two lines cross, and which (n, 2)."""
    pairs = np.stack(np.triu_indices(len(forms), 1), axis=1)
    (c, a, b), (f, d, e) = forms[pairs[:, 0]].T, forms[pairs[:, 1]].T
    sine = a * e - b * d
    with np.errstate(all="ignore"):
        points = np.stack([b * f - c * e, c * d - a * f], axis=1) / sine[:, None]
    margin = ON_LINE * size
    inside = (points >= np.array(shape.box.lower) - margin) & (points <= np.array(shape.box.upper) + margin)
    kept = inside.all(axis=1) & (np.abs(sine) > PARALLEL)
    return points[kept], pairs[kept]


def _corner(point: Array, normals: Array, lines: list[Surface]) -> StraightCorner:
    """The corner whose missing sector is where both `normals` (2, 2) of its lines point."""
    along = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    along *= np.sign(np.sum(along * normals[::-1], axis=1))[:, None]  # rays of the sector's border
    first = 1 if along[0, 0] * along[1, 1] > along[0, 1] * along[1, 0] else 0  # the one behind the sector
    gap = math.acos(float(np.clip(along[0] @ along[1], -1.0, 1.0)))
    return StraightCorner(
        (float(point[0]) + 0.0, float(point[1]) + 0.0),  # no -0
        float(np.arctan2(along[first, 1], along[first, 0])) % (2 * math.pi),
        2 * math.pi - gap,
        lines[first],
        lines[1 - first],
    )
