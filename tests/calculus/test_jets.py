"""Jets: algebraic laws, finite differences, special values and composition of derivatives."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus import functions as fn
from rfm.calculus.jets import (
    Jet,
    derivative,
    derivatives,
    gradient,
    multi_indices,
    partials,
    variables,
)
from rfm.calculus.types import Value


def test_first_partials_equal_finite_differences() -> None:
    generator = np.random.default_rng(3)
    coords = [generator.uniform(-1, 1, 20) for _ in range(3)]

    def field(x: Value, y: Value, z: Value) -> Value:
        return fn.where(x > 0, fn.sin(x * y), fn.maximum(x, z) + abs(y)) * fn.cosh(z)

    h, exact = 1e-6, partials(field, coords, 1)
    for i in range(3):
        ahead = [c + h * (i == j) for j, c in enumerate(coords)]
        behind = [c - h * (i == j) for j, c in enumerate(coords)]
        np.testing.assert_allclose(exact[1 + i], (field(*ahead) - field(*behind)) / (2 * h), atol=1e-8)


coefficient = st.floats(-3, 3, allow_nan=False).map(lambda c: round(c, 3))
small_jets = st.lists(coefficient, min_size=10, max_size=10).map(lambda c: Jet(2, 3, tuple(c)))


def close(a: Value, b: Value) -> None:
    np.testing.assert_allclose(a.coefficients, b.coefficients, rtol=1e-9, atol=1e-9)


@settings(max_examples=60, deadline=None)
@given(small_jets, small_jets, small_jets)
def test_ring_laws(f: Jet, g: Jet, h: Jet) -> None:
    close(f * g, g * f)
    close((f * g) * h, f * (g * h))
    close(f * (g + h), f * g + f * h)
    close(f - g, -(g - f))
    close(f * f, f * (f + 0.0))
    close(f**5, f * f * f * f * f)
    close(f**0, f * 0.0 + 1.0)


@settings(max_examples=60, deadline=None)
@given(small_jets, small_jets)
def test_division_and_inverse_functions(f: Jet, g: Jet) -> None:
    divisor = g * g + 1.0
    close(f / divisor * divisor, f)
    close(1.0 / divisor * divisor, divisor * 0.0 + 1.0)
    positive = divisor * 0.2
    close(fn.exp(fn.log(positive)), positive)
    close(fn.sqrt(positive) ** 2, positive)
    close(fn.sin(f) ** 2 + fn.cos(f) ** 2, f * 0.0 + 1.0)
    close(positive**0.5, fn.sqrt(positive))
    close(fn.tanh(f) * fn.cosh(f), fn.sinh(f))


def test_arrays_and_numbers_leave_the_arithmetic_to_the_jet() -> None:
    values = np.array([1.0, 2.0, 3.0])
    (x,) = variables((values,), 2)
    for combined, expected in [
        (values * x, (values**2, values, 0)),
        (values + x, (2 * values, 1, 0)),
        (values - x, (0 * values, -1, 0)),
        (np.float64(2.0) * x, (2 * values, 2, 0)),
        (6.0 / x, (6 / values, -6 / values**2, 12 / values**3)),
        (values / x, (np.ones(3), -1 / values, 2 / values**2)),
        (x / 2, (values / 2, 0.5, 0)),
    ]:
        assert isinstance(combined, Jet)
        for k, row in enumerate(expected):
            np.testing.assert_allclose(np.broadcast_to(combined.derivative((k,)), 3), np.broadcast_to(row, 3))


def test_powers_at_zero_are_silent_and_right() -> None:
    zero = np.array([0.0])
    np.testing.assert_array_equal(partials(lambda x: x**2.5, (zero,), 2)[:, 0], [0.0, 0.0, 0.0])
    np.testing.assert_array_equal(partials(lambda x: x**0.5, (zero,), 1)[:, 0], [0.0, np.inf])
    np.testing.assert_array_equal(partials(fn.sqrt, (zero,), 1)[:, 0], [0.0, np.inf])
    np.testing.assert_array_equal(partials(lambda x: x**0, (zero,), 2)[:, 0], [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(partials(lambda x: x**3, (zero,), 3)[:, 0], [0.0, 0.0, 0.0, 6.0])
    assert np.isnan(partials(lambda x: fn.sqrt(x * x), (zero,), 2)[1:, 0]).all()
    assert np.isinf(partials(fn.log, (zero,), 0)[0, 0])
    assert np.isinf(partials(lambda x: 1.0 / x, (zero,), 1)[0, 0])
    assert np.isinf(partials(lambda x: 1.0 / x, (0.0,), 1)[0])


def test_polynomial_derivatives_are_structural_zeros() -> None:
    x, y = variables((np.ones(3), np.ones(3)), 3)
    linear = 2.0 * x - y / 3 + 1.0
    assert all(type(c) is float and c == 0.0 for c in linear.coefficients[3:])
    squared = linear * linear
    assert all(type(c) is float and c == 0.0 for c in squared.coefficients[6:])


def test_partials_of_constants_order_zero_and_shapes() -> None:
    column, row = np.linspace(0, 1, 3)[:, None], np.linspace(0, 1, 4)
    assert partials(lambda x, y: 2.0, (column, row), 1).shape == (3, 3, 4)
    np.testing.assert_array_equal(partials(lambda x, y: 2, (column, row), 1)[:, 0, 0], [2.0, 0.0, 0.0])
    assert partials(lambda x, y: x, (column, row), 0).shape == (1, 3, 4)
    np.testing.assert_array_equal(partials(lambda x, y: x * y, (2, 3), 2), [6.0, 3.0, 2.0, 0.0, 1.0, 0.0])
    jet = variables((1.0, 2.0), 0)
    assert (jet[0] * jet[1] + fn.exp(jet[0])).value == pytest.approx(2 + math.e)


def test_many_points_in_pieces_equal_few() -> None:
    points = np.linspace(0, 1, 20001).reshape(3, 6667)

    def field(x: Value, y: Value) -> Value:
        return fn.sin(3 * x) * y

    whole = partials(field, (points, 0.5), 2)
    np.testing.assert_array_equal(whole[:, 1, :100], partials(field, (points[1, :100], 0.5), 2))


def test_derivative_fields_on_every_kind_of_argument() -> None:
    generator = np.random.default_rng(4)
    coords = [generator.uniform(0.2, 1, 6) for _ in range(2)]

    def field(x: Value, y: Value) -> Value:
        return fn.exp(x * y) / (1.0 + y)

    mixed = derivative(field, (1, 1))
    every = partials(field, coords, 5)
    position = {alpha: i for i, alpha in enumerate(multi_indices(2, 5))}
    np.testing.assert_allclose(mixed(*coords), every[position[1, 1]])
    assert float(mixed(coords[0][0], coords[1][0])) == pytest.approx(every[position[1, 1], 0])
    again = partials(mixed, coords, 3)
    for i, beta in enumerate(multi_indices(2, 3)):
        np.testing.assert_allclose(again[i], every[position[beta[0] + 1, beta[1] + 1]], rtol=1e-12)
    twice = derivative(mixed, (2, 0))
    np.testing.assert_allclose(partials(twice, coords, 1)[2], every[position[3, 2]], rtol=1e-12)
    assert derivative(field, (0, 0)) is field


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivative_composes_with_general_arguments(order: int) -> None:
    """d^alpha f evaluated on jets of other expressions is the jet of the composition."""
    generator = np.random.default_rng(5)
    coords = [generator.uniform(0.2, 1, 6) for _ in range(3)]
    outer = derivative(lambda s, t: fn.sin(s * t) + s**3 * t, (1, 1))

    def exact(s: Value, t: Value) -> Value:
        return fn.cos(s * t) - s * t * fn.sin(s * t) + 3 * s**2

    for inner in (
        lambda x, y, z: (x * y + z, fn.exp(-z) * x),
        lambda x, y, z: (y, x),
        lambda x, y, z: (0.4, x * z),
        lambda x, y, z: (x * 0.0 + 0.3, 0.2),
    ):
        composed = partials(lambda x, y, z, inner=inner: outer(*inner(x, y, z)), coords, order)
        expected = partials(lambda x, y, z, inner=inner: exact(*inner(x, y, z)), coords, order)
        np.testing.assert_allclose(composed, expected, rtol=1e-11, atol=1e-12)


def test_normalisation_by_nested_gradients() -> None:
    """Equation (4.9): f/sqrt(f^2 + |grad f|^2) has unit slope on the zero set."""

    def ellipse(x: Value, y: Value) -> Value:
        return 1.0 - (x / 2.0) ** 2 - y * y

    def normalised(x: Value, y: Value) -> Value:
        f, fx, fy = derivatives(ellipse, (x, y), 1)
        return f / fn.sqrt(f * f + fx * fx + fy * fy)

    angle = np.linspace(0, 2 * np.pi, 13)
    value, dx, dy = partials(normalised, (2 * np.cos(angle), np.sin(angle)), 1)
    np.testing.assert_allclose(value, 0.0, atol=1e-15)
    np.testing.assert_allclose(np.hypot(dx, dy), 1.0, rtol=1e-12)
    by_fields = [g(0.3, 0.4) for g in gradient(ellipse, 2)]
    np.testing.assert_allclose(by_fields, [-0.15, -0.8])


def test_jets_of_different_order_meet_at_the_lower_one() -> None:
    (low,), (high,) = variables((2.0,), 1), variables((2.0,), 3)
    for both in (low * high, high / low, low + high, high - low, fn.maximum(low, high)):
        assert both.order == 1
    assert high.truncate(2).coefficients == (2.0, 1.0, 0.0)


def test_comparisons_look_at_values() -> None:
    (x,) = variables((np.array([-1.0, 0.0, 2.0]),), 2)
    np.testing.assert_array_equal(x > 0, [False, False, True])
    np.testing.assert_array_equal(x <= x * 0.5, [True, True, False])
    np.testing.assert_array_equal(x == 0, [False, True, False])
    np.testing.assert_array_equal(x != 0, [True, False, True])
    np.testing.assert_array_equal((x >= 2.0) | (x < -0.5), [True, False, True])


def test_misuse_is_named() -> None:
    (x,), (s, _) = variables((1.0,), 1), variables((1.0, 2.0), 1)
    with pytest.raises(ValueError, match="do not combine"):
        x * s
    with pytest.raises(ValueError, match="no derivative"):
        s.derivative((1, 1))


@pytest.mark.parametrize("function", [np.sin, np.exp])
def test_numpy_functions_refuse_jets(function: Callable[[Value], Value]) -> None:
    with pytest.raises(TypeError):
        function(variables((1.0,), 1)[0])
