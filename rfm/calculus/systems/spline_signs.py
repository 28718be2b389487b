r"""Certifies the signs of a spline R-function from its coefficients, quadrant by quadrant.

A polynomial with P(0, 0) = 0 is shown to be positive on :math:`[0, 1]^2` without the origin.  The two triangles
:math:`Y \le X` and :math:`X \le Y` are blown up, Y = t X or X = t Y; the power of the first variable that divides P
then is taken out, so that t runs through the directions at the origin, and what is left must be positive on the
closed square (a little more than is needed: the lowest terms alone must be positive in every direction, so that
the sign near the origin does not hang on higher ones).  It is if its Bernstein coefficients are, on the square or on
every part of a subdivision.

Reference: Farouki and Rajan, On the numerical condition of polynomials in Bernstein form (Computer Aided Geometric
Design 4, 1987); Garloff, The Bernstein algorithm (Interval Computations 2, 1993).
"""

from __future__ import annotations

from math import comb

import numpy as np

from rfm.calculus.types import Array

DEPTH = 10
"""Bisections of both variables after which a polynomial counts as not positive."""

MARGIN = 1e-10
"""Part of the largest coefficient that values have to exceed."""


def violation(coefficients: Array) -> tuple[float, float] | None:
    """Find a point or direction where a polynomial is not positive.

    Parameters
    ----------
    coefficients
        Of X^i Y^j, the constant one may be 0.

    Returns
    -------
    tuple or None
        ``(X, Y)``, or None when the polynomial is positive on the unit square without the origin.  A violation
        at the origin itself gives a small multiple of the direction.
    """
    for swapped in (False, True):
        table = coefficients.T if swapped else coefficients
        found = _not_positive(_bernstein(_blown_up(table)), 0.0, 1.0, 0.0, 1.0)
        if found is not None:
            x, t = max(found[0], 1e-3), found[1]
            return (x * t, x) if swapped else (x, x * t)
    return None


def _blown_up(table: Array) -> Array:
    """Coefficients of P(X, t X)/X^m, m as large as possible."""
    degree = len(table) - 1
    result = np.zeros((2 * degree + 1, degree + 1))
    for i, j in np.ndindex(*table.shape):
        result[i + j, j] += table[i, j]
    used = np.flatnonzero(np.any(result != 0.0, axis=1))
    return result[used[0] :] if len(used) else result


def _bernstein(table: Array) -> Array:
    """Bernstein coefficients on the unit square."""
    for axis in (0, 1):
        n = table.shape[axis] - 1
        matrix = np.array([[comb(i, a) / comb(n, a) for a in range(n + 1)] for i in range(n + 1)])
        table = np.moveaxis(np.tensordot(matrix, table, (1, axis)), 0, axis)
    return table


def _not_positive(
    net: Array, x0: float, x1: float, t0: float, t1: float, depth: int = DEPTH, least: float | None = None
) -> tuple[float, float] | None:
    least = MARGIN * float(np.abs(net).max()) if least is None else least
    if net.min() > least:
        return None
    corners = {(x0, t0): net[0, 0], (x1, t0): net[-1, 0], (x0, t1): net[0, -1], (x1, t1): net[-1, -1]}
    worst = min(corners, key=lambda point: corners[point])
    if corners[worst] <= least or depth == 0:
        return worst
    x, t = 0.5 * (x0 + x1), 0.5 * (t0 + t1)
    for low, xs in zip(_halves(net, 0), ((x0, x), (x, x1)), strict=True):
        for part, ts in zip(_halves(low, 1), ((t0, t), (t, t1)), strict=True):
            found = _not_positive(part, *xs, *ts, depth - 1, least)
            if found is not None:
                return found
    return None


def _halves(net: Array, axis: int) -> tuple[Array, Array]:
    """De Casteljau's subdivision at the middle."""
    rows = np.moveaxis(net, axis, 0)
    left, right = [rows[0]], [rows[-1]]
    while len(rows) > 1:
        rows = 0.5 * (rows[:-1] + rows[1:])
        left.append(rows[0])
        right.append(rows[-1])
    return np.moveaxis(np.array(left), 0, axis), np.moveaxis(np.array(right[::-1]), 0, axis)
