r"""Corners between two straight pieces of boundary, in closed form.

The common zero of two lines is known without a search, so this costs a fraction of a millisecond where
:func:`rfm.geometry.singular.corners.corners`, which finds all corners of any shape, needs ten.

Notation: at a corner with interior angle omega polar coordinates are counted so that :math:`\theta = 0` on the *first*
edge, :math:`\theta = \omega` on the *second*, and the domain lies at :math:`0 < \theta < \omega`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import partials
from rfm.calculus.types import Array
from rfm.geometry.expression import Disjunction, Expression, Node
from rfm.geometry.logic import Logic, Signs
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
    logic = Logic(shape.expression, shape.surfaces)
    size = max(shape.box.size)
    points, pairs = _crossings([shape.surfaces[i] for i in lines], shape, size)
    if not len(points):
        return ()
    values = np.stack([partials(s.function, tuple(points.T), 0)[0] for s in shape.surfaces], axis=1)
    active = np.abs(values) <= ON_LINE * size
    signs = np.where(active, 0, np.sign(values)).astype(np.int8)
    on_boundary = np.flatnonzero((logic.value(signs) == 0) & (active.sum(axis=1) == 2))
    found = (_corner(logic, signs[k], points[k], [lines[i] for i in pairs[k]]) for k in on_boundary)
    return tuple(sorted((c for c in found if c is not None), key=lambda c: c.point))


def landmarks(shape: Shape) -> Array:
    """Points (n, 2) of the boundary where two of its lines cross, in the box of a shape."""
    lines = [surface for surface in shape.surfaces if surface.degree == 1]
    points, _ = _crossings(lines, shape, max(shape.box.size))
    return points[on_boundary(shape, points)]


def on_boundary(shape: Shape, points: Array) -> NDArray[np.bool_]:
    """Which of the points (n, 2), known to lie on surfaces, lie on the boundary."""
    values = np.broadcast_to(np.asarray(shape.sign(*points.T), dtype=float), len(points))
    return np.asarray(np.abs(values) <= 1e-10 * max(shape.box.size))


def _has_union(expression: Expression) -> bool:
    return isinstance(expression, Node) and (
        isinstance(expression, Disjunction) or any(_has_union(term) for term in expression.terms)
    )


def _crossings(lines: list[Surface], shape: Shape, size: float) -> tuple[Array, list[tuple[int, int]]]:
    """Points (n, 2) in the box of the shape where two lines cross, and which."""
    jets = np.stack([partials(line.function, (np.zeros(1), np.zeros(1)), 1)[:, 0] for line in lines])
    jets = jets / np.linalg.norm(jets[:, 1:], axis=1, keepdims=True)
    lower, upper = np.array(shape.box.lower), np.array(shape.box.upper)
    points, pairs = [], []
    for i, j in combinations(range(len(lines)), 2):
        (c, a, b), (f, d, e) = jets[i], jets[j]
        sine = a * e - b * d
        if abs(sine) < PARALLEL:
            continue
        point = np.array([b * f - c * e, c * d - a * f]) / sine
        if (point >= lower - ON_LINE * size).all() and (point <= upper + ON_LINE * size).all():
            points.append(point)
            pairs.append((i, j))
    return np.array(points).reshape(-1, 2), pairs


def _corner(logic: Logic, signs: Signs, point: Array, pair: list[int]) -> StraightCorner | None:
    """The re-entrant corner at a point where two lines cross; None where three of the four sectors do not belong."""
    gradients = np.stack([partials(logic.surfaces[i].function, tuple(point), 1)[1:] for i in pair])
    along = np.arctan2(-gradients[:, 0], gradients[:, 1])
    rays = np.concatenate([along, along + np.pi]) % (2 * np.pi)
    owners = np.array([*pair, *pair])
    order = np.argsort(rays)
    rays, owners = rays[order], owners[order]
    widths = np.diff(np.append(rays, rays[0] + 2 * np.pi))
    middles = rays + 0.5 * widths
    trial = np.repeat(signs[None, :], 4, axis=0)
    trial[:, pair] = np.where(np.stack([np.cos(middles), np.sin(middles)], axis=1) @ gradients.T > 0, 1, -1)
    outside = np.flatnonzero(logic.value(trial) <= 0)
    if len(outside) != 1:
        return None
    gap = int(outside[0])
    after = (gap + 1) % 4
    return StraightCorner(
        (float(point[0]) + 0.0, float(point[1]) + 0.0),  # no -0
        float(rays[after]),
        float(2 * np.pi - widths[gap]),
        logic.surfaces[owners[after]],
        logic.surfaces[owners[gap]],
    )
