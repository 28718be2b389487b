"""What every function of a piece of boundary must be, given points of the piece and its distance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rfm.calculus import Interval, partials, variables
from rfm.calculus.types import Array, Field

Distance = Callable[[Array], Array]


def distance_to_segments(path: Array, closed: bool = False) -> Distance:
    corners = np.asarray(path, dtype=float)
    ends = np.roll(corners, -1, axis=0)
    if not closed:
        corners, ends = corners[:-1], ends[:-1]

    def distance(points: Array) -> Array:
        chords = ends - corners
        rays = points[:, None] - corners
        share = np.clip((rays * chords).sum(axis=2) / (chords**2).sum(axis=1), 0.0, 1.0)
        return np.linalg.norm(rays - share[..., None] * chords, axis=2).min(axis=1)

    return distance


def cloud(center: Array, size: float, count: int = 2000, seed: int = 0) -> Array:
    """Points at distances from a hundredth of to a thousand times the size."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, len(center)))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return center + size * directions * 10.0 ** rng.uniform(-2, 3, (count, 1))


def check_zero(w: Field, points: Array, tolerance: float = 2e-15) -> None:
    assert np.abs(w(*points.T)).max() <= tolerance


def check_ratio(w: Field, distance: Distance, points: Array, low: float, high: float) -> None:
    """Positive everywhere else, within a bounded ratio of the distance."""
    exact = distance(points)
    points, exact = points[exact > 0.0], exact[exact > 0.0]
    ratio = w(*points.T) / exact
    assert ratio.min() >= low, ratio.min()
    assert ratio.max() <= high, ratio.max()


def check_slope(w: Field, points: Array, normals: Array, step: float = 1e-5) -> None:
    """Unit slope along the normals on both sides of regular points, by jets at a small distance."""
    for sign in (1.0, -1.0):
        slopes = partials(w, tuple((points + sign * step * normals).T), 1)[1:]
        np.testing.assert_allclose(slopes.T, sign * normals, atol=2e-4)


def check_jets(w: Field, points: Array) -> None:
    """Jets agree with difference quotients of the values and of the slopes."""
    step = 1e-6
    jet = partials(w, tuple(points.T), 1)
    for i, axis in enumerate(np.eye(points.shape[1])):
        ahead, behind = w(*(points + step * axis).T), w(*(points - step * axis).T)
        np.testing.assert_allclose(jet[1 + i], (ahead - behind) / (2 * step), rtol=1e-5, atol=1e-5)


def check_intervals(w: Field, points: Array, width: float, least: float = 0.0) -> None:
    """Bounds over boxes contain the values; also inside jets.  At least a share of the lower bounds is positive."""
    rng = np.random.default_rng(1)
    boxes = [Interval(x - width, x + width) for x in points.T]
    bounds = w(*boxes)
    slopes = w(*variables(boxes, 1))
    for _ in range(8):
        inside = points + width * rng.uniform(-1, 1, points.shape)
        jet = partials(w, tuple(inside.T), 1)
        assert np.all(bounds.contains(jet[0]))
        assert np.all(slopes.value.contains(jet[0]))
        for row, coefficient in zip(jet[1:], slopes.coefficients[1:], strict=True):
            assert np.all(Interval.of(coefficient).contains(row))
    assert np.mean(bounds.lo > 0.0) >= least


def check_slope_on(w: Field, points: Array, normals: Array, tolerance: float = 1e-13) -> None:
    """On the piece itself jets are those of one side (which one is up to rounding)."""
    slopes = partials(w, tuple(points.T), 1)[1:].T
    sign = np.sign((slopes * normals).sum(axis=1))[:, None]
    np.testing.assert_allclose(sign * slopes, normals, atol=tolerance)
