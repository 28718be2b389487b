from __future__ import annotations

import math

import numpy as np
import pytest
from boundary_checks import check_jets
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.path import Path

from rfm.calculus import Interval, partials
from rfm.errors import GeometryError
from rfm.geometry.boundaries import arc, arc_about, circle, polyline, segment, signed
from rfm.geometry.boundaries.winding import closed, winding_number

DENT = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.4], [0.0, 1.0]])


def grid(lower, upper, count=60):
    axes = [np.linspace(a, b, count) for a, b in zip(lower, upper, strict=True)]
    return np.array(np.meshgrid(*axes)).reshape(2, -1)


@pytest.mark.parametrize("vertices", [DENT, DENT[::-1]])
def test_sign_and_slope_of_a_polygon(vertices):
    """Either orientation: positive inside, unit inward slope on the edges themselves, nothing of second order."""
    w = signed(polyline(vertices, closed=True))
    points = grid((-0.5, -0.5), (2.5, 1.5), 97)
    values = w(*points)
    off = np.abs(values) > 1e-14  # matplotlib has no rule for points on the path
    np.testing.assert_array_equal(values[off] > 0.0, Path(vertices).contains_points(points.T[off]))
    s = (np.arange(20) + 0.5) / 20
    following = np.roll(vertices, -1, axis=0)
    edges = np.concatenate([a + np.outer(s, b - a) for a, b in zip(vertices, following, strict=True)])
    jet = partials(w, tuple(edges.T), 2)
    assert np.abs(jet[0]).max() < 1e-15
    np.testing.assert_allclose(np.hypot(*jet[1:3]), 1.0, atol=1e-14)
    assert np.abs(jet[3:]).max() < 1e-11
    step = 1e-4 * jet[1:3].T
    assert np.all(w(*(edges + step).T) > 0.0)
    assert np.all(w(*(edges - step).T) < 0.0)


def test_slope_does_not_flip_by_rounding():
    """Points a few units of rounding off the boundary: the slope stays the inward one."""
    w = signed(polyline(DENT / 3.0, closed=True))
    s = np.linspace(0.05, 0.95, 200)
    points = (
        DENT[1] / 3.0
        + np.outer(s, (DENT[2] - DENT[1]) / 3.0)
        + 1e-16 * np.random.default_rng(0).normal(size=(200, 2))
    )
    slopes = partials(w, tuple(points.T), 1)[1:]
    np.testing.assert_allclose(slopes.T, [[-1.0, 0.0]] * 200, atol=1e-12)


def test_vertices_of_a_grid_on_a_polygon():
    """Winding numbers stay right where points share coordinates with vertices or lie on the lines of edges."""
    vertices = np.array([[0, 0], [2, 0], [2, 2], [3, 2], [3, 3], [1, 3], [1, 1], [0, 1]], dtype=float)
    batches = closed(polyline(vertices, closed=True).batches)
    points = grid((-1, -1), (4, 4), 21)
    on = np.abs(polyline(vertices, closed=True)(*points)) < 1e-14
    number = winding_number(batches, *points)
    assert on.sum() > 20
    inside = Path(vertices).contains_points(points.T, radius=1e-9) & ~on
    np.testing.assert_array_equal(number[~on], inside[~on].astype(float))


def test_lens_between_arc_and_chord():
    x = np.random.default_rng(0).uniform(-1.5, 1.5, (2, 5000))
    disk, first = np.hypot(*x) < 1.0, (x[0] > 0) & (x[1] > 0)
    corner = polyline([[0, 1], [0, 0], [1, 0]])
    quarter = signed(arc_about((0, 0), (1, 0), (0, 1)) | corner)
    np.testing.assert_array_equal(quarter(*x) > 0.0, disk & first)
    rest = signed(arc_about((0, 0), (1, 0), (0, 1), clockwise=True) | corner)
    np.testing.assert_array_equal(rest(*x) > 0.0, disk & ~first)


def test_holes_run_the_other_way():
    x = np.random.default_rng(0).uniform(-1.5, 1.5, (2, 5000))
    r = np.hypot(*x)
    ring = signed(circle((0, 0), 1.0) | arc((0, 0), 0.5, 0.0, -2.0 * math.pi))
    np.testing.assert_array_equal(ring(*x) > 0.0, (r < 1.0) & (r > 0.5))
    # the same sense twice: wound around twice, which is inside, and the inner circle has no outer side
    twice = signed(circle((0, 0), 1.0) | circle((0, 0), 0.5))
    np.testing.assert_array_equal(twice(*x) > 0.0, r < 1.0)


def test_self_crossing_is_inside_where_it_winds():
    """The pentagram: every point that it goes around, once or twice, is inside."""
    angle = 4.0 * np.pi * np.arange(5) / 5.0
    star = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    w = signed(polyline(star, closed=True))
    assert w(0.0, 0.0) > 0.0
    assert w(0.6, 0.0) > 0.0
    assert w(-0.6, 0.0) < 0.0
    np.testing.assert_array_equal(
        winding_number(w.boundary.batches, np.array([0.0, 0.6]), np.zeros(2)), [2, 1]
    )


def test_jets_and_intervals():
    w = signed(polyline(DENT, closed=True))
    points = np.random.default_rng(2).uniform(-0.4, 2.4, (60, 2))
    check_jets(w, points[np.abs(w(*points.T)) > 0.02])
    boxes = Interval(np.array([0.4, -0.3, -0.1]), np.array([0.5, -0.2, 0.1])), Interval(0.2, 0.3)
    bounds = w(*boxes)
    assert bounds.lo[0] > 0.0
    assert bounds.hi[1] < 0.0
    assert bounds.lo[2] < 0.0 < bounds.hi[2]


@settings(max_examples=40)
@given(st.integers(3, 40), st.integers(0, 1000))
def test_random_star_shaped_polygons(count, seed):
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    vertices = rng.uniform(0.3, 1.0, (count, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if np.linalg.norm(vertices - np.roll(vertices, 1, axis=0), axis=1).min() < 1e-6:
        return
    points = rng.uniform(-1, 1, (2, 300))
    inside = signed(polyline(vertices, closed=True))(*points) > 0.0
    np.testing.assert_array_equal(inside, Path(vertices).contains_points(points.T))


def test_open_curves_have_no_sign():
    message = (
        r"^a signed function needs closed curves, but a piece starts at \[0, 0\], where no other piece "
        r"continues it; close the curve, or use the unsigned function$"
    )
    with pytest.raises(GeometryError, match=message):
        signed(polyline(DENT))
    with pytest.raises(
        GeometryError, match=r"^a signed function needs closed curves in the plane or a closed"
    ):
        signed(segment((0, 0, 0), (1, 1, 1)))
