r"""Bezier ordinates, B-spline ordinates and coefficients of splines with one inner knot, in one variable.

Notation: splines s of degree k on [-1, 1], k - 1 times differentiable at the knot 0, have three forms,

* Bezier: ordinates :math:`b_{-k}, \dots, b_k`, of [-1, 0] up to :math:`b_0` and of [0, 1] from there;
* B-spline: ordinates :math:`d_0, \dots, d_{k+1}` on the knots :math:`(-1)^{k+1}, 0, 1^{k+1}` (the outermost of each
  side change nothing), :math:`d_i` being the blossom of s at :math:`(-1)^{k-i}, 0, 1^{i-1}`;
* coefficients :math:`c_0, \dots, c_{k+1}` in :math:`1, x, \dots, x^k, \min(x, 0)^k`.

In two variables the forms are matrices, converted in each direction.

Reference: Ramshaw, Blossoms are polar forms (Computer Aided Geometric Design 6, 1989); Prautzsch, Boehm and
Paluszny, Bezier and B-Spline Techniques (Springer 2002), chapters 2 to 6.
"""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np

from rfm.calculus.types import Array


@cache
def bezier_of_power(degree: int) -> Array:
    """Bezier ordinates on [0, 1] of 1, t, ..., t^k: a matrix with one column for each."""
    k = degree
    return np.array([[comb(i, a) / comb(k, a) for a in range(k + 1)] for i in range(k + 1)])


@cache
def power_of_bezier(degree: int) -> Array:
    """Coefficients of 1, t, ..., t^k from Bezier ordinates on [0, 1]: the differences at 0."""
    k = degree
    return np.array(
        [
            [comb(k, a) * comb(a, i) * (-1.0) ** (a - i) if i <= a else 0.0 for i in range(k + 1)]
            for a in range(k + 1)
        ]
    )


@cache
def bezier_of_coefficients(degree: int) -> Array:
    """Bezier ordinates of the functions 1, x, ..., x^k, min(x, 0)^k, shape (2k + 1, k + 2)."""
    k = degree
    right = np.hstack([bezier_of_power(k), np.zeros((k + 1, 1))])
    # On [-1, 0] the distance t = -x from the knot counts the ordinates backward: x^a = (-1)^a t^a.
    signs = (-1.0) ** np.arange(k + 1)
    left = np.hstack([bezier_of_power(k) * signs, bezier_of_power(k)[:, -1:] * (-1.0) ** k])
    return np.vstack([left[:0:-1], right])


@cache
def bezier_of_bspline(degree: int) -> Array:
    """Bezier ordinates of the B-splines, shape (2k + 1, k + 2), by inserting the knot 0 = (-1 + 1)/2."""
    k = degree
    left = np.zeros((k + 1, k + 2))
    left[0, 0] = 1.0
    for j in range(1, k + 1):
        left[j, 1 : j + 1] = [comb(j - 1, m) / 2 ** (j - 1) for m in range(j)]
    return np.vstack([left, left[-2::-1, ::-1]])


@cache
def bspline_of_bezier(degree: int) -> Array:
    """B-spline ordinates from the Bezier ordinates of a spline, shape (k + 2, 2k + 1)."""
    inverse = np.asarray(np.linalg.pinv(bezier_of_bspline(degree)), dtype=np.float64)
    inverse[np.abs(inverse) < 1e-14] = 0.0
    return inverse
