"""Simplices split along the zero sets of surface functions, conformingly and with sharp corners.

A simplex whose vertices lie on both sides of a surface is bisected at the root on one of its crossing
edges, again and again until no edge crosses.  Every simplex takes its crossing edges in the order of
their global vertex numbers; two neighbours therefore split their common face in the same way.  A new
point remembers all surfaces it lies on: the one it was made for, and those common to the ends of its
edge.  So a corner is found where the polyline of one surface meets the next surface.

Notation: n points, m simplices, s surfaces, d dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array

if TYPE_CHECKING:
    from rfm.geometry.surface import Surface

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Signs = NDArray[np.int8]

SNAP = 0.02
"""A point nearer to a surface than this part of a subcell is taken to lie on it: avoids needles."""


@dataclass(frozen=True)
class Points:
    """Points with what the surfaces say about them.

    Attributes
    ----------
    x
        Coordinates (n, d).
    values
        Surface functions (n, s), exactly zero where `on`.
    on
        Whether a point lies on a surface (n, s).
    scale
        Local range of the surface functions over a subcell (n, s), the measure of "near".
    """

    x: Array
    values: Array
    on: Flags
    scale: Array

    def extended(self, more: Points) -> Points:
        """These points followed by `more`."""
        pairs = ((getattr(self, name), getattr(more, name)) for name in ("x", "values", "on", "scale"))
        return Points(*(np.concatenate(pair) for pair in pairs))


def surface_values(surfaces: Sequence[Surface], x: Array) -> Array:
    """Functions of the `surfaces` at points x (n, d), shape (n, s); where undefined: outside."""
    values = np.empty((len(x), len(surfaces)))
    coords = tuple(np.ascontiguousarray(x.T))
    with np.errstate(all="ignore"):
        for column, surface in enumerate(surfaces):
            values[:, column] = surface.function(*coords)
    values[np.isnan(values)] = -1.0
    return values


def snapped(x: Array, values: Array, scale: Array, on: Flags | None = None) -> Points:
    """Points that lie on every surface to which they are near (and on those given by `on`)."""
    near = np.abs(values) <= SNAP * scale
    on = near if on is None else near | on
    return Points(x, np.where(on, 0.0, values), on, scale)


def simplex_signs(points: Points, simplices: Ints, surfaces: Sequence[Surface]) -> Signs:
    """Side of every simplex with respect to every surface (m, s): 1, -1, or 0 where it is cut."""
    values = points.values[simplices]
    low, high = values.min(axis=1), values.max(axis=1)
    signs: Signs = (high > 0).astype(np.int8) - (low < 0).astype(np.int8)
    flat = np.flatnonzero(((low == 0) & (high == 0)).any(axis=1))
    if len(flat):  # all vertices on one surface: its middle decides
        middle = points.x[simplices[flat]].mean(axis=1)
        signs[flat] = np.where(signs[flat] == 0, _definite(surface_values(surfaces, middle)), signs[flat])
    return signs


def _definite(values: Array) -> Signs:
    return np.asarray(np.where(values > 0, 1, -1), dtype=np.int8)


def state(expression: Any, surfaces: Sequence[Surface], signs: Signs) -> Signs:
    """Tri-state of the Boolean `expression` for rows of surface signs (m, s)."""
    found = expression.evaluate({surface: signs[:, column] for column, surface in enumerate(surfaces)})
    return np.broadcast_to(np.asarray(found, dtype=np.int8), (len(signs),))


def split_all(
    points: Points, simplices: Ints, surfaces: Sequence[Surface], expression: Any
) -> tuple[Points, Ints, Signs]:
    """Split the undecided simplices by every surface in turn and keep those inside.

    Returns
    -------
    points, simplices, signs
        All points (some unused), the simplices inside, and their sides (m, s).
    """
    signs = simplex_signs(points, simplices, surfaces)
    inside = state(expression, surfaces, signs)
    for column, surface in enumerate(surfaces):
        keep = inside >= 0
        simplices, signs, inside = simplices[keep], signs[keep], inside[keep]
        cut = (signs[:, column] == 0) & (inside == 0)
        if not cut.any():
            continue
        points, pieces = _split(points, simplices[cut], column, surface, surfaces)
        new_signs = simplex_signs(points, pieces, surfaces)
        simplices = np.concatenate([simplices[~cut], pieces])
        signs = np.concatenate([signs[~cut], new_signs])
        inside = np.concatenate([inside[~cut], state(expression, surfaces, new_signs)])
    keep = inside > 0
    return points, simplices[keep], signs[keep]


def _split(
    points: Points, simplices: Ints, column: int, surface: Surface, surfaces: Sequence[Surface]
) -> tuple[Points, Ints]:
    """Split `simplices` along one surface: none of the pieces has vertices on both of its sides."""
    count = len(points.x)
    pairs = np.array(list(combinations(range(simplices.shape[1]), 2)))
    keys = np.unique(_crossing_keys(points.values[:, column], simplices, pairs))
    keys = keys[keys < count * count]
    roots = _roots(points, keys // count, keys % count, column, surface, surfaces)
    points = points.extended(roots)
    values = points.values[:, column]
    done: list[Ints] = []
    while len(simplices):
        edges = _crossing_keys(values[:count], simplices, pairs, count)
        first = edges.argmin(axis=1)
        key = edges[np.arange(len(edges)), first]
        crossing = key < count * count
        done.append(simplices[~crossing])
        simplices, first, key = simplices[crossing], first[crossing], key[crossing]
        rows, new = np.arange(len(simplices)), count + np.searchsorted(keys, key)
        halves = [simplices.copy(), simplices.copy()]
        for half, end in zip(halves, pairs[first].T, strict=True):
            half[rows, end] = new
        simplices = np.concatenate(halves)
    return points, np.concatenate(done)


def _crossing_keys(values: Array, simplices: Ints, pairs: Ints, count: int | None = None) -> Ints:
    """Key ``smaller * n + larger`` of the edges (m, pairs) that cross, n * n for all others."""
    count = len(values) if count is None else count
    a, b = simplices[:, pairs[:, 0]], simplices[:, pairs[:, 1]]
    # points made for this surface have numbers from `count` on and lie on it: their edges do not cross
    old = np.maximum(a, b) < count
    crossing = old & (values[np.minimum(a, count - 1)] * values[np.minimum(b, count - 1)] < 0)
    return np.where(crossing, np.minimum(a, b) * count + np.maximum(a, b), count * count)


def _roots(
    points: Points, a: Ints, b: Ints, column: int, surface: Surface, surfaces: Sequence[Surface]
) -> Points:
    """Points of one surface on the edges from a to b: two steps of regula falsi."""
    start, step = points.x[a], points.x[b] - points.x[a]
    left, right = np.zeros(len(a)), np.ones(len(a))
    value_left, value_right = points.values[a, column], points.values[b, column]
    t = value_left / (value_left - value_right)
    x = start + t[:, None] * step
    values = surface_values([surface], x)[:, 0]
    on_left = values * value_left > 0
    left, value_left = np.where(on_left, t, left), np.where(on_left, values, value_left)
    right, value_right = np.where(on_left, right, t), np.where(on_left, value_right, values)
    slope = value_left - value_right
    t = left + (right - left) * value_left / np.where(slope == 0, 1, slope)
    x = start + t[:, None] * step
    on = points.on[a] & points.on[b]
    on[:, column] = True
    return snapped(x, surface_values(surfaces, x), np.maximum(points.scale[a], points.scale[b]), on)
