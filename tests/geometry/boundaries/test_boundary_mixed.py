from __future__ import annotations

import numpy as np
import pytest
from boundary_checks import check_slope, check_zero, cloud

import rfm.geometry as g
from rfm.calculus import partials, system
from rfm.errors import GeometryError
from rfm.geometry.boundaries import mixed_set, points, polyline, segment, signed

FLAG = g.rectangle(min=(0, 1), max=(1, 1.6))
HANDLE = segment((0, 0), (0, 1))


@pytest.mark.parametrize("name", ["r0", "r1", "rp4"])
def test_the_flag_with_its_handle(name):
    """Positive inside the flag, zero on its outline and on the handle, negative elsewhere."""
    w = mixed_set([FLAG], HANDLE | points([(0.5, 0.5)]), system(name))
    s = np.linspace(0, 1, 21)
    handle = np.column_stack([0 * s, s])
    outline = [np.column_stack([s, 0 * s + y]) for y in (1.0, 1.6)]
    check_zero(w, np.concatenate([handle, *outline, [[0.5, 0.5]]]))
    x = np.random.default_rng(0).uniform((-0.5, -0.5), (1.5, 2.0), (3000, 2))
    np.testing.assert_array_equal(w(*x.T) > 0.0, FLAG.contains(x))
    assert np.all((w(*x.T) < 0.0) == ~FLAG.contains(x))
    np.testing.assert_array_equal(w.distance(*x.T) == 0.0, FLAG.contains(x))


def test_slopes():
    """Unit slope to both sides of the handle and to the outside of the flag."""
    w = mixed_set([FLAG], HANDLE)
    s = np.linspace(0.1, 0.9, 9)
    handle, east = np.column_stack([0 * s, s]), np.broadcast_to([1.0, 0.0], (9, 2))
    check_slope(w.distance, handle, east)
    top, north = np.column_stack([s, 0 * s + 1.6]), np.broadcast_to([0.0, 1.0], (9, 2))
    slopes = partials(w.distance, tuple((top + 1e-6 * north).T), 1)[1:]
    np.testing.assert_allclose(slopes.T, north, atol=1e-4)


def test_a_region_given_by_its_outline():
    w = mixed_set([signed(polyline([(0, 1), (1, 1), (1, 1.6), (0, 1.6)], closed=True))], HANDLE)
    x = np.random.default_rng(0).uniform((-0.5, -0.5), (1.5, 2.0), (1000, 2))
    np.testing.assert_array_equal(w(*x.T) > 0.0, FLAG.contains(x))


def test_in_space():
    """A ball on a stick."""
    w = mixed_set([g.ball(center=(0, 0, 2), radius=0.5)], segment((0, 0, 0), (0, 0, 2)))
    assert w(0.0, 0.0, 2.0) > 0.0
    assert w(0.0, 0.0, 1.0) == 0.0
    assert w(0.3, 0.0, 1.0) < 0.0


def test_a_union_of_regions_and_their_complements():
    w = mixed_set(
        [(g.disk(center=(0, 0), radius=1) - g.disk(center=(0, 0), radius=0.5)), FLAG.move((2, 0))], HANDLE
    )
    x = np.random.default_rng(0).uniform((-1.5, -1.5), (3.5, 2.0), (2000, 2))
    inside = (np.abs(np.hypot(*x.T) - 0.75) < 0.25) | FLAG.move((2, 0)).contains(x)
    np.testing.assert_array_equal(w(*x.T) > 0.0, inside)


def test_no_region():
    message = "^a set of mixed dimension needs a region; without one use the pieces alone$"
    with pytest.raises(GeometryError, match=message):
        mixed_set([], HANDLE)


def test_points():
    x = np.array([[0.0, 0.0], [1.0, 2.0], [-3.0, 1.0]])
    w = points(x)
    check_zero(w, x)
    for angle in (0.0, 1.0, 2.5):
        check_slope(w, x, np.broadcast_to([np.cos(angle), np.sin(angle)], x.shape))
    around = cloud(x.mean(axis=0), 1.0)
    nearest = np.linalg.norm(around[:, None] - x, axis=2).min(axis=1)
    ratio = w(*around.T) / nearest
    assert ratio.max() <= 1.0
    assert ratio.min() >= 1.0 / np.sqrt(3.0) - 1e-12
    with pytest.raises(GeometryError, match=r"^points 0 and 2 are the same point \[1, 2\]$"):
        points([[1, 2], [0, 0], [1, 2]])
