"""Intervals contain what they should: random boxes, random points, all operations and their jets."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus import functions as fn
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import multi_indices, partials, variables
from rfm.calculus.r_systems import R0, R1, R0m, RAlpha, Rp, equivalence
from rfm.calculus.tri_state import TriState
from rfm.calculus.types import Field

# Fields of two coordinates with boxes in which they are defined, centres and largest half width.
FIELDS: dict[str, tuple[Field, tuple[float, float], float]] = {
    "polynomial": (lambda x, y: (x - y) * (x * y + 2.0) - 3 * x**3 + y**4 / 7, (-3, 3), 2),
    "even and odd powers": (lambda x, y: x**6 - y**5 + (x * y) ** 2, (-2, 2), 2),
    "quotient": (lambda x, y: (1 - x) / (x * x + y * y + 0.5), (-2, 2), 1),
    "numbers left": (lambda x, y: 2 / (x + 5.0) - 3 + 4 * y - x, (-2, 2), 1),
    "negative power": (lambda x, y: (x + 4) ** -3 * y, (-2, 2), 1),
    "real power": (lambda x, y: (x * x) ** 0.7 + (y + 4.0) ** -1.3, (-2, 2), 1),
    "variable power": (lambda x, y: (x + 4.0) ** y + 2.0**x, (-2, 2), 1),
    "sin cos": (lambda x, y: fn.sin(3 * x) * fn.cos(x - 2 * y), (-9, 9), 3),
    "tan": (lambda x, y: fn.tan(x) + fn.tan(y / 3), (-1, 1), 0.5),
    "exponentials": (lambda x, y: fn.exp(x) * fn.log(y + 9.0) + fn.sqrt(x + 9.0), (-3, 3), 2),
    "hyperbolic": (lambda x, y: fn.sinh(x) - fn.cosh(y) * fn.tanh(x * y), (-3, 3), 2),
    "inverse": (lambda x, y: fn.asin(x / 5) + fn.acos(y / 5) * fn.atan(x), (-3, 3), 2),
    "erf": (lambda x, y: fn.erf(x * y), (-2, 2), 1),
    "atan2": (fn.atan2, (-2, 2), 2),
    "hypot": (lambda x, y: fn.hypot(x, y - 1) - 1, (-2, 2), 2),
    "pieces": (lambda x, y: fn.where(x > y, x * x, y - 1.0) + fn.absolute(x) * fn.sign(y), (-2, 2), 2),
    "extremes": (lambda x, y: fn.minimum(x, y * y) - fn.maximum(1.0, x + y), (-2, 2), 2),
    "r0": (lambda x, y: R0.conjunction(x, 1 - x * x, y), (-2, 2), 2),
    "r0 disjunction": (R0.disjunction, (-2, 2), 2),
    "r alpha": (RAlpha(0.5).conjunction, (-2, 2), 2),
    "rp": (Rp(4).disjunction, (-2, 2), 2),
    "r0m": (lambda x, y: R0m(2).conjunction(x, y) + R0m(1).disjunction(x, y), (-2, 2), 2),
    "r1": (R1().disjunction, (-2, 2), 2),
    "equivalence": (equivalence, (-2, 2), 2),
}
SMOOTH = [n for n in FIELDS if n not in {"atan2", "pieces", "hypot", "equivalence"} and not n.startswith("r")]


def random_boxes(name: str, boxes: int, points: int, seed: int) -> tuple[list[Interval], list[np.ndarray]]:
    (low, high), width = FIELDS[name][1:]
    generator = np.random.default_rng(seed)
    intervals, samples = [], []
    for _ in range(2):
        centre = generator.uniform(low, high, boxes)
        half = width * generator.random(boxes) ** 3 * (generator.random(boxes) > 0.1)
        lo, hi = np.maximum(centre - half, low), np.minimum(centre + half, high)
        intervals.append(Interval(lo, hi))
        samples.append(np.clip(lo + (hi - lo) * generator.random((points, boxes)), lo, hi))
        samples[-1][0], samples[-1][1] = lo, hi
    return intervals, samples


@pytest.mark.parametrize("name", FIELDS)
def test_values_lie_in_the_interval(name: str) -> None:
    field = FIELDS[name][0]
    intervals, samples = random_boxes(name, 400, 30, seed=6)
    enclosure = field(*intervals)
    assert np.all(enclosure.contains(field(*samples)))
    assert np.mean(np.isfinite(enclosure.width)) > 0.9


@pytest.mark.parametrize("name", SMOOTH)
def test_derivatives_lie_in_the_jets_of_intervals(name: str) -> None:
    field = FIELDS[name][0]
    intervals, samples = random_boxes(name, 100, 20, seed=7)
    jet = field(*variables(intervals, 2))
    for alpha, rows in zip(multi_indices(2, 2), partials(field, samples, 2), strict=True):
        enclosure = Interval.of(jet.derivative(alpha))
        slack = 1e-11 * (1 + np.abs(rows))  # the rounding of the sampled derivative itself
        assert np.all((enclosure.lo <= rows + slack) & (rows - slack <= enclosure.hi)), alpha


@pytest.mark.parametrize("name", ["r0", "r0 disjunction", "r alpha", "rp", "r0m"])
def test_gradients_of_r_functions_lie_in_the_jets_of_intervals(name: str) -> None:
    field = FIELDS[name][0]
    intervals, samples = random_boxes(name, 100, 20, seed=8)
    jet = field(*variables(intervals, 1))
    for alpha, rows in zip(multi_indices(2, 1), partials(field, samples, 1), strict=True):
        enclosure = Interval.of(jet.derivative(alpha))
        assert np.all((enclosure.lo <= rows + 1e-11) & (rows - 1e-11 <= enclosure.hi)), alpha


def test_width_shrinks_linearly_and_bounds_are_tight_where_promised() -> None:
    widths = []
    for h in (1e-2, 1e-3):
        x, y = Interval(0.3 - h, 0.3 + h), Interval(0.4 - h, 0.4 + h)
        widths.append((fn.sin(x) * y - x / y).width)
    assert math.log10(widths[0] / widths[1]) == pytest.approx(1.0, abs=0.05)
    x = Interval(-1.0, 2.0)
    for squared in (x * x, x**2, fn.square(x)):
        assert squared.lo == 0.0
        assert squared.hi == pytest.approx(4.0, rel=1e-15)
    assert (x**4).lo == 0.0
    assert abs(x).lo == 0.0
    conjunction = R0.conjunction(Interval(1.0, 2.0), Interval(3.0, 4.0))
    assert conjunction.lo == pytest.approx(4 - math.sqrt(10), rel=1e-14)
    assert conjunction.hi == pytest.approx(6 - math.sqrt(20), rel=1e-14)


@pytest.mark.parametrize("function", [fn.sin, fn.cos, fn.tan, fn.tanh, fn.cosh, fn.acos])
def test_functions_of_one_variable_have_the_exact_range(function: Field) -> None:
    generator = np.random.default_rng(11)
    lo = generator.uniform(-1, 0.9, 200) if function is fn.acos else generator.uniform(-9, 9, 200)
    hi = np.minimum(lo + generator.uniform(0, 4, 200), 1.0 if function is fn.acos else 12.0)
    enclosure, samples = function(Interval(lo, hi)), function(np.linspace(lo, hi, 20001))
    # Where a pole of the tangent lies inside nothing is known; elsewhere sampling errs by the square of its step.
    known = np.isfinite(enclosure.width)
    assert known.mean() > 0.3
    scale = 1.0 + np.abs(samples).max(axis=0)
    for bound, extreme in ((enclosure.lo, samples.min(axis=0)), (enclosure.hi, samples.max(axis=0))):
        np.testing.assert_array_less((np.abs(bound - extreme) / scale)[known], 1e-7)


finite = st.floats(-1e6, 1e6, allow_nan=False)


@settings(max_examples=200, deadline=None)
@given(finite, finite, finite, finite, st.sampled_from("+-*/"))
def test_rounding_is_outward(a: float, b: float, c: float, d: float, operation: str) -> None:
    """The exact rational result of operations on the bounds lies inside."""
    from fractions import Fraction

    x, y = (
        Interval(np.float64(min(a, b)), np.float64(max(a, b))),
        Interval(np.float64(c), np.float64(max(c, d))),
    )
    p, q = Fraction(float(x.lo)), Fraction(float(y.hi))
    if operation == "/" and q == 0:
        return
    exact = {"+": lambda: p + q, "-": lambda: p - q, "*": lambda: p * q, "/": lambda: p / q}[operation]()
    result = {"+": x + y, "-": x - y, "*": x * y, "/": x / y}[operation]
    assert math.isinf(result.lo) or Fraction(float(result.lo)) <= exact
    assert math.isinf(result.hi) or exact <= Fraction(float(result.hi))


def test_what_is_undefined_is_the_whole_line() -> None:
    with_zero, negative = (
        Interval(np.array([-1.0]), np.array([2.0])),
        Interval(np.array([-3.0]), np.array([-2.0])),
    )
    for unknown in (
        1.0 / with_zero,
        negative / with_zero,
        with_zero**-2,
        fn.sqrt(negative),
        fn.log(negative),
        negative**0.5,
        fn.asin(negative),
        fn.tan(Interval(np.array([1.0]), np.array([2.0]))),
        Interval.whole(np.zeros(1)) * 0.0,
        Interval.whole(np.zeros(1)) - Interval.whole(np.zeros(1)),
    ):
        assert np.isneginf(unknown.lo).all()
        assert np.isposinf(unknown.hi).all()
    assert fn.sqrt(with_zero).lo <= 0.0 <= math.sqrt(2) <= fn.sqrt(with_zero).hi
    assert fn.sin(Interval.whole(np.zeros(1))).contains(1.0).all()


def test_exact_arrays_and_numbers_on_either_side() -> None:
    x, points = Interval(np.array([1.0, 2.0]), np.array([1.5, 3.0])), np.array([2.0, -1.0])
    for result, low, high in [
        (points * x, [2, -3], [3, -2]),
        (points + x, [3, 1], [3.5, 2]),
        (points - x, [0.5, -4], [1, -3]),
        (points / x, [2 / 1.5, -0.5], [2, -1 / 3]),
        (x / points, [0.5, -3], [0.75, -2]),
        (-2 * x, [-3, -6], [-2, -4]),
        (x / -2, [-0.75, -1.5], [-0.5, -1]),
        (+x - 1, [0, 1], [0.5, 2]),
    ]:
        assert isinstance(result, Interval)
        np.testing.assert_allclose(result.lo, low, atol=1e-14)
        np.testing.assert_allclose(result.hi, high, atol=1e-14)
    assert x.shape == (2,)
    np.testing.assert_array_equal(x.middle, [1.25, 2.5])
    np.testing.assert_array_equal(x.hull(2.0).hi, [2.0, 3.0])


def test_comparisons_have_three_outcomes() -> None:
    x = Interval(np.array([-2.0, -1.0, 1.0]), np.array([-1.0, 1.0, 2.0]))
    positive = x > 0
    np.testing.assert_array_equal(positive.certain, [False, False, True])
    np.testing.assert_array_equal(positive.undecided, [False, True, False])
    np.testing.assert_array_equal((~positive).certain, [True, False, False])
    np.testing.assert_array_equal((positive & (x < 3)).certain, [False, False, True])
    np.testing.assert_array_equal((positive | (x <= 0)).undecided, [False, True, False])
    np.testing.assert_array_equal((np.array([True, True, False]) & positive).possible, [False, True, False])
    np.testing.assert_array_equal((x != 0).certain, [True, False, True])
    np.testing.assert_array_equal((x == 0).possible, [False, True, False])
    chosen = fn.where(positive, x, 10.0)
    np.testing.assert_array_equal(chosen.lo, [10.0, -1.0, 1.0])
    np.testing.assert_array_equal(chosen.hi, [10.0, 10.0, 2.0])
    assert bool(Interval(1.0, 2.0) >= 1.0)
    assert not bool(Interval(1.0, 2.0) < 1.0)
    with pytest.raises(TypeError, match=r"use rfm\.calculus\.where"):
        bool(positive)
    unknown = Interval(np.nan, np.nan) > 0
    assert unknown.undecided
    assert isinstance(unknown, TriState)
