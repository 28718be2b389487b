"""Following the common zeros of two surfaces in space, predictor and corrector.

Notation: x a point on the curve, t the unit tangent grad f x grad g there, h the step; a polygon with pieces of length
h that turns by the angle d between its ends leaves the curve by about h d / 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from rfm.geometry.gauss_newton import iterated
from rfm.geometry.logic import Logic, Mask
from rfm.geometry.singular.creases import crease

MOST_STEPS = 20_000
BEYOND = 1e-6
"""How far behind a vertex, relative to the size, the edge is looked for."""
SHORTEST = 1e-9
"""Steps below this length, relative to the size, end a path."""


@dataclass(frozen=True, eq=False)
class Path:
    """The curve on which two surfaces vanish.

    Attributes
    ----------
    logic
        Expression and surfaces of the shape.
    first, second
        Numbers of the two surfaces.
    ends
        Points of the curve where other surfaces pass, shape (n, 3).
    size
        Length scale.
    accuracy
        Distance of the polygon from the curve, relative to the size.
    """

    logic: Logic
    first: int
    second: int
    ends: Array
    size: float
    accuracy: float

    @cached_property
    def fields(self) -> tuple[Field, Field]:
        """The two functions."""
        return self.logic.surfaces[self.first].function, self.logic.surfaces[self.second].function

    @property
    def tolerance(self) -> float:
        """Distance of the polygon from the curve."""
        return self.accuracy * self.size

    def sharp(self, points: Array) -> Mask:
        """Whether the final boundary has an edge at points (n, 3) of the curve."""
        return crease(self.logic, self.first, self.second, points).sharp

    def corrected(self, points: Array) -> Array:
        """Points of the curve next to points (n, 3); those without one stay where they are."""
        found, converged = iterated(self.fields, points, self.size)
        return np.where(converged[:, None], found, points)

    def tangent(self, point: Array) -> Array:
        """Unit tangent (3,); zero where the gradients are parallel."""
        f, g = (partials(field, tuple(point), 1)[1:] for field in self.fields)
        t = np.cross(f, g)
        scale = float(np.linalg.norm(f) * np.linalg.norm(g))
        length = float(np.linalg.norm(t))
        return t / length if length > 1e-7 * scale > 0 else np.zeros(3)


def trace(path: Path, start: Array, step: float) -> tuple[Array, bool]:
    """Follow the curve from a point both ways.

    Returns
    -------
    tuple
        Points in order, shape (n, 3), and whether they close.
    """
    forward, closed = _one_way(path, start, path.tangent(start), step)
    if closed:
        return np.array([start, *forward]), True
    backward, _ = _one_way(path, start, -path.tangent(start), step)
    return np.array([*reversed(backward), start, *forward]), False


def distance_to(polygon: Array, points: Array) -> Array:
    """Distances of points (n, 3) from the polygon with the vertices (m, 3), shape (n,)."""
    start, piece = polygon[:-1], np.diff(polygon, axis=0)
    offset = points[:, None] - start
    share = (offset * piece).sum(axis=2) / np.maximum((piece * piece).sum(axis=1), 1e-300)
    away = offset - np.clip(share, 0.0, 1.0)[..., None] * piece
    return np.asarray(np.linalg.norm(away, axis=2).min(axis=1, initial=np.inf))


def _one_way(path: Path, start: Array, direction: Array, step: float) -> tuple[list[Array], bool]:
    """Points after the start in one direction, and whether the start was reached again."""
    x, t, h, found = start, direction, step, list[Array]()
    for _ in range(MOST_STEPS):
        if not t.any() or h < SHORTEST * path.size:
            break
        at_vertex = _ahead(path.ends, x, t, h)
        if len(found) > 1 and _passes(start, x, t, h):
            return [*found, start], True
        target = x + h * t if at_vertex is None else at_vertex
        new = path.corrected(target[None])[0]
        turned = path.tangent(new)
        turned = -turned if turned @ t < 0 else turned
        if not turned.any():  # across a point where the gradients are parallel
            turned = t
        if at_vertex is None and not _acceptable(path, x, new, t, turned, h):
            h *= 0.5
            continue
        if at_vertex is not None:
            found.append(at_vertex)
            behind = path.corrected((at_vertex + BEYOND * path.size * turned)[None])
            if not path.sharp(behind)[0]:
                break
            x, t = behind[0], turned
            continue
        if not path.sharp(new[None])[0]:  # the box ends, or a vertex that nobody knows
            h *= 0.5
            continue
        found.append(new)
        bend = float(np.arccos(np.clip(t @ turned, -1.0, 1.0)))
        x, t = new, turned
        h = min(1.5 * h, 0.125 * path.size) if h * bend < 2.0 * path.tolerance else h
    return found, False


def _acceptable(path: Path, x: Array, new: Array, t: Array, turned: Array, h: float) -> bool:
    """Whether a step kept its direction and stays close to the curve."""
    moved = float(np.linalg.norm(new - x))
    bend = float(np.arccos(np.clip(t @ turned, -1.0, 1.0)))
    return 0.5 * h < moved < 2.0 * h and bend < 0.5 and h * bend < 8.0 * path.tolerance


def _ahead(points: Array, x: Array, t: Array, h: float) -> Array | None:
    """The nearest of the points that the step from x along t passes."""
    if not len(points):
        return None
    forward = (points - x) @ t
    aside = np.linalg.norm(points - x - forward[:, None] * t, axis=1)
    passed = np.flatnonzero((forward > 1e-9) & (forward <= h) & (aside < 0.3 * forward + 1e-12))
    if not passed.size:
        return None
    nearest: Array = points[passed[np.argmin(forward[passed])]]
    return nearest


def _passes(point: Array, x: Array, t: Array, h: float) -> bool:
    """Whether the step from x along t passes a point."""
    return _ahead(point[None], x, t, h) is not None
