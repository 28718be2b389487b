"""Support functions: how far a set reaches in given directions.

``h(n) = sup {n . x : x in the set}``.  Kept instead of a bounding box because it stays tight under
rotations: the box of a rotated torus is read off at the coordinate directions.  Intersection and
union become minimum and maximum (a bound for the former, exact for the latter).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.box import Box
from rfm.geometry.similarity import Similarity

Support = Callable[[Array], Array]
"""Maps unit directions ``(k, d)`` to the reach ``(k,)``, possibly infinite."""

_PARALLEL = 1e-14


def everything(directions: Array) -> Array:
    """Reach of the whole space."""
    return np.full(len(directions), np.inf)


def points(vertices: Array) -> Support:
    """Reach of the convex hull of points ``(m, d)``."""
    return lambda directions: (directions @ vertices.T).max(axis=1)


def aligned(box: Box) -> Support:
    """Reach of an axis-parallel box, possibly infinite."""

    def reach(directions: Array) -> Array:
        bounds = np.where(directions > 0.0, box.upper, box.lower)
        # a bound in a direction that does not occur must not become 0 * inf
        terms = np.where(np.abs(directions) > _PARALLEL, directions * np.nan_to_num(bounds), 0.0)
        unbounded = np.isinf(bounds) & (np.abs(directions) > _PARALLEL)
        return np.asarray(np.where(unbounded.any(axis=1), np.inf, terms.sum(axis=1)))

    return reach


def half_space(point: Array, normal: Array) -> Support:
    """Reach of ``normal . (x - point) > 0``."""

    def reach(directions: Array) -> Array:
        opposite = np.linalg.norm(directions + normal, axis=1) < _PARALLEL
        return np.where(opposite, directions @ point, np.inf)

    return reach


def ellipsoid(center: Array, half_axes: Array) -> Support:
    """Reach of an ellipsoid; ``half_axes`` (d, d) has the half axes as rows."""
    return lambda directions: directions @ center + np.linalg.norm(directions @ half_axes.T, axis=1)


def disk_across(center: Array, axis: Array, radius: float) -> Support:
    """Reach of a flat disk in space, perpendicular to the unit vector ``axis``."""

    def reach(directions: Array) -> Array:
        return np.asarray(directions @ center + radius * _across(directions, axis))

    return reach


def ball(center: Array, radius: float) -> Support:
    """Reach of a ball."""
    return lambda directions: directions @ center + radius * np.linalg.norm(directions, axis=1)


def line(point: Array, direction: Array) -> Support:
    """Reach of a whole line; zero only across it."""

    def reach(directions: Array) -> Array:
        along = np.abs(directions @ direction) > _PARALLEL
        return np.where(along, np.inf, directions @ point)

    return reach


def minkowski_sum(*supports: Support) -> Support:
    """Reach of the sum of sets."""
    return lambda directions: np.sum([support(directions) for support in supports], axis=0)


def common(*supports: Support) -> Support:
    """Bound of the reach of an intersection."""
    return lambda directions: np.min([support(directions) for support in supports], axis=0)


def either(*supports: Support) -> Support:
    """Reach of a union."""
    return lambda directions: np.max([support(directions) for support in supports], axis=0)


def transformed(support: Support, similarity: Similarity) -> Support:
    """Reach of the image under a similarity."""

    def reach(directions: Array) -> Array:
        turned = directions @ similarity.matrix
        return np.asarray(similarity.scale * support(turned) + directions @ similarity.shift)

    return reach


def bounding_box(support: Support, dimension: int) -> Box:
    """Box of a set from its reach along the axes."""
    axes = np.eye(dimension)
    reach: list[float] = support(np.concatenate([-axes, axes])).tolist()
    return Box(tuple(-x for x in reach[:dimension]), tuple(reach[dimension:]))


def _across(directions: Array, axis: Array) -> Array:
    """Length of the component perpendicular to ``axis``, exact for directions along it."""
    return np.asarray(np.linalg.norm(directions - np.outer(directions @ axis, axis), axis=1))
