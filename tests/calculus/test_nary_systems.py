"""R-functions of many arguments: associativity, symmetry, order of normalisation, smoothness, bounds."""

from itertools import permutations

import numpy as np
import pytest

from rfm.calculus.intervals import Interval
from rfm.calculus.jets import partials
from rfm.calculus.r_systems import R0, RNorm, Rp, RSum, RSystem

VALUES = np.random.default_rng(5).uniform(-1, 1, (4, 300)) + 0.6


@pytest.mark.parametrize("p", [1, 2, 3, 6])
def test_p_norms_are_associative_and_symmetric(p: int) -> None:
    r = RNorm(p)
    f, g, h, k = VALUES
    expected = r.conjunction(f, g, h, k)
    np.testing.assert_allclose(r.conjunction(r.conjunction(f, g), r.conjunction(h, k)), expected, rtol=1e-12)
    for order in permutations(VALUES):
        np.testing.assert_allclose(r.conjunction(*order), expected, rtol=1e-12)
        np.testing.assert_allclose(r.disjunction(*order), r.disjunction(f, g, h, k), rtol=1e-12)


def test_rp_is_not_associative() -> None:
    f, g, h, _ = VALUES
    for r in (R0, Rp(4)):
        assert (
            np.max(np.abs(r.conjunction(r.conjunction(f, g), h) - r.conjunction(f, r.conjunction(g, h))))
            > 0.01
        )


def test_p_norms_are_those() -> None:
    positive, negative = VALUES[:3, (VALUES[:3] > 0).all(axis=0)], -np.abs(VALUES[:3])
    np.testing.assert_allclose(
        RNorm(3).conjunction(*positive), np.sum(positive**-3.0, axis=0) ** (-1 / 3), rtol=1e-12
    )
    np.testing.assert_allclose(
        RNorm(3).conjunction(*negative), -(np.sum(np.abs(negative) ** 3, axis=0) ** (1 / 3)), rtol=1e-12
    )


@pytest.mark.parametrize("p", [1, 2, 3, 4])
def test_p_norms_keep_normalisation_to_order_p(p: int) -> None:
    """Of three arguments, in that which vanishes: value f + O(f^(p+1)), from both sides."""
    steps = np.array([0.1, 0.05, 0.025])
    ones = np.ones(3)
    inside = RNorm(p).conjunction(steps, 0.7 * ones, ones) - steps
    order = np.log2(np.abs(inside[:-1] / inside[1:]))
    np.testing.assert_allclose(order, p + 1, atol=0.25)
    np.testing.assert_allclose(RNorm(p).conjunction(-steps, 0.7 * ones, ones), -steps, rtol=1e-14)


@pytest.mark.parametrize("m", [1, 2, 3])
def test_sums_of_powers_are_m_times_differentiable(m: int) -> None:
    """Up to order m the derivatives agree on both sides of every line where an argument vanishes."""
    up_to_m = (m + 1) * (m + 2) // 2
    for second in (-0.6, 0.0, 0.8):
        sides = [
            partials(RSum(m).conjunction, (np.array([s * 1e-7]), np.array([second])), m + 1) for s in (-1, 1)
        ]
        np.testing.assert_allclose(sides[0][:up_to_m], sides[1][:up_to_m], atol=1e-5)
    assert abs(sides[0][up_to_m, 0] - sides[1][up_to_m, 0]) > 0.1


def test_sum_of_powers_of_three() -> None:
    f, g, h = VALUES[:3]
    m = 2
    direct = sum((-1) ** m * x**m * (x - np.abs(x)) for x in (f, g, h)) + f**m * (f + abs(f)) * g**m * (
        g + abs(g)
    ) * h**m * (h + abs(h))
    np.testing.assert_allclose(RSum(m).conjunction(f, g, h), direct, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(np.sign(RSum(m).conjunction(*VALUES)), np.sign(VALUES.min(axis=0)))
    np.testing.assert_array_equal(np.sign(RSum(m).disjunction(*VALUES)), np.sign(VALUES.max(axis=0)))


@pytest.mark.parametrize("r", [RNorm(2), RNorm(3), RSum(1)], ids=repr)
def test_intervals_enclose(r: RSystem) -> None:
    lo, hi = VALUES[:3] - 0.02, VALUES[:3] + 0.02
    box = r.conjunction(*[Interval(a, b) for a, b in zip(lo, hi, strict=True)])
    # They increase in every argument, so the bounds are the values in two corners.
    assert (box.contains(r.conjunction(*lo)) & box.contains(r.conjunction(*hi))).all()
    np.testing.assert_allclose(box.lo, r.conjunction(*lo), rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(box.hi, r.conjunction(*hi), rtol=1e-12, atol=1e-14)
