r"""Tensor Bernstein polynomials on many boxes at once.

Notation: a polynomial of degree ``K`` in each of ``d`` directions on the unit box is stored by its coefficients,
:math:`f(t) = \sum_i c_i \prod_j B_{i_j}(t_j)`, :math:`B_i(t) = \binom{K}{i} t^i (1-t)^{K-i}`, in the last ``d`` axes of
an array; leading axes run over boxes and functions.  The coefficients bound the polynomial on the box, and those on a
face are the polynomial's restriction to the face (R. Saye, *High-order quadrature on multi-component domains implicitly
defined by multivariate polynomials*, J. Comput. Phys. 448, 2022, section 2).
"""

from __future__ import annotations

from functools import cache
from math import comb
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rfm.calculus.types import Array


def basis(degree: int, t: Array) -> Array:
    """Return all Bernstein polynomials of a degree at ``t``, shape ``(*t.shape, degree + 1)``."""
    values = np.empty((*np.shape(t), degree + 1))
    values[..., 0] = 1.0
    s = 1.0 - t
    for k in range(1, degree + 1):
        values[..., k] = t * values[..., k - 1]
        for i in range(k - 1, 0, -1):
            values[..., i] = s * values[..., i] + t * values[..., i - 1]
        values[..., 0] *= s
    return values


def evaluate(c: Array, t: Array) -> Array:
    """Evaluate one-dimensional polynomials ``c (..., degree + 1)`` at ``t (...)`` by Horner's scheme."""
    degree = c.shape[-1] - 1
    s = 1.0 - t
    value = c[..., 0]
    power: Array | float = 1.0
    for i in range(1, degree + 1):
        power = power * t
        value = value * s + comb(degree, i) * c[..., i] * power
    return np.asarray(value)


def derivative(c: Array, axis: int) -> Array:
    """Differentiate along an axis; the degree of that axis drops by one."""
    upper: list[slice] = [slice(None)] * c.ndim
    lower = upper.copy()
    upper[axis], lower[axis] = slice(1, None), slice(-1)
    return np.asarray((c.shape[axis] - 1) * (c[tuple(upper)] - c[tuple(lower)]))


@cache
def lobatto(degree: int) -> Array:
    """Return ``degree + 1`` Chebyshev points of ``[0, 1]``, both ends among them."""
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * np.arange(degree + 1) / degree)))


@cache
def from_values(degree: int) -> Array:
    """Return the matrix from values at :func:`lobatto` points to Bernstein coefficients."""
    matrix = np.asarray(np.linalg.inv(basis(degree, lobatto(degree))), dtype=np.float64)
    # The ends interpolate: keep these rows exact so that neighbouring cells agree on their common face.
    matrix[[0, -1]] = 0.0
    matrix[0, 0] = matrix[-1, -1] = 1.0
    return matrix


def transform(matrix: Array, c: Array, axis: int) -> Array:
    """Apply a matrix along one axis: one product for all boxes."""
    moved = c.swapaxes(axis, -1)
    found = moved.reshape(-1, moved.shape[-1]) @ matrix.T
    return np.asarray(found.reshape(*moved.shape[:-1], len(matrix)).swapaxes(axis, -1))


def interpolate(values: Array, dimension: int) -> Array:
    """Return coefficients from values at the tensor :func:`lobatto` points (last ``dimension`` axes)."""
    matrix = from_values(values.shape[-1] - 1)
    for axis in range(-dimension, 0):
        values = transform(matrix, values, axis)
    return np.ascontiguousarray(values)


@cache
def halves(degree: int) -> Array:
    """Return the matrix to the coefficients on the left and then on the right half (de Casteljau)."""
    left = np.zeros((degree + 1, degree + 1))
    for i in range(degree + 1):
        for j in range(i + 1):
            left[i, j] = comb(i, j) / 2.0**i
    return np.concatenate([left, left[::-1, ::-1]])


def bisect(c: Array, axis: int) -> tuple[Array, Array]:
    """Return the coefficients on both halves along one axis."""
    count = c.shape[axis]
    both = transform(halves(count - 1), c, axis)
    left: list[slice] = [slice(None)] * c.ndim
    right = left.copy()
    left[axis], right[axis] = slice(count), slice(count, None)
    return both[tuple(left)], both[tuple(right)]


def bounds(c: Array, dimension: int) -> tuple[Array, Array]:
    """Return lower and upper bounds over the unit box, the last ``dimension`` axes reduced."""
    axes = tuple(range(-dimension, 0))
    return np.asarray(c.min(axis=axes)), np.asarray(c.max(axis=axes))
