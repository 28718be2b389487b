"""Expressions: values against Python's, errors with their caret, conditions, fields on all kinds of values."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.app.expressions import CONSTANTS, FUNCTIONS, Expression, ExpressionError
from rfm.app.expressions.nodes import polynomial_degree
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import partials, variables

PARAMETERS = {"R": 0.4, "r": 0.1}


def value(text: str, *coords: float) -> float:
    return float(Expression(text, PARAMETERS).field(len(coords))(*coords))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 + 2*3", 7.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("2^-1", 0.5),
        ("2**3", 8.0),
        ("(1 + 2) * 3 - 4/8", 8.5),
        ("1 - 2 - 3", -4.0),
        ("8 / 4 / 2", 1.0),
        ("R + r", 0.5),
        ("+R", 0.4),
        ("sqrt(2)^2", 2.0),
        ("min(3, 1, 2) + max(3, 1, 2)", 4.0),
        ("atan2(1, -1)", 0.75 * math.pi),
        ("hypot(3, 4)", 5.0),
        ("where(R > r, 1, 2)", 1.0),
        ("where(R > r and not R > 1, 1, 2)", 1.0),
        ("where(0 < r < R, 1, 2)", 1.0),
        ("abs(-3) * sign(-2)", -3.0),
        ("e^1 - exp(1)", 0.0),
        ("cos(pi)", -1.0),
        ("1e-3 + .5 + 2.", 2.501),
        ("  1\n +\t2 ", 3.0),
    ],
)
def test_constants_are_folded(text, expected):
    assert Expression(text, PARAMETERS).constant == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "point", "expected"),
    [
        ("x^2 + y^2", (3.0, 4.0), 25.0),
        ("x^y", (2.0, 3.0), 8.0),
        ("2^x", (3.0, 0.0), 8.0),
        ("x^0.5", (4.0, 0.0), 2.0),
        ("-x^2", (3.0, 0.0), -9.0),
        ("where(x > y, x, y)", (1.0, 2.0), 2.0),
        ("where(x == 1 or y != 2, 1, 0)", (1.0, 2.0), 1.0),
        ("where(not (x > 0 and y > 0), 1, 0)", (1.0, -2.0), 1.0),
        ("where(0 < x <= 1 < y, 1, 0)", (1.0, 2.0), 1.0),
        ("sin(x) / cos(x) - tan(x)", (0.7, 0.0), 0.0),
        ("erf(x) + sinh(x) - tanh(y)", (0.0, 0.0), 0.0),
    ],
)
def test_values_at_a_point(text, point, expected):
    assert value(text, *point) == pytest.approx(expected, abs=1e-14)


def test_a_vertical_stroke_of_every_function():
    arguments = {"where": "x > 0, 1, 2", "atan2": "x, y", "hypot": "x, y", "min": "x, y", "max": "x, y"}
    for name in FUNCTIONS:
        assert math.isfinite(value(f"{name}({arguments.get(name, 'x')})", 0.3, 0.6))


def test_fields_broadcast_and_do_not_warn():
    field = Expression("1/x + log(y)").field(2)
    result = field(np.array([0.0, 1.0]), np.array([[1.0], [-1.0]]))
    assert result.shape == (2, 2)
    assert np.isinf(result[0, 0])
    assert np.isnan(result[1, 1])
    assert math.isinf(field(0.0, 1.0))
    assert field.source == "1/x + log(y)"


def test_derivatives_by_jets():
    field = Expression("sin(x*y)^2 + where(x > 0, x^3, -x)").field(2)
    x, y = np.array([0.5, 1.0]), np.array([2.0, -0.3])
    found = partials(field, (x, y), 2)
    u, c = x * y, np.cos(x * y)
    np.testing.assert_allclose(found[0], np.sin(u) ** 2 + x**3)
    np.testing.assert_allclose(found[1], 2 * y * np.sin(u) * c + 3 * x**2)
    np.testing.assert_allclose(found[2], 2 * x * np.sin(u) * c)
    np.testing.assert_allclose(found[5], 2 * x**2 * np.cos(2 * u))


def test_jets_of_powers_with_a_variable_exponent():
    (x, y) = variables((np.array([2.0]), np.array([3.0])), 1)
    jet = Expression("x^y").field(2)(x, y)
    np.testing.assert_allclose(jet.derivative((1, 0)), 12.0)
    np.testing.assert_allclose(jet.derivative((0, 1)), 8.0 * math.log(2.0))


def test_intervals_enclose():
    field = Expression("where(x^2 + y^2 > 1 and not y < 0, exp(-x), min(x, y) - 1)").field(2)
    box = Interval(np.array([-0.5]), np.array([1.5])), Interval(np.array([-1.0]), np.array([1.0]))
    bounds = field(*box)
    generator = np.random.default_rng(0)
    samples = field(generator.uniform(-0.5, 1.5, 1000), generator.uniform(-1, 1, 1000))
    assert (bounds.lo <= samples.min()).all()
    assert (samples.max() <= bounds.hi).all()
    assert Expression("x^2").field(1)(Interval(np.array([-1.0]), np.array([2.0]))).lo[0] >= -1e-12


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("", 0, "empty"),
        ("   ", 0, "empty"),
        ("sin(x", 3, "never closed"),
        ("x + ", 3, "ends too early"),
        ("x + foo", 4, "unknown name 'foo'; known names: x, y"),
        ("2^x + foo^2", 6, "unknown name 'foo'"),
        ("x^2^3 + yy", 8, "did you mean 'y'?"),
        ("sn(x)", 0, "unknown function 'sn'; did you mean 'sin'?"),
        ("2x", 0, "a product is written with *"),
        ("x y", 2, "syntax error"),
        ("R(x)", 0, "R is no function"),
        ("x(2)", 0, "x is no function"),
        ("2(x)", 0, "only a function can be called"),
        ("sin", 0, "needs arguments"),
        ("1 + sin(x, y)", 4, "takes 1 argument, got 2"),
        ("atan2(x)", 0, "takes 2 arguments, got 1"),
        ("min(x)", 0, "at least 2 arguments"),
        ("where(x, 1, 2)", 6, "a condition such as x > 0.5"),
        ("where(x > 0, y > 0, 2)", 13, "a condition is no number"),
        ("(x > 0) * 2", 1, "a condition is no number"),
        ("x and y", 0, "a condition such as"),
        ("not x", 4, "a condition such as"),
        ("sin(x) > y + (x > 0)", 14, "a condition is no number"),
        ("1 + 1/0", 5, "division by zero"),
        ("1/(R - 4*r)", 1, "division by zero"),
        ("log(0 - R)", 0, "no finite real value"),
        ("(0-1)^0.5", 0, "no finite real value"),
        ("1e999", 0, "no finite real value"),
        ("exp(1000)", 0, "no finite real value"),
        ("9**9**9", 3, "exponent"),
        ("x^9999", 2, "exponent 9999 is too large"),
        ("x // 2", 2, "'//' is not an operation"),
        ("x % 2", 2, "character '%'"),
        ("x if y else 2", 0, "write where(condition, a, b)"),
        ("x.real", 0, "a dot between names"),
        ("x, y", 0, "a list of values"),
        ("True", 0, "no real number"),
        ("None", 0, "no real number"),
        ("x is y", 0, "not a comparison"),
        ("x in y", 0, "not a comparison"),
        ("sin(x=1)", 0, "no named arguments"),
        ("sin(*x)", 4, "'*' must stand between"),
        ("*x", 0, ""),
        ("x := 2", 2, "character ':'"),
        ("x[0]", 1, "character '['"),
        ("lambda x: x", 8, "character ':'"),
        ("__import__('os')", 11, 'character "\'"'),
        ("__import__(x)", 0, "unknown function '__import__'"),
        ("x # y", 2, "character '#'"),
        ("π*x", 0, "character 'π'"),
        ("x = 2", 2, "syntax error"),
        ("1j", 1, ""),
        ("x & y", 2, "character '&'"),
        ("u + 1", 0, "unknown name 'u'"),
    ],
)
def test_mistakes_are_placed(text, offset, words):
    with pytest.raises(ExpressionError) as caught:
        Expression(text, PARAMETERS)
    assert words in caught.value.message
    if words:
        assert caught.value.offset == offset
    assert caught.value.excerpt.split("\n")[-1].endswith("^")


@pytest.mark.parametrize(
    "text",
    [
        "(" * 3000 + "x" + ")" * 3000,
        "-" * 3500 + "x",
        "sin(" * 500 + "x" + ")" * 500,
        "9" * 3900,
        "x" * 5000,
        "x^" * 1900 + "x",
        "not " * 900 + "x",
    ],
)
def test_deep_and_long_expressions_are_refused(text):
    with pytest.raises(ExpressionError):
        Expression(text)


def test_long_sums_are_no_problem():
    assert value("+".join(["x"] * 1900), 1.0) == 1900.0


def test_variables_without_a_value():
    plane = {"z": "'z' is no coordinate of this two-dimensional case (only x, y)"}
    with pytest.raises(ExpressionError, match="no coordinate of this two-dimensional case"):
        Expression("x + z", {}, ("x", "y"), plane)
    with pytest.raises(ExpressionError, match="'z' has no value here, only x, y"):
        Expression("x + z").field(2)
    assert Expression("x + z").field(3)(1.0, 5.0, 2.0) == 3.0
    assert Expression("u*x", {}, ("x", "y", "u")).field(2, extra=("u",))(2.0, 0.0, 3.0) == 6.0
    with pytest.raises(TypeError, match=r"a field of \(x, y\)"):
        Expression("x").field(2)(1.0)


@pytest.mark.parametrize(
    "text",
    [
        "x > 0.2",
        "x < y",
        "x > 0 and y > 0",
        "x > 0.5 or y > 0.5",
        "not (x > 0 and y <= x)",
        "0 < x < 0.7",
        "not x > 0",
    ],
)
def test_conditions_become_functions_of_the_right_sign(text):
    points = np.random.default_rng(1).uniform(-1, 1, (2, 500))
    expression = Expression(text)
    truth = expression.field(2)(*points)
    np.testing.assert_array_equal(expression.condition(2)(*points) > 0, truth)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x + 1", "is expected"),
        ("1 > 0", "everywhere"),
        ("1 < 0", "nowhere"),
        ("x == y", "selects no piece"),
        ("x > 0 or y != 0", "selects no piece"),
    ],
)
def test_conditions_that_select_nothing_sensible(text, words):
    with pytest.raises(ExpressionError, match=words):
        Expression(text).condition(2)


@pytest.mark.parametrize(
    ("text", "degree"),
    [
        ("1", 0),
        ("x", 1),
        ("x*y + 1", 2),
        ("-(x^2 - y)^3", 6),
        ("x/2", 1),
        ("1/x", None),
        ("x^0.5", None),
        ("sin(x)", None),
        ("x^y", None),
    ],
)
def test_polynomials_are_recognised(text, degree):
    assert polynomial_degree(Expression(text).node) == degree


# A random expression and its value by Python itself -----------------------------------------------

NUMBERS = st.floats(0.1, 4.0).map(lambda v: f"{v:.3f}")
LEAVES = st.one_of(NUMBERS, st.sampled_from(["x", "y", *PARAMETERS, *CONSTANTS]))


def grow(inner):
    binary = st.tuples(inner, st.sampled_from("+-*"), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})")
    flat = st.lists(inner, min_size=2, max_size=4).map(" - ".join).map(lambda t: f"({t})")
    power = inner.map(lambda t: f"({t})^2")
    signed = inner.map(lambda t: f"-{t}")
    call = st.tuples(st.sampled_from(["sin", "cos", "atan", "tanh", "abs"]), inner).map(
        lambda t: f"{t[0]}({t[1]})"
    )
    several = st.lists(inner, min_size=2, max_size=3).map(lambda t: f"max({', '.join(t)})")
    return st.one_of(binary, flat, power, signed, call, several)


@settings(max_examples=300, deadline=None)
@given(st.recursive(LEAVES, grow, max_leaves=12), st.floats(-2, 2), st.floats(-2, 2))
def test_values_agree_with_python(text, x, y):
    names = {**{n: getattr(math, n) for n in ("sin", "cos", "atan", "tanh")}, "abs": abs, "max": max}
    names |= {"x": x, "y": y, **PARAMETERS, **CONSTANTS}
    expected = eval(text.replace("^", "**"), {"__builtins__": {}}, names)
    assert value(text, x, y) == pytest.approx(expected, rel=1e-9, abs=1e-9)
