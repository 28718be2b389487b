"""Points on the boundary of a shape, found without the code under test's quadrature."""

from __future__ import annotations

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface


def sample_box(shape: Shape, count: int, seed: int = 0, margin: float = 0.0) -> Array:
    box = shape.box.padded(margin)
    return np.random.default_rng(seed).uniform(box.lower, box.upper, (count, shape.dimension))


def inside_points(shape: Shape, count: int = 5000, seed: int = 0) -> Array:
    points = sample_box(shape, count, seed)
    return points[shape.contains(points)]


def boundary_points(shape: Shape, surface: Surface, count: int = 1500, seed: int = 0) -> tuple[Array, Array]:
    """Points of the carrier where stepping across changes membership, with inward unit normals."""
    points = sample_box(shape, count, seed)
    with np.errstate(all="ignore"):
        for _ in range(60):
            jet = partials(surface.function, tuple(points.T), 1)
            points = points - 0.9 * (jet[0] / (jet[1:] ** 2).sum(axis=0) * jet[1:]).T
    points = points[np.isfinite(points).all(axis=1)]
    jet = partials(surface.function, tuple(points.T), 1)
    length = np.linalg.norm(jet[1:], axis=0)
    good = (np.abs(jet[0]) < 1e-13) & (length > 1e-3)
    points, normals = points[good], (jet[1:] / length).T[good]
    step = 1e-4 * normals
    forward, backward = shape.contains(points + step), shape.contains(points - step)
    crossing = forward != backward
    # too close to another surface, the steps may end beyond a corner
    others = [np.abs(other.function(*points.T)) for other in shape.surfaces if other is not surface]
    crossing &= np.min(others, axis=0, initial=np.inf) > 3e-4
    sign = np.where(forward, 1.0, -1.0)[:, None]
    return points[crossing], (sign * normals)[crossing]
