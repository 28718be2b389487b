"""R-functions: truth tables of signs, De Morgan, normalisation, smoothness and finite derivatives."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus import functions as fn
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import Jet, partials, variables
from rfm.calculus.r_systems import (
    R0,
    R1,
    R0m,
    RAlpha,
    RAlphaOf,
    RNorm,
    Rp,
    RSum,
    RSystem,
    equivalence,
    spline_system,
    system,
)
from rfm.errors import GeometryError


def even_alpha(f, g):  # type: ignore[no-untyped-def]
    return 0.5 - 1.0 / (1.0 + f * f + g * g)


def odd_alpha(f, g):  # type: ignore[no-untyped-def]
    return 0.9 * fn.tanh(f + g)


SYSTEMS: list[RSystem] = [
    R1(), R0, RAlpha(0.5), RAlpha(-0.5), R0m(1), R0m(2), R0m(3), Rp(2), Rp(4), Rp(6),
    RAlphaOf(even_alpha), RAlphaOf(odd_alpha), RNorm(1), RNorm(2), RNorm(3), RNorm(4), RSum(1), RSum(2),
    *[spline_system(k, group) for k in (1, 2, 3) for group in (1, 2, 3)],
]  # fmt: skip
NORMALISED: list[RSystem] = [R1(), R0, Rp(2), Rp(4), RNorm(1), RNorm(2), RNorm(3), RAlphaOf(even_alpha)]
number = st.floats(-100, 100).map(lambda x: 0.0 if abs(x) < 1e-3 else x)


def name_of(r: RSystem) -> str:
    """Name of a system that is the same in every process."""
    return f"RAlphaOf({r.alpha.__name__})" if isinstance(r, RAlphaOf) else repr(r)


by_system = pytest.mark.parametrize("r", SYSTEMS, ids=name_of)


@by_system
@settings(max_examples=50, deadline=None)
@given(f=number, g=number, h=number)
def test_signs_follow_the_truth_table(r: RSystem, f: float, g: float, h: float) -> None:
    f, g, h = np.float64(f), np.float64(g), np.float64(h)
    # A zero argument may leave a rounding error of either sign, so signs are compared up to it.
    for value, exact in (
        (r.conjunction(f, g), np.sign(min(f, g))),
        (r.disjunction(f, g), np.sign(max(f, g))),
        (r.conjunction(f, r.disjunction(g, h)), np.sign(min(f, max(g, h)))),
        (r.conjunction(f, g, h), np.sign(min(f, g, h))),
        (r.negation(f), -np.sign(f)),
    ):
        sign = 0.0 if abs(value) <= 1e-13 * (1 + abs(f) + abs(g) + abs(h)) ** 4 else np.sign(value)
        assert sign in (exact, 0.0)


@by_system
def test_signs_of_an_open_grid_are_exact(r: RSystem) -> None:
    f, g = np.meshgrid([-2.0, -0.7, 0.4, 3.0], [-1.5, -0.3, 0.8, 2.5])
    np.testing.assert_array_equal(np.sign(r.conjunction(f, g)), np.sign(np.minimum(f, g)))
    np.testing.assert_array_equal(np.sign(r.disjunction(f, g)), np.sign(np.maximum(f, g)))


@by_system
@settings(max_examples=50, deadline=None)
@given(f=number, g=number)
def test_de_morgan(r: RSystem, f: float, g: float) -> None:
    f, g = np.float64(f), np.float64(g)
    np.testing.assert_allclose(r.disjunction(f, g), -r.conjunction(-f, -g), rtol=1e-12)
    np.testing.assert_allclose(r.negation(r.negation(f)), f)


@pytest.mark.parametrize("r", NORMALISED, ids=name_of)
def test_normalisation_is_kept(r: RSystem) -> None:
    """Where one argument vanishes and the other is inactive, the gradient is that of the first."""
    zero, other = np.zeros(4), np.array([0.1, 1.0, 3.0, 9.0])
    for combined, inactive in ((r.conjunction, other), (r.disjunction, -other)):
        value, first, second = partials(combined, (zero, inactive), 1)
        np.testing.assert_allclose(value, 0.0, atol=1e-15)
        np.testing.assert_allclose(first, 1.0, rtol=1e-14)
        np.testing.assert_allclose(second, 0.0, atol=1e-14)


@pytest.mark.parametrize("p", [2, 4, 6])
def test_rp_keeps_normalisation_to_order_p_minus_one(p: int) -> None:
    position = [partials(Rp(p).conjunction, (np.zeros(1), np.array([0.7])), p)[:, 0]][0]
    derivatives_in_f = [position[k * (k + 1) // 2] for k in range(p + 1)]
    np.testing.assert_allclose(derivatives_in_f[2:p], 0.0, atol=1e-10)
    assert abs(derivatives_in_f[p]) > 0.1


@by_system
def test_derivatives_are_finite_where_both_arguments_vanish(r: RSystem) -> None:
    zero = np.zeros(1)
    for combined in (r.conjunction, r.disjunction):
        assert np.isfinite(partials(combined, (zero, zero), 2)).all()
    assert np.isfinite(partials(equivalence, (zero, zero), 2)).all()


@pytest.mark.parametrize("m", [1, 2, 3])
def test_r0m_is_m_times_differentiable_in_the_corner(m: int) -> None:
    """Derivatives of degree m + 1 of the conjunction jump at the origin, those up to m tend to zero."""
    angle, small = np.linspace(0.1, 6, 9), 1e-6
    derivatives = partials(R0m(m).conjunction, (small * np.cos(angle), small * np.sin(angle)), m + 1)
    up_to_m = (m + 1) * (m + 2) // 2
    assert np.abs(derivatives[:up_to_m]).max() < 1e-4
    assert np.abs(derivatives[up_to_m:]).max() > 0.1


@pytest.mark.parametrize("p", [1, 2, 3, 4])
def test_equivalence_joins_pieces(p: int) -> None:
    other = np.array([0.2, 1.0, 4.0])
    value, first, _ = partials(lambda x, y: equivalence(x, y, p), (np.zeros(3), other), 1)
    np.testing.assert_array_equal(value, 0.0)
    np.testing.assert_allclose(first, 1.0, rtol=1e-14)
    f, g = np.array([0.3, 2.0]), np.array([0.5, 0.1])
    np.testing.assert_allclose(equivalence(f, g, p), f * g / (f**p + g**p) ** (1 / p), rtol=1e-14)
    assert equivalence(np.zeros(1), np.zeros(1), p)[0] == 0.0
    assert (equivalence(Interval(0.1, 0.2), Interval(0.3, 0.4), p)).contains(equivalence(0.15, 0.35, p))


def test_square_with_hole_by_r_functions() -> None:
    def field(x, y):  # type: ignore[no-untyped-def]
        square = R0.conjunction(1 - x * x, 1 - y * y)
        return R0.conjunction(square, R0.negation(0.25 - x * x - y * y))

    x, y = np.random.default_rng(10).uniform(-1.5, 1.5, (2, 2000))
    inside = (np.abs(x) < 1) & (np.abs(y) < 1) & (x * x + y * y > 0.25)
    np.testing.assert_array_equal(field(x, y) > 0, inside)
    assert isinstance(field(*variables((x, y), 1)), Jet)


def test_names() -> None:
    for name, expected in {
        "r1": R1(),
        "r0": R0,
        "R0": R0,
        "r0m2": R0m(2),
        "rp4": Rp(4),
        "rp2": Rp(2),
        "ralpha0.5": RAlpha(0.5),
        "ralpha-.5": RAlpha(-0.5),
        "rnorm3": RNorm(3),
        "rsum2": RSum(2),
        "spline2": spline_system(2),
        "spline3:group4": spline_system(3, 4),
        "spline1:group6:bound2.5": spline_system(1, 6, 2.5),
        "spline2_group4_bound2": spline_system(2, 4, 2.0),
    }.items():
        assert system(name) == expected
    with pytest.raises(GeometryError, match="choose one of r0, r1"):
        system("r17")
    with pytest.raises(GeometryError, match="even"):
        system("rp3")
    with pytest.raises(GeometryError, match=r"needs -1 < alpha < 1, got -1\.0"):
        system("ralpha-1.0")
    with pytest.raises(GeometryError, match="p-norms needs p >= 1, got 0"):
        system("rnorm0")
    with pytest.raises(GeometryError, match="sums of powers need m >= 1, got 0"):
        system("rsum0")
    for build in (lambda: R0m(0), lambda: RAlpha(1.0), lambda: equivalence(1.0, 1.0, 0)):
        with pytest.raises(GeometryError):
            build()
    with pytest.raises(ValueError, match="at least one"):
        R0.conjunction()
    assert fn.minimum(1.0, 2.0) == R1().conjunction(1.0, 2.0)
