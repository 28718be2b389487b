r"""Arithmetic of truncated Taylor expansions, on plain tuples of coefficients.

Notation: f = sum_alpha f_alpha h^alpha modulo terms of degree above `order`; a tuple lists f_alpha in
the order of `rfm.calculus.multi_index`.  A coefficient is anything with arithmetic (a number, an array, an
interval); the Python float 0.0 is a *structural* zero: terms with it are not computed at all, which makes
coordinates, linear functions and low powers nearly free.

    product     (f g)_gamma = sum_{alpha + beta = gamma} f_alpha g_beta
    quotient    q = f/g:  q_gamma = (f_gamma - sum_{beta > 0} q_{gamma - beta} g_beta) / g_0
    composition F(f) = sum_k F^(k)(f_0)/k! (f - f_0)^k,  k <= order, since (f - f_0)^(order+1) = 0

Reference: Griewank and Walther, Evaluating Derivatives (SIAM 2008), chapter 13.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.multi_index import TaylorSpace
from rfm.calculus.types import Value

Coefficients = tuple[Value, ...]


def is_zero(value: Value) -> bool:
    """Tell whether `value` is a structural zero: the Python float 0.0, not an array of zeros."""
    return type(value) is float and value == 0.0


def scale(f: Coefficients, factor: Value) -> Coefficients:
    """Multiply every coefficient by a constant."""
    return tuple([c if type(c) is float and c == 0.0 else c * factor for c in f])


def add(f: Coefficients, g: Coefficients) -> Coefficients:
    """Add two expansions of the same length."""
    return tuple(
        [
            b if type(a) is float and a == 0.0 else a if type(b) is float and b == 0.0 else a + b
            for a, b in zip(f, g, strict=True)
        ]
    )


def subtract(f: Coefficients, g: Coefficients) -> Coefficients:
    """Subtract two expansions of the same length."""
    return tuple([a if type(b) is float and b == 0.0 else a - b for a, b in zip(f, g, strict=True)])


def product(f: Coefficients, g: Coefficients, space: TaylorSpace) -> Coefficients:
    """Multiply two expansions."""
    result: list[Value] = []
    for pairs in space.products:
        total: Value = 0.0
        for i, j in pairs:
            a, b = f[i], g[j]
            if type(a) is float:
                if a == 0.0:
                    continue
                term = b if a == 1.0 else a * b
            elif type(b) is float:
                if b == 0.0:
                    continue
                term = a if b == 1.0 else a * b
            else:
                term = a * b
            total = term if type(total) is float and total == 0.0 else total + term
        result.append(total)
    return tuple(result)


def square(f: Coefficients, space: TaylorSpace) -> Coefficients:
    """Square an expansion, each mixed product once (and tight for intervals, where it is not a*a)."""
    result: list[Value] = []
    for pairs, half in space.squares:
        total: Value = 0.0
        for i, j in pairs:
            a, b = f[i], f[j]
            if (type(a) is float and a == 0.0) or (type(b) is float and b == 0.0):
                continue
            term = b if type(a) is float and a == 1.0 else a if type(b) is float and b == 1.0 else a * b
            total = term if type(total) is float and total == 0.0 else total + term
        if not is_zero(total):
            total = 2.0 * total
        if half >= 0 and not is_zero(f[half]):
            total = f[half] ** 2 if is_zero(total) else total + f[half] ** 2
        result.append(total)
    return tuple(result)


def quotient(f: Coefficients, g: Coefficients, space: TaylorSpace) -> Coefficients:
    """Divide two expansions; zero divisors give inf or nan, silently."""
    if all(is_zero(c) for c in g[1:]):
        return tuple([c if is_zero(c) else divide(c, g[0]) for c in f])
    result: list[Value] = []
    for gamma, pairs in enumerate(space.quotients):
        total = f[gamma]
        if gamma and not is_zero(g[gamma]) and not is_zero(result[0]):
            total = total - result[0] * g[gamma]
        for i, j in pairs:
            if not (is_zero(result[i]) or is_zero(g[j])):
                total = total - result[i] * g[j]
        result.append(total if is_zero(total) else divide(total, g[0]))
    return tuple(result)


def divide(a: Value, b: Value) -> Value:
    """Divide two coefficients the way NumPy does: by zero is inf or nan, without a warning or an error."""
    if type(b) is float:
        b = np.float64(b)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return a / b


def repeated_product(x: Value, n: int) -> Value:
    """Multiply x by itself, n >= 1 factors, in about 2 log2(n) products of relative error n * 2^-53 in all.

    A dozen times faster on arrays than ``x**n``, and exact in sign for every kind of value.
    """
    while n % 2 == 0:
        x, n = x * x, n // 2
    result = x
    while n := n // 2:
        x = x * x
        if n % 2:
            result = result * x
    return result


def compose(series: Sequence[Value], f: Coefficients, space: TaylorSpace) -> Coefficients:
    """Apply a function of one variable, given its Taylor coefficients F^(k)(f_0)/k! at f_0, k = 0..order."""
    head, slope = series[0], series[1] if space.order else 0.0
    result = [head]
    for c in f[1:]:
        if type(c) is float:
            result.append(0.0 if c == 0.0 else slope if c == 1.0 else slope * c)
        else:
            result.append(slope * c)
    increment = (0.0, *f[1:])
    power: Coefficients = increment
    for k in range(2, space.order + 1):
        power = square(increment, space) if k == 2 else product(power, increment, space)
        factor = series[k]
        if is_zero(factor):
            continue
        for i in range(space.starts[k], len(f)):
            if not is_zero(power[i]):
                term = factor * power[i]
                result[i] = term if is_zero(result[i]) else result[i] + term
    return tuple(result)


def antiderivative(constant: Value, series: Sequence[Value]) -> list[Value]:
    """Integrate a series of one variable: c_0 given, c_{k+1} = s_k/(k+1)."""
    return [constant, *[c if is_zero(c) else c / (k + 1.0) for k, c in enumerate(series)]]
