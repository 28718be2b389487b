"""Partial derivatives against closed forms: one formula, evaluated on jets and differentiated by sympy."""

from typing import Any

import numpy as np
import pytest
import sympy

from rfm.calculus import functions as fn
from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field, Value

# Formulas over a library of functions m, and coordinates between which they are smooth.
FORMS: dict[str, tuple[Field, tuple[float, float]]] = {
    "polynomial": (lambda m, x, y: (x**3 - 2 * y) * (y + x * x) ** 2, (-2, 2)),
    "rational": (lambda m, x, y: (x - y) / (2.0 + x * y), (-1, 1)),
    "reciprocal power": (lambda m, x, y: 3 / (x + 2 * y) ** 2, (0.5, 2)),
    "negative power": (lambda m, x, y: (x * y) ** -3, (-2, -0.5)),
    "real power": (lambda m, x, y: (x + y * y) ** 0.7, (0.3, 2)),
    "variable power": (lambda m, x, y: x**y, (0.3, 2)),
    "power of a number": (lambda m, x, y: 2.0 ** (x * y), (-1, 1)),
    "sin": (lambda m, x, y: m.sin(x * y + 1.0), (-3, 3)),
    "cos": (lambda m, x, y: m.cos(x - y * y), (-3, 3)),
    "tan": (lambda m, x, y: m.tan(x * y), (-1, 1)),
    "exp": (lambda m, x, y: m.exp(x * y - x), (-2, 2)),
    "log": (lambda m, x, y: m.log(1.0 + x * y), (0.2, 2)),
    "sqrt": (lambda m, x, y: m.sqrt(x + y), (0.2, 2)),
    "sinh": (lambda m, x, y: m.sinh(x * y), (-2, 2)),
    "cosh": (lambda m, x, y: m.cosh(x * y), (-2, 2)),
    "tanh": (lambda m, x, y: m.tanh(x + y), (-2, 2)),
    "asin": (lambda m, x, y: m.asin(x * y), (-0.8, 0.8)),
    "acos": (lambda m, x, y: m.acos(x * y), (-0.8, 0.8)),
    "atan": (lambda m, x, y: m.atan(x * y), (-3, 3)),
    "atan2": (lambda m, x, y: m.atan2(y, x), (0.3, 2)),
    "erf": (lambda m, x, y: m.erf(x * y), (-1.5, 1.5)),
    "nested": (lambda m, x, y: m.sin(m.exp(x) / (1.0 + y**2)), (-1, 1)),
}


def closed_form(expression: Any, symbols: tuple[Any, ...], order: int, coords: list[Array]) -> Array:
    rows = []
    for alpha in multi_indices(len(symbols), order):
        orders = [pair for pair in zip(symbols, alpha, strict=True) if pair[1]]
        value = sympy.lambdify(symbols, sympy.diff(expression, *orders) if orders else expression, "scipy")
        rows.append(np.broadcast_to(value(*coords), coords[0].shape))
    return np.array(rows)


@pytest.mark.parametrize("name", FORMS)
def test_partials_to_order_three(name: str) -> None:
    form, span = FORMS[name]
    coords = list(np.random.default_rng(1).uniform(*span, (2, 7)))
    symbols = sympy.symbols("x y")
    expected = closed_form(form(sympy, *symbols), symbols, 3, coords)
    result = partials(lambda x, y: form(fn, x, y), coords, 3)
    np.testing.assert_allclose(result, expected, rtol=2e-12, atol=1e-12)


def test_partials_to_order_four_in_three_dimensions() -> None:
    def form(m: Any, x: Value, y: Value, z: Value) -> Value:
        return m.sin(x * y) * m.exp(-z) / (1.0 + x * z) + (x * y * z) ** 2.5

    coords = list(np.random.default_rng(2).uniform(0.2, 1.5, (3, 5)))
    symbols = sympy.symbols("x y z")
    expected = closed_form(form(sympy, *symbols), symbols, 4, coords)
    result = partials(lambda x, y, z: form(fn, x, y, z), coords, 4)
    np.testing.assert_allclose(result, expected, rtol=1e-11, atol=1e-10)


def test_hypot_is_the_root_of_the_sum_of_squares() -> None:
    coords = list(np.random.default_rng(3).uniform(-2, 2, (2, 7)))
    expected = partials(lambda x, y: fn.sqrt(x * x + y * y), coords, 4)
    np.testing.assert_allclose(partials(fn.hypot, coords, 4), expected, rtol=1e-12)
