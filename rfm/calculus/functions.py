r"""The functions from which fields are written; one name for every kind of value.

A field calls these (never `numpy` directly), and can then be evaluated on numbers and arrays (NumPy), on jets
(Taylor expansions), on intervals (enclosures) and on JAX arrays.

Each function of one variable is given by its name in NumPy and JAX and by its Taylor coefficients
F^(k)(v)/k!, k = 0..m at a value v, from which `Jet.apply` composes; the values v may themselves be intervals.
Series of functions with an algebraic derivative are integrals of univariate jets of it:
F(v + t) = F(v) + integral_0^t F'(v + s) ds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from rfm.calculus import enclosures, taylor
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import Jet, variables
from rfm.calculus.selection import absolute, maximum, minimum, namespace, sign, where
from rfm.calculus.types import Value

__all__ = [
    "abs_",
    "absolute",
    "acos",
    "asin",
    "atan",
    "atan2",
    "cos",
    "cosh",
    "erf",
    "exp",
    "guarded_power",
    "hypot",
    "log",
    "maximum",
    "minimum",
    "namespace",
    "power",
    "sign",
    "sin",
    "sinh",
    "sqrt",
    "square",
    "tan",
    "tanh",
    "where",
]

# Sums of squares up to this are those of two zeros: their negative powers would overflow.
VANISHING = 1e-100

Function = Callable[[Value], Value]
Series = Callable[[Value, int], Sequence[Value]]


def _function(name: str, numpy_name: str, series: Series, plain: Function | None = None) -> Function:
    """Make the function that chooses by the kind of its argument."""
    on_arrays: Function = plain if plain is not None else getattr(np, numpy_name)
    on_intervals = enclosures.UNARY[name]

    def function(x: Value) -> Value:
        kind = type(x)
        if kind is np.ndarray or kind is float:
            return on_arrays(x)
        if kind is Jet:
            return x.apply(series)
        if kind is Interval:
            return on_intervals(x)
        library = namespace(x)
        return on_arrays(x) if library is np else _on_jax(numpy_name)(x)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = f"{name}(x) of a number, array, jet, interval or JAX array."
    return function


def _on_jax(name: str) -> Function:
    import jax

    result: Function = jax.scipy.special.erf if name == "erf" else getattr(jax.numpy, name)
    return result


def _cycle(derivatives: Sequence[Value], order: int) -> list[Value]:
    """Series of a function whose derivatives repeat."""
    result = [derivatives[k % len(derivatives)] for k in range(order + 1)]
    return [c if k < 2 else c * (1.0 / math.factorial(k)) for k, c in enumerate(result)]


def _integral(value: Value, slope: Function, v: Value, order: int) -> list[Value]:
    """Series of a function with the given value at v and derivative `slope`, see the module's docstring."""
    if order == 0:
        return [value]
    (t,) = variables((v,), order - 1)
    return taylor.antiderivative(value, slope(t).coefficients)


def _riccati(value: Value, plus: float, order: int) -> list[Value]:
    """Series of g with g' = 1 + plus * g^2 (tan: plus = 1, tanh: plus = -1)."""
    g = [value]
    for k in range(order):
        total = sum((g[i] * g[k - i] for i in range(1, k + 1)), g[0] * g[k]) * plus
        g.append((total + 1.0 if k == 0 else total) / (k + 1.0))
    return g


def _sine(v: Value, order: int) -> list[Value]:
    s, c = sin(v), cos(v) if order else 0.0
    return _cycle((s, c, -s, -c), order)


def _cosine(v: Value, order: int) -> list[Value]:
    c, s = cos(v), sin(v) if order else 0.0
    return _cycle((c, -s, -c, s), order)


sin: Function = _function("sin", "sin", _sine)
cos: Function = _function("cos", "cos", _cosine)
tan: Function = _function("tan", "tan", lambda v, m: _riccati(tan(v), 1.0, m))
exp: Function = _function("exp", "exp", lambda v, m: _cycle((exp(v),), m))
log: Function = _function("log", "log", lambda v, m: _integral(log(v), lambda t: 1.0 / t, v, m))
sinh: Function = _function("sinh", "sinh", lambda v, m: _cycle((sinh(v), cosh(v)), m))
cosh: Function = _function("cosh", "cosh", lambda v, m: _cycle((cosh(v), sinh(v)), m))
tanh: Function = _function("tanh", "tanh", lambda v, m: _riccati(tanh(v), -1.0, m))
asin: Function = _function(
    "asin", "arcsin", lambda v, m: _integral(asin(v), lambda t: 1.0 / sqrt(1.0 - t * t), v, m)
)
acos: Function = _function(
    "acos", "arccos", lambda v, m: _integral(acos(v), lambda t: -1.0 / sqrt(1.0 - t * t), v, m)
)
atan: Function = _function(
    "atan", "arctan", lambda v, m: _integral(atan(v), lambda t: 1.0 / (1.0 + t * t), v, m)
)


def _square_root(v: Value, order: int) -> list[Value]:
    """sqrt(v) binom(1/2, k) v^-k: at v = 0 the derivatives are inf, as they should be."""
    root = sqrt(v)
    series = [root]
    if order:
        series.append(0.5 / root)
        for k in range(1, order):
            series.append(series[-1] / v * ((0.5 - k) / (k + 1.0)))
    return series


sqrt: Function = _function("sqrt", "sqrt", _square_root)


def _erf_slope(t: Value) -> Value:
    return exp(-(t * t)) * (2.0 / math.sqrt(math.pi))


def _scipy_erf(x: Value) -> Value:
    from scipy.special import erf as function

    return function(x)


erf: Function = _function("erf", "erf", lambda v, m: _integral(erf(v), _erf_slope, v, m), _scipy_erf)


def square(x: Value) -> Value:
    """Return x^2."""
    return x * x


def power(x: Value, exponent: Value) -> Value:
    """Return x**exponent; whole exponents by repeated multiplication, others for x >= 0."""
    if isinstance(x, np.ndarray) and isinstance(exponent, int | float) and 0 < exponent <= 64:
        n = int(exponent)
        return taylor.repeated_product(x, n) if n == exponent else x**exponent
    return x**exponent


def hypot(a: Value, b: Value) -> Value:
    """Return sqrt(a^2 + b^2); the derivatives at a = b = 0 are finite (those of 0 to first order)."""
    if isinstance(a, Interval) or isinstance(b, Interval):
        return enclosures.hypotenuse(a, b)
    return guarded_power(a * a + b * b, 0.5)


def guarded_power(x: Value, exponent: float) -> Value:
    """Return x**exponent for x >= 0, 0 < exponent, with finite derivatives where x = 0.

    R-functions contain (f^p + g^p)^(1/p), which has no derivative where f = g = 0, in isolated points or
    curves. There the divisor x is replaced by 1; the inner derivative is zero, and hence the outer one too.
    """
    if not isinstance(x, Jet):
        library = namespace(x)
        if library is np:
            return sqrt(x) if exponent == 0.5 else x**exponent
        # JAX differentiates both pieces: neither may be singular.
        return library.where(x == 0.0, 0.0, library.where(x == 0.0, 1.0, x) ** exponent)

    def series(v: Value, order: int) -> list[Value]:
        result = [guarded_power(v, exponent)]
        if order:
            vanishing = v <= VANISHING
            divisor = where(vanishing, 1.0, v)
            last = where(vanishing, 1.0, result[0])
            for k in range(order):
                last = last / divisor * ((exponent - k) / (k + 1.0))
                result.append(last)
        return result

    return x.apply(series)


def atan2(y: Value, x: Value) -> Value:
    """Return the angle of the point (x, y), in (-pi, pi]; the cut is the negative x axis."""
    if isinstance(y, Jet) or isinstance(x, Jet):
        return _arctangent2(y, x)
    if isinstance(y, Interval) or isinstance(x, Interval):
        return enclosures.arctangent2(y, x)
    return namespace(y, x).arctan2(y, x)


def _arctangent2(y: Value, x: Value) -> Jet:
    """Jet of the angle: that of (x + i y)/(x0 + i y0), which lies near 1, turned by the angle of (x0, y0)."""
    x0 = x.value if isinstance(x, Jet) else x
    y0 = y.value if isinstance(y, Jet) else y
    across, along = y * x0 - x * y0, x * x0 + y * y0
    angle = atan(across / along)
    return Jet(angle.dim, angle.order, (atan2(y0, x0), *angle.coefficients[1:]))


abs_ = absolute
