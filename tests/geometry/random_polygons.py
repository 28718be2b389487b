"""Random simple polygons, and tests of points that know nothing of half-planes."""

from __future__ import annotations

import numpy as np
from matplotlib.path import Path

from rfm.calculus.types import Array


def random_polygon(count: int, random: np.random.Generator) -> Array:
    """Simple polygon through random points by space partitioning (Auer, Held, 1996)."""
    points = random.uniform(0.0, 1.0, (count, 2))
    a, b = points[0], points[1]
    left = _cross(b - a, points[2:] - a) > 0.0
    upper = _chain(a, b, points[2:][left], random)
    return np.array([a, *upper, b, *_chain(b, a, points[2:][~left], random)])


def _chain(a: Array, b: Array, points: Array, random: np.random.Generator) -> list[Array]:
    """Points between a and b in an order that gives no crossing; all lie on one side of the line ab."""
    if len(points) == 0:
        return []
    pick = int(random.integers(len(points)))
    c, rest = points[pick], np.delete(points, pick, axis=0)
    through = a + random.uniform(0.0, 1.0) * (b - a) - c
    with_a = _cross(through, rest - c) * _cross(through, a - c) > 0.0
    return [*_chain(a, c, rest[with_a], random), c, *_chain(c, b, rest[~with_a], random)]


def with_flat_vertices(vertices: Array, shift: float, random: np.random.Generator) -> Array:
    """The polygon with one to three more vertices on every other edge, off it by about ``shift``."""
    result = []
    for index, (a, b) in enumerate(zip(vertices, np.roll(vertices, -1, axis=0), strict=True)):
        result.append(a)
        if index % 2 == 0:
            normal = np.array([a[1] - b[1], b[0] - a[0]])
            for share in np.sort(random.uniform(0.1, 0.9, int(random.integers(1, 4)))):
                result.append(a + share * (b - a) + shift * random.uniform(-1.0, 1.0) * normal)
    return np.array(result)


def distances(vertices: Array, points: Array) -> Array:
    """Distance of points to a closed polygon line."""
    nearest = np.full(len(points), np.inf)
    for a, b in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        nearest = np.minimum(nearest, np.linalg.norm(points - a - along[:, None] * (b - a), axis=1))
    return nearest


def trial_points(vertices: Array, random: np.random.Generator, count: int = 2000) -> Array:
    """Points in and around a polygon, many of them on the extensions of its edges."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    anywhere = random.uniform(low - 0.1 * (high - low), high + 0.1 * (high - low), (count, 2))
    pick = random.integers(len(vertices), size=count)
    chords = np.roll(vertices, -1, axis=0)[pick] - vertices[pick]
    reach = random.uniform(-2.0, 3.0, (count, 1))
    return np.concatenate([anywhere, vertices[pick] + reach * chords])


def inside(rings: list[Array], points: Array) -> Array:
    """Even-odd rule over rings, by matplotlib."""
    result = np.zeros(len(points), dtype=bool)
    for ring in rings:
        result ^= Path(ring).contains_points(points)
    return result


def _cross(first: Array, second: Array) -> Array:
    return np.asarray(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0])
