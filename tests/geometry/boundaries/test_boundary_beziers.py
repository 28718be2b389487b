from __future__ import annotations

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
)
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from matplotlib.path import Path
from numpy.polynomial import Polynomial

from rfm.errors import GeometryError
from rfm.geometry.boundaries import bezier, polyline, signed, spline
from rfm.geometry.boundaries.beziers import POWERS
from rfm.geometry.boundaries.winding import winding_number

CURVES = {
    "parabola": [[0, 0], [1, 2], [3, 0]],
    "arch": [[0, 0], [0, 2], [2, 2], [2, 0]],
    "s": [[0, 0], [2, 1], [-1, 2], [1, 3]],
    "hook": [[0, 0], [3, 0], [3, 2], [1, -0.5]],
    "loop": [[0, 0], [3, 2], [-2, 2], [1, 0]],
    "nearly a cusp": [[0, 0], [2, 2], [-1, 2], [1, 0.1]],
    "flat": [[0, 0], [1, 0.1], [2, 0.2], [3, 0]],
    "elevated parabola": [[0, 0], [2 / 3, 4 / 3], [5 / 3, 4 / 3], [3, 0]],
    "parabola in space": [[0, 0, 0], [1, 0, 1], [1, 2, 1]],
    "plane cubic in space": [[0, 0, 0], [1, 0, 1], [1, 2, 1], [0, 2, 0]],
    "twisted": [[0, 0, 0], [1, 0, 1], [1, 2, 0], [0, 1, 3]],
}


def values(control, r, derivative=0):
    a = POWERS[len(control) - 1] @ np.asarray(control, dtype=float)
    return np.stack(
        [Polynomial(column).deriv(derivative)(r) if derivative else Polynomial(column)(r) for column in a.T],
        axis=1,
    )


def normals(control, r):
    tangent = values(control, r, 1)
    across = tangent[:, ::-1] * [-1.0, 1.0] if tangent.shape[1] == 2 else np.cross(tangent, [0.3, -0.2, 0.9])
    return across / np.linalg.norm(across, axis=1)[:, None]


def distance_to(control, count=1000):
    """Distance to a fine polygon of the curve."""
    path = values(control, np.linspace(0, 1, count))
    return lambda points: np.concatenate(
        [np.linalg.norm(x[:, None] - path, axis=2).min(axis=1) for x in np.array_split(points, 20)]
    )


@pytest.mark.parametrize("name", CURVES)
def test_zero_on_it_unit_slope_across_it(name):
    control = CURVES[name]
    w, r = bezier(control), np.random.default_rng(0).uniform(0.02, 0.98, 60)
    on = values(control, r)
    # where the curve passes its double point the gradient of the implicit polynomial is small
    check_zero(w, np.concatenate([on, values(control, np.array([0.0, 1.0]))]), 2e-13)
    ends = np.concatenate([batch.start for batch in w.batches])
    regular = np.linalg.norm(on[:, None] - ends, axis=2).min(axis=1) > 0.15
    regular &= (np.linalg.norm(on[:, None] - on, axis=2) + (np.abs(r[:, None] - r) < 0.2) > 0.2).all(axis=1)
    assert regular.sum() > 5
    across = normals(control, r)[regular]
    check_slope(w, on[regular], across)
    if on.shape[1] == 2:
        check_slope_on(w, on[regular], across, 2e-9)


@pytest.mark.parametrize("name", CURVES)
def test_positive_elsewhere_within_a_bounded_ratio_of_the_distance(name):
    control = CURVES[name]
    w, distance = bezier(control), distance_to(control)
    points = cloud(np.mean(control, axis=0), 1.0, 300)
    points = points[distance(points) > 3e-2]
    check_ratio(w, distance, points, 0.2, 8.0)
    check_jets(w, points[:20])
    check_intervals(w, points[:40], 0.005, least=0.3)


@settings(max_examples=15)
@given(arrays(np.float64, (4, 2), elements=st.floats(-2, 2, width=16)))
def test_random_plane_cubics(control):
    """Zero on the curve and nowhere else, however it bends; cusps are refused by name."""
    try:
        w = bezier(control)
    except GeometryError as error:
        assert "cusp" in str(error) or "same point" in str(error) or "too sharply" in str(error)  # noqa: PT017
        return
    check_zero(w, values(control, np.linspace(0, 1, 41)), 1e-6)
    points = np.random.default_rng(0).uniform(-3, 3, (100, 2))
    exact = distance_to(control, 600)(points)
    ratio = (w(*points.T) / exact)[exact > 5e-2]
    assert ratio.min() > 0.01
    assert ratio.max() < 10.0


def test_sizes_do_not_matter():
    points = cloud(np.array([1.0, 1.0]), 1.0, 300)
    for name in ("parabola", "s"):
        expected = 1e6 * bezier(CURVES[name])(*points.T)
        scaled = bezier(1e6 * np.array(CURVES[name], dtype=float))
        np.testing.assert_allclose(scaled(*(1e6 * points).T), expected, rtol=1e-9)


def test_degree_is_reduced():
    kinds = [
        type(bezier(CURVES[name]).batches[0]).__name__ for name in ("elevated parabola", "flat", "twisted")
    ]
    assert kinds == ["Parabolas", "Cubics", "TwistedCubics"]
    straight = bezier([[0, 0], [2, 2], [1, 1]])  # runs to 4/3 and back
    np.testing.assert_allclose(straight.batches[0].end, [[4 / 3, 4 / 3]])
    assert type(bezier([[0, 0, 0], [1, 1, 1], [2, 2, 2], [3, 3, 3]]).batches[0]).__name__ == "Segments"


CONTROL = np.array([[0, 0], [1, 2], [2, -1], [3, 1], [4, 0], [5, 2]], dtype=float)


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("space", [False, True])
def test_splines_against_scipy(degree, space):
    from scipy.interpolate import BSpline

    control = np.column_stack([CONTROL, [0, 1, 0, 2, 1, 0]]) if space else CONTROL
    w, count = spline(control, degree), len(control)
    knots = np.concatenate([np.zeros(degree), np.arange(count - degree + 1), np.full(degree, count - degree)])
    curve = BSpline(knots, control, degree)
    check_zero(w, curve(np.linspace(0, count - degree, 101)), 1e-13)
    custom = np.sort(np.random.default_rng(0).uniform(0, 1, count + degree + 1))
    curve = BSpline(custom, control, degree)
    check_zero(spline(control, degree, custom), curve(np.linspace(custom[degree], custom[count], 101)), 1e-12)


def test_a_closed_spline_is_a_region():
    """A periodic cubic spline: the sign is that of a fine polygon."""
    from scipy.interpolate import BSpline

    angle = 2 * np.pi * np.arange(9) / 9
    loop = (1.0 + 0.3 * np.cos(3 * angle))[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    control, knots = np.concatenate([loop, loop[:3]]), np.arange(16.0)
    w = signed(spline(control, 3, knots))
    path = BSpline(knots, control, 3)(np.linspace(3, 12, 4001))
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (3000, 2))
    clear = w.boundary(*points.T) > 1e-4
    np.testing.assert_array_equal(w(*points[clear].T) > 0.0, Path(path).contains_points(points[clear]))


@pytest.mark.parametrize("name", ["parabola", "arch", "s", "hook"])
@pytest.mark.parametrize("reverse", [False, True])
def test_sign_between_a_curve_and_its_chord(name, reverse):
    control = np.array(CURVES[name], dtype=float)[:: -1 if reverse else 1]
    w = signed(bezier(control) | polyline([control[-1], control[0]]))
    polygon = polyline(values(control, np.linspace(0, 1, 801)), closed=True)
    points = np.random.default_rng(0).uniform(-0.5, 3.2, (600, 2))
    clear = points[w.boundary(*points.T) > 1e-4]
    np.testing.assert_array_equal(w(*clear.T) > 0.0, winding_number(polygon.batches, *clear.T) != 0.0)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (
            lambda: bezier(np.zeros((5, 2))),
            "a Bezier curve has at most 4 control points, got 5; give a curve of higher degree as a B-spline "
            "curve of degree 3 through points of it",
        ),
        (lambda: bezier([[1, 1], [1, 1]]), r"all control points are the same point \[1, 1\]"),
        (
            lambda: bezier([[0, 0], [2, 2], [0, 2], [2, 0]]),
            r"the curve has a cusp at \[1, 1.5\] \(parameter 0.5\), where it has no tangent; move a control point",
        ),
        (
            lambda: bezier([[0, 0], [0, 0], [1, 1], [2, 0]]),
            r"the curve has a cusp at \[0, 0\] \(parameter 0\), where it has no tangent; move a control point",
        ),
        (
            lambda: spline(CONTROL, 3, [0, 1, 2]),
            "a B-spline curve of degree 3 with 6 control points needs 10 knots, got 3",
        ),
        (
            lambda: spline(CONTROL[:3], 1, [0, 1, 3, 2, 4]),
            r"the knots must be finite and must not decrease, got \[0, 1, 3, 2, 4\]",
        ),
        (lambda: spline(CONTROL, 4), "the degree of a B-spline curve must be 1, 2 or 3, got 4"),
        (
            lambda: spline(CONTROL[:3], 3),
            "a B-spline curve of degree 3 needs at least 4 control points, got 3",
        ),
        (
            lambda: spline(CONTROL[:2], 1, [0, 1, 1, 2]),
            r"the knots \[0, 1, 1, 2\] leave no span for a curve of degree 1",
        ),
    ],
)
def test_bad_curves(build, message):
    with pytest.raises(GeometryError, match=f"^{message}$"):
        build()
