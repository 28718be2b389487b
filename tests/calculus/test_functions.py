"""The functions give one answer on every kind of value; JAX arrays agree with NumPy."""

import subprocess
import sys

import numpy as np
import pytest

from rfm.calculus import functions as fn
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import Jet, derivative, partials, variables
from rfm.calculus.r_systems import R0
from rfm.calculus.types import Value

UNARY = ["sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "erf"]


@pytest.mark.parametrize("name", [*UNARY, "absolute", "sign", "square"])
def test_every_kind_of_value_agrees(name: str) -> None:
    function = getattr(fn, name)
    points = np.linspace(0.05, 0.95, 7)
    values = function(points)
    np.testing.assert_allclose([float(function(float(x))) for x in points], values, rtol=1e-14)
    np.testing.assert_allclose([float(function(x)) for x in points], values, rtol=1e-14)
    np.testing.assert_array_equal(partials(lambda x: function(x) * 1.0, (points,), 0)[0], values)
    np.testing.assert_allclose(partials(lambda x: function(x) * 1.0, (points,), 1)[0], values, rtol=1e-15)
    assert np.all(function(Interval(points, points)).contains(values))
    assert np.all(function(Interval(points, points)).width <= 4e-15 * (1 + np.abs(values)))


def test_integers_and_lists_of_numbers() -> None:
    assert fn.sqrt(4) == 2.0
    assert fn.power(2, 3) == 8
    np.testing.assert_allclose(fn.exp(np.arange(3)), np.exp([0, 1, 2]))


@pytest.mark.parametrize("exponent", [0, 1, 2, 3, 7, 8.0, 2.5, -1, -2])
def test_power_of_arrays(exponent: float) -> None:
    points = np.array([0.3, 1.0, 2.7])
    np.testing.assert_allclose(fn.power(points, exponent), points**exponent, rtol=1e-14)
    np.testing.assert_array_equal(fn.power(-points, 3), -fn.power(points, 3))


def test_pieces_of_jets_keep_the_derivatives_of_the_chosen_piece() -> None:
    x = np.array([-2.0, -0.5, 0.5, 2.0])
    value, slope = partials(lambda t: fn.where(t > 0, t * t, 3.0), (x,), 1)
    np.testing.assert_array_equal(value, [3, 3, 0.25, 4])
    np.testing.assert_array_equal(slope, [0, 0, 1, 4])
    value, slope = partials(lambda t: fn.minimum(t, 1.0) + fn.maximum(t * t, t), (x,), 1)
    np.testing.assert_array_equal(slope, [1 - 4, 1 - 1, 1 + 1, 0 + 4])
    np.testing.assert_array_equal(partials(fn.absolute, (x,), 1)[1], np.sign(x))
    np.testing.assert_array_equal(partials(lambda t: fn.sign(t) * t, (x,), 1)[1], np.sign(x))
    assert fn.where(True, 1.0, 2.0) == 1.0
    decided = fn.where(x > 0, Interval(x, x + 1), 7.0)
    np.testing.assert_array_equal(decided.hi, [7, 7, 1.5, 3])


def test_angle_in_all_quadrants_and_on_the_axes() -> None:
    angle = np.linspace(-np.pi, np.pi, 17)[1:]
    x, y = 2 * np.cos(angle), 2 * np.sin(angle)
    value, dx, dy = partials(lambda x, y: fn.atan2(y, x), (x, y), 1)
    np.testing.assert_allclose(value, angle, atol=1e-15)
    np.testing.assert_allclose(dx, -y / 4, atol=1e-15)
    np.testing.assert_allclose(dy, x / 4, atol=1e-15)
    np.testing.assert_allclose(partials(lambda x, y: fn.atan2(y, 1.0), (x, y), 1)[2], 1 / (1 + y * y))


def test_hypot_has_finite_derivatives_at_the_origin() -> None:
    origin = np.zeros(2)
    assert np.isfinite(partials(fn.hypot, (origin, origin), 3)).all()
    np.testing.assert_array_equal(partials(fn.hypot, (origin, origin), 1), 0.0)
    tiny = np.array([1e-18, -1e-60, 1e-160, 1e-300])
    assert np.isfinite(partials(fn.hypot, (tiny, tiny), 3)).all()


def test_numpy_never_imports_jax() -> None:
    program = "import sys, numpy, rfm.calculus as c; c.sin(numpy.ones(2)); print('jax' in sys.modules)"
    answer = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "False"


def test_jax_arrays_agree_with_numpy() -> None:
    import jax

    def field(x: Value, y: Value) -> Value:
        pieces = fn.where(x > y, fn.sin(x) * fn.exp(y), fn.maximum(x, fn.sqrt(y)))
        return R0.conjunction(pieces, x * y)

    points = np.random.default_rng(9).uniform(0.1, 1, (2, 8))
    with jax.enable_x64(True):
        x, y = jax.numpy.asarray(points)
        assert isinstance(field(x, y), jax.Array)
        np.testing.assert_allclose(field(x, y), field(*points), rtol=1e-12)
        value, slope, _ = partials(field, points, 1)
        np.testing.assert_allclose(derivative(field, (1, 0))(x, y), slope, rtol=1e-9)
        jet = field(*variables((x, y), 1))
        assert isinstance(jet.value, jax.Array)
        np.testing.assert_allclose(jet.value, value, rtol=1e-12)
        np.testing.assert_allclose(jax.vmap(jax.grad(field))(x, y), slope, rtol=1e-9)
        for other in (fn.erf(x), fn.atan2(y, x), fn.absolute(x), fn.sign(x)):
            assert isinstance(other, jax.Array)
        assert jax.grad(lambda t: fn.hypot(t, 0.0 * t))(0.0) == 0.0
        assert isinstance(x * variables((x, y), 1)[0], Jet)
