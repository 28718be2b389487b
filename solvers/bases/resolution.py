r"""How many Gauss points a cell needs for functions that oscillate over the whole box.

A function that is analytic in the Bernstein ellipse with parameter :math:`\rho` about a cell, bounded by M there, is
integrated by m Gauss points with a relative error near :math:`M\rho^{-2m}` and interpolated by m points with
:math:`M\rho^{-m}` (Trefethen, *Approximation Theory and Approximation Practice*, SIAM 2013, theorems 8.2 and
19.3). A polynomial of degree n on [-1, 1] is bounded by :math:`T_n(x)` there, worst in an end cell; a
trigonometric one of frequency k by :math:`e^{k \operatorname{Im} x}`. So many cells need few points each, few cells
many.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from rfm.calculus.types import Array

DIGITS = 15.0
"""Digits to which the products of two basis functions are integrated."""
EXTRA = 3
"""Points beyond that, for the factors that are not of the basis: weight, coefficients, data."""

Growth = Callable[[Array], Array]
"""Logarithm of the bound M as a function of rho."""


def polynomial_growth(degree: int, cells: int) -> Growth:
    """Growth of polynomials of a degree over the box about an end cell."""

    def growth(rho: Array) -> Array:
        reach = 1 - 1 / cells + (rho + 1 / rho) / (2 * cells)
        return np.asarray(degree * np.arccosh(np.maximum(reach, 1.0)))

    return growth


def trigonometric_growth(phase: float) -> Growth:
    """Growth of trigonometric functions whose argument changes by `phase` over half a cell."""

    def growth(rho: Array) -> Array:
        return np.asarray(phase * (rho - 1 / rho) / 2)

    return growth


def gauss_points(growth: Growth) -> int:
    """Points that integrate products with this growth."""
    return math.ceil(_degree(growth) / 2) + EXTRA


def folded_points(growth: Growth) -> int:
    """Points whose interpolant represents products with this growth."""
    return math.ceil(_degree(growth)) + EXTRA


def _degree(growth: Growth) -> float:
    """Degree of polynomials on a cell that hold the products to :data:`DIGITS` digits."""
    rho = np.exp(np.linspace(0.05, 8.0, 400))
    return float(((DIGITS * math.log(10) + growth(rho)) / np.log(rho)).min())
