"""Spline R-functions: criteria (a) to (c), smoothness, the three forms, scaling, bad ordinates."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rfm.calculus.intervals import Interval
from rfm.calculus.jets import partials
from rfm.calculus.r_systems import RSpline, magnitude, scaled, spline_system, system
from rfm.calculus.systems.spline_groups import GROUPS, SCALE_FREE
from rfm.calculus.systems.spline_signs import violation
from rfm.errors import GeometryError

ALL = [(k, group) for k in GROUPS for group in range(1, 7)]
everywhere = pytest.mark.parametrize(("k", "group"), ALL)
AXIS = np.linspace(-1, 1, 81)
X, Y = np.meshgrid(AXIS, AXIS)


@everywhere
def test_signs_are_those_of_the_boolean_operations(k: int, group: int) -> None:
    r = spline_system(k, group)
    open_grid = (X != 0) & (Y != 0)
    np.testing.assert_array_equal(
        np.sign(r.conjunction(X, Y))[open_grid], np.sign(np.minimum(X, Y))[open_grid]
    )
    np.testing.assert_array_equal(
        np.sign(r.disjunction(X, Y))[open_grid], np.sign(np.maximum(X, Y))[open_grid]
    )
    assert np.abs(r.conjunction(X, Y)).max() < 1 + 1e-14
    reach = 50.0 if group <= SCALE_FREE else 1.0
    far = np.random.default_rng(k).uniform(-reach, reach, (2, 2000))
    np.testing.assert_array_equal(np.sign(r.conjunction(*far)), np.sign(far.min(axis=0)))


@everywhere
def test_zero_set_is_exact_and_crossed_with_a_slope(k: int, group: int) -> None:
    r, zero = spline_system(k, group), np.zeros(40)
    along = np.linspace(0.025, 1, 40)
    for operation, side in ((r.conjunction, 1.0), (r.disjunction, -1.0)):
        for first in (True, False):
            point = (zero, side * along) if first else (side * along, zero)
            value, *slopes = partials(operation, point, 1)
            np.testing.assert_array_equal(value, 0.0)
            assert (slopes[0 if first else 1] > 0).all()
            np.testing.assert_array_equal(slopes[1 if first else 0], 0.0)
            outside = operation(*[-a for a in point])
            assert (outside * side < 0).all()
        assert operation(np.zeros(1), np.zeros(1))[0] == 0.0


@everywhere
def test_continuity_of_order_k_minus_one(k: int, group: int) -> None:
    """Derivatives of order below k agree on both sides of the axes, one of order k does not."""
    r, tiny = spline_system(k, group), 1e-9
    jump = 0.0
    for second in (-0.7, 0.0, 0.6):
        left, right = (
            partials(r.conjunction, (np.array([s * tiny]), np.array([second])), k)[:, 0] for s in (-1, 1)
        )
        below = k * (k + 1) // 2
        np.testing.assert_allclose(left[:below], right[:below], atol=1e-6)
        jump = max(jump, float(np.abs(left[below:] - right[below:]).max()))
    assert jump > 0.05
    assert r.smoothness == k - 1
    assert r.kappa(0.0, 2.0) == 0.0 < r.kappa(0.5, -2.0)


def _bernstein(k: int, i: int, t):  # type: ignore[no-untyped-def]
    from math import comb

    return comb(k, i) * t**i * (1 - t) ** (k - i)


@everywhere
def test_the_three_forms_agree(k: int, group: int) -> None:
    from scipy.interpolate import NdBSpline

    r = spline_system(k, group)
    x, y = np.random.default_rng(group).uniform(-1, 1, (2, 300))
    expected = r.conjunction(x, y)
    knots = np.array([-1.0] * (k + 1) + [0.0] + [1.0] * (k + 1))
    np.testing.assert_allclose(
        NdBSpline((knots, knots), r.bspline, k)(np.stack([x, y], -1)), expected, atol=1e-13
    )
    s, t, left, low = np.where(x < 0, x + 1, x), np.where(y < 0, y + 1, y), x < 0, y < 0
    total = np.zeros_like(x)
    for i in range(k + 1):
        for j in range(k + 1):
            ordinate = r.bezier[np.where(left, i, i + k), np.where(low, j, j + k)]
            total += ordinate * _bernstein(k, i, s) * _bernstein(k, j, t)
    np.testing.assert_allclose(total, expected, atol=1e-13)
    for again in (RSpline.of_bezier(r.bezier), RSpline.of_bspline(r.bspline)):
        np.testing.assert_allclose(again.coefficients, r.coefficients, atol=1e-13)


@everywhere
def test_intervals_enclose_and_converge(k: int, group: int) -> None:
    r = spline_system(k, group)
    x, y = np.random.default_rng(group).uniform(-0.9, 0.9, (2, 200))
    widths = []
    for half in (0.1, 0.05, 0.025):
        box = r.conjunction(Interval(x - half, x + half), Interval(y - half, y + half))
        for a in (-half, 0.0, half):
            assert box.contains(r.conjunction(x + a, y - a)).all()
        widths.append(np.max(box.width))
    assert widths[2] < 0.6 * widths[1] < 0.5 * widths[0]


@pytest.mark.parametrize("k", [2, 3])
def test_homogeneous_groups_do_not_see_a_scale(k: int) -> None:
    for group in range(1, SCALE_FREE + 1):
        r = spline_system(k, group)
        np.testing.assert_allclose(
            r.conjunction(7 * X, 7 * Y), 7.0**k * r.conjunction(X, Y), rtol=1e-12, atol=1e-12
        )


def test_a_bound_scales_arguments_and_values() -> None:
    r, wide = system("spline3:group5"), system("spline3:group5:bound4")
    np.testing.assert_allclose(wide.conjunction(4 * X, 4 * Y), 4 * r.conjunction(X, Y), atol=1e-14)
    np.testing.assert_allclose(wide.disjunction(4 * X, 4 * Y), 4 * r.disjunction(X, Y), atol=1e-14)


def test_fields_are_scaled_by_their_bounds() -> None:
    def parabola(x, y):  # type: ignore[no-untyped-def]
        return 3.0 - x * x + y

    size = magnitude(parabola, (-1, 0), (2, 1), cells=32)
    assert 4.0 <= size < 4.2
    field = scaled(parabola, (-1, 0), (2, 1), cells=32)
    x, y = np.random.default_rng(0).uniform(size=(2, 100))
    np.testing.assert_allclose(field(3 * x - 1, y) * size, parabola(3 * x - 1, y), rtol=1e-14)
    with pytest.raises(GeometryError, match=r"no bound in the box from \(-1, -1\) to \(1, 1\)"):
        magnitude(lambda x, y: 1.0 / x, (-1, -1), (1, 1))


@given(table=st.lists(st.floats(-1, 2).map(lambda c: round(c, 2)), min_size=9, max_size=9))
def test_certified_polynomials_are_positive(table: list[float]) -> None:
    coefficients = np.array(table).reshape(3, 3)
    coefficients[0, 0] = 0.0
    t = np.linspace(0, 1, 21)
    x, y = np.meshgrid(t, t, indexing="ij")
    values = np.polynomial.polynomial.polyval2d(x, y, coefficients)
    found = violation(coefficients)
    if found is None:
        assert (values.ravel()[1:] > 0).all()
    else:
        assert np.polynomial.polynomial.polyval2d(*found, coefficients) < 1e-2 * (found[0] + found[1])


@given(
    which=st.sampled_from(ALL),
    changes=st.lists(st.floats(-0.25, 0.25), min_size=11, max_size=11),
)
def test_ordinates_that_are_accepted_have_the_signs(which: tuple[int, int], changes: list[float]) -> None:
    """Certified, not sampled: whatever a random change of ordinates makes, it is refused or right."""
    k, group = which
    inner, outer, corner = GROUPS[k][group - 1]
    inner = tuple(b + c if b else b for b, c in zip(inner, changes, strict=False))
    outer = tuple(b + c for b, c in zip(outer, changes[len(inner) :], strict=False))
    try:
        r = RSpline(k, inner, outer, corner + changes[-1])
    except GeometryError:
        return
    coarse = np.array([-1, -0.8, -0.5, -0.2, -0.05, -1e-3, 1e-3, 0.05, 0.2, 0.5, 0.8, 1])
    x, y = np.meshgrid(coarse, coarse)
    np.testing.assert_array_equal(np.sign(r.conjunction(x, y)), np.sign(np.minimum(x, y)))


def test_jax_arrays() -> None:
    import jax

    r = spline_system(3, 5)
    x, y = np.array([0.3, -0.4, 0.5]), np.array([0.7, 0.2, -0.6])
    slope = jax.vmap(jax.grad(r.conjunction))(x, y)
    np.testing.assert_allclose(slope, partials(r.conjunction, (x, y), 1)[1], rtol=1e-5)


def test_bad_ordinates() -> None:
    for build, message in (
        (lambda: system("spline4"), "spline R-functions have bidegree 1, 2 or 3, got 4"),
        (lambda: RSpline(0, (), (), 1.0), "spline R-functions have bidegree 1, 2 or 3, got 0"),
        (lambda: system("spline2:group7"), "spline R-functions have groups 1 to 6, got 7"),
        (lambda: system("spline2:bound0"), "the bound of a spline R-function must be positive, got 0"),
        (lambda: RSpline(2, (0.1, 0.2), (-1.0, -1.0, -1.0), -1.0), "bidegree 2 has 3 inner ordinates, got 2"),
        (lambda: RSpline(1, (0.5,), (-1.0,), -1.0), "bidegree 1 has 2 outer ordinates, got 1"),
        (
            lambda: RSpline(3, (0.1, 0.2, 0.2, 0.3, 0.4, 0.5), (-1.0,) * 4, -1.0),
            "must have b[1, 1] = 0, or it is positive beside the corner (criterion (c)), got 0.1",
        ),
        (
            lambda: RSpline(1, (-0.5,), (-1.0, -1.0), -1.0),
            "must be positive for x > 0, y > 0 (criterion (b))",
        ),
        (
            lambda: RSpline(1, (0.5,), (-1.0, 1.0), -1.0),
            "must be negative for x < 0, y > 0 (criterion (c))",
        ),
        (
            # The middle ordinates let the mixed term x y win against the squares, see the module's docstring.
            lambda: RSpline(2, (0.6, 0.6, 0.6), (-1.0, -1.0, -1.0), -1.0),
            "must be negative for x < 0, y < 0 (criterion (c))",
        ),
        (lambda: RSpline(1, (0.5,), (-1.0, -1.0), 0.1), "not so near (-1, -1)"),
        (lambda: RSpline.of_bezier(np.ones((4, 4))), "are a square of 3, 5 or 7, got (4, 4)"),
        (lambda: RSpline.of_bspline(np.ones((3, 2))), "are a square of 3, 4 or 5, got (3, 2)"),
    ):
        with pytest.raises(GeometryError, match=re.escape(message)):
            build()


def test_a_wrong_dependent_ordinate_is_named() -> None:
    net = spline_system(2, 4).bezier.copy()
    net[2, 3] = 0.25
    with pytest.raises(
        GeometryError, match=r"b\[0, 1\] must be 0 by criterion \(a\), symmetry and C\^1, got 0.25"
    ):
        RSpline.of_bezier(net)
    net = spline_system(2, 4).bezier.copy()
    net[1, 3] = 0.1
    with pytest.raises(GeometryError, match=r"b\[-1, 1\] must be -0.25 by criterion"):
        RSpline.of_bezier(net)
