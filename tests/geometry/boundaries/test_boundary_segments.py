from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from boundary_checks import (
    check_intervals,
    check_jets,
    check_ratio,
    check_slope,
    check_slope_on,
    check_zero,
    cloud,
    distance_to_segments,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rfm.calculus import partials
from rfm.errors import GeometryError
from rfm.geometry.boundaries import bezier, polyline, segment

ZIGZAG = np.array([[0.0, 0.0], [2.0, 0.5], [1.5, 1.5], [3.0, 1.0]])
SPACE = np.array([[0.0, 0.0, 0.0], [2.0, 0.5, 1.0], [1.5, 1.5, -1.0]])


def along(path: np.ndarray, count: int = 15) -> np.ndarray:
    """Points of the open segments."""
    s = (np.arange(count) + 0.5) / count
    return np.concatenate([a + np.outer(s, b - a) for a, b in pairwise(path)])


def normals(path: np.ndarray, count: int = 15) -> np.ndarray:
    chords = np.diff(path, axis=0)
    flat = path.shape[1] == 2
    across = chords[:, ::-1] * [-1.0, 1.0] if flat else np.cross(chords, [0.3, -0.2, 0.9])
    return np.repeat(across / np.linalg.norm(across, axis=1)[:, None], count, axis=0)


@pytest.mark.parametrize("path", [ZIGZAG[:2], ZIGZAG, SPACE[:2], SPACE])
def test_zero_on_it_unit_slope_across_it(path):
    w = polyline(path)
    check_zero(w, np.concatenate([along(path), path]))
    check_slope(w, along(path), normals(path))
    points = cloud(path.mean(axis=0), 1.0)
    check_ratio(w, distance_to_segments(path), points, 0.4, 1.42)
    check_jets(w, points[:50])
    check_intervals(w, cloud(path.mean(axis=0), 1.0, 200), 0.05, least=0.5)


def test_one_segment_is_nearly_the_distance():
    points = cloud(ZIGZAG[:2].mean(axis=0), 1.0)
    check_ratio(segment(*ZIGZAG[:2]), distance_to_segments(ZIGZAG[:2]), points, 0.7, 1.42)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_homogeneous_of_degree_one(scale):
    points = cloud(ZIGZAG.mean(axis=0), 1.0)
    expected = scale * polyline(ZIGZAG)(*points.T)
    np.testing.assert_allclose(polyline(scale * ZIGZAG)(*(scale * points).T), expected, rtol=1e-9)


@pytest.mark.parametrize("p", [1, 2, 3, 4])
def test_joint_keeps_the_normalisation_to_order_p(p):
    """The deviation from the distance is of order p + 1 in it: that of one segment is of order 7."""
    path = ZIGZAG[:3]
    w, point, normal = polyline(path, p=p), along(path, 1)[0], normals(path, 1)[0]
    steps = 0.08 / 2.0 ** np.arange(3)
    deviation = steps - w(*(point + steps[:, None] * normal).T)
    rates = np.log2(deviation[:-1] / deviation[1:])
    np.testing.assert_allclose(rates, p + 1, atol=0.15)


def test_derivatives_exist_on_the_piece_itself():
    """There they are those of one side: unit normal slope, and no curvature on a line."""
    check_slope_on(polyline(ZIGZAG), along(ZIGZAG), normals(ZIGZAG))
    assert np.abs(partials(polyline(ZIGZAG), tuple(along(ZIGZAG).T), 2)[3:]).max() < 1e-12


def test_growth_at_an_end_is_that_of_the_distance():
    """w/d tends to one at the end of a lone segment, from every direction."""
    end, angle = np.array([2.0, 0.5]), np.linspace(0, 2 * np.pi, 37)
    for radius, tolerance in ((1e-2, 2e-2), (1e-4, 2e-4)):
        points = end + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        distance = distance_to_segments(ZIGZAG[:2])(points)
        away = distance > 1e-3 * radius
        np.testing.assert_allclose(
            segment(*ZIGZAG[:2])(*points[away].T) / distance[away], 1.0, atol=tolerance
        )


def test_any_shape_of_points():
    w = polyline(ZIGZAG)
    x, y = np.meshgrid(np.linspace(-1, 1, 120), np.linspace(0, 1, 130))
    values = w(x, y)
    assert values.shape == x.shape
    assert values[7, 9] == pytest.approx(float(w(x[7, 9], y[7, 9])), rel=1e-14)
    np.testing.assert_allclose(w(x, 0.3), w(x, np.full_like(x, 0.3)), rtol=1e-14)


def test_jax_arrays():
    import jax

    w = polyline(ZIGZAG) | bezier([(0, 0), (0, 2), (2, 2), (2, 0)])
    x, y = np.linspace(-0.3, 1.3, 7), np.linspace(0.2, 0.9, 7)
    values = jax.jit(w)(jax.numpy.asarray(x), jax.numpy.asarray(y))
    np.testing.assert_allclose(values, w(x, y), rtol=1e-5)


@settings(max_examples=40)
@given(
    st.integers(2, 3).flatmap(
        lambda d: arrays(
            np.float64, st.tuples(st.integers(2, 9), st.just(d)), elements=st.floats(-5, 5, width=16)
        )
    )
)
def test_random_polylines(path):
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    if lengths.min() <= 1e-3:
        return
    w, count = polyline(path), len(path) - 1
    s = np.array([0.0, 0.2, 0.5, 0.9, 1.0])
    on = np.concatenate([a + np.outer(s, b - a) for a, b in pairwise(path)])
    assert np.abs(w(*on.T)).max() < 1e-13
    points = np.random.default_rng(0).uniform(-8, 8, (100, path.shape[1]))
    # joined, n equal distances d give d n^(-1/2)
    check_ratio(w, distance_to_segments(path), points, 0.4 / np.sqrt(count), 1.42)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0], [1, 0], [1, 0]], r"segment 1 has length zero: points 1 and 2 are the same point \[1, 0\]"),
        ([[0, 0, 1], [0, 0, 1]], r"segment 0 has length zero: points 0 and 1 are the same point \[0, 0, 1\]"),
        ([[0, 0]], "a polyline needs at least 2 points, got 1"),
        ([[0, 0], [1, np.nan]], r"point 1 of a polyline must be finite, got \[1, nan\]"),
        ([[0, 0], [1]], "the points of a polyline must be a list of pairs or triples of numbers"),
        ([0, 1], "the points of a polyline must be a list of pairs or triples of numbers"),
    ],
)
def test_bad_points(points, message):
    with pytest.raises(GeometryError, match=f"^{message}$"):
        polyline(points)


def test_bad_closed_polyline():
    with pytest.raises(GeometryError, match=r"^a polyline needs at least 3 points, got 2$"):
        polyline([[0, 0], [1, 0]], closed=True)
    with pytest.raises(GeometryError, match=r"^segment 2 has length zero: points 2 and 0 are the same point"):
        polyline([[0, 0], [1, 0], [0, 0]], closed=True)


@pytest.mark.parametrize("p", [0, 1.5, -2])
def test_bad_order(p):
    message = f"^p of the R-equivalence must be a whole number from 1 on, got {p:g}$"
    with pytest.raises(GeometryError, match=message):
        polyline(ZIGZAG, p=p)
