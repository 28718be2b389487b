"""Whether a function on a face crosses zero or only touches it.

A ball inside its bounding box, a cylinder on a grid plane: the function on the face reaches zero in a point or along a
curve and turns back.  Bounds by coefficients never see that (they approach zero without reaching it), so the extreme
values are computed: on lines in one direction exactly, from the best of them by Newton's method.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature import bernstein
from solvers.quadrature.heights import restrict
from solvers.quadrature.roots import real_roots

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.logic import Mask

LINES = 5
"""Lines on which the maximum is sought."""

STEPS = 4
"""Newton steps from the best line."""

TOUCHING = 1e-10
"""An excess below this share of the function's range is touching."""


def crosses(c: Array, noise: Array) -> Mask:
    """Say whether polynomials take values of both signs on the unit square, beyond rounding.

    Parameters
    ----------
    c
        Coefficients, shape ``(n, K+1, K+1)``.
    noise
        Rounding level, shape ``(n,)``.
    """
    low, high = bernstein.bounds(c, 2)
    level = noise + TOUCHING * (high - low)
    return np.asarray((_maximum(c) > level) & (_maximum(-c) > level))


def _maximum(c: Array) -> Array:
    """Maximum over the unit square: exact on some lines, from there by Newton's method."""
    n, k = len(c), c.shape[1] - 1
    t = bernstein.lobatto(LINES - 1)
    lines = restrict(c, np.broadcast_to(t, (n, LINES))).reshape(n * LINES, k + 1)
    x, value = (array.reshape(n, LINES) for array in _line_maximum(lines))
    rows = np.arange(n)
    best = value.argmax(axis=1)
    greatest = value[rows, best]
    point = np.stack([x[rows, best], t[best]], axis=1)
    for _ in range(STEPS):
        point = np.clip(point + _uphill(c, point), 0.0, 1.0)
        greatest = np.maximum(greatest, _at(c, point))
    return np.asarray(greatest)


def _line_maximum(c: Array) -> tuple[Array, Array]:
    """Where one-dimensional polynomials ``c (n, K+1)`` are greatest on ``[0, 1]``, and their values there."""
    at = np.where(c[:, -1] > c[:, 0], 1.0, 0.0)
    index, t = real_roots(bernstein.derivative(c, -1), np.zeros(len(c)))
    value = bernstein.evaluate(c[index], t)
    order = np.argsort(value, kind="stable")
    index, t, value = index[order], t[order], value[order]
    higher = value > np.maximum(c[index, 0], c[index, -1])
    # The last of several assignments stays: the greatest value.
    at[index[higher]] = t[higher]
    return at, bernstein.evaluate(c, at)


def _uphill(c: Array, point: Array) -> Array:
    """Newton step towards a maximum, in the directions in which the function is concave."""
    first = [bernstein.derivative(c, axis) for axis in (1, 2)]
    gradient = np.stack([_at(f, point) for f in first], axis=1)
    mixed = _at(bernstein.derivative(first[0], 2), point)
    second = [_at(bernstein.derivative(f, axis), point) for axis, f in enumerate(first, start=1)]
    hessian = np.stack([second[0], mixed, mixed, second[1]], axis=1).reshape(-1, 2, 2)
    values, vectors = np.linalg.eigh(hessian)
    concave = values < -1e-6 * np.abs(values).max(axis=1, keepdims=True)
    along = np.einsum("nij,ni->nj", vectors, gradient)
    step = np.where(concave, -along / np.where(concave, values, 1.0), 0.0)
    return np.asarray(np.einsum("nij,nj->ni", vectors, step))


def _at(c: Array, point: Array) -> Array:
    x = bernstein.basis(c.shape[1] - 1, point[:, 0])
    y = bernstein.basis(c.shape[2] - 1, point[:, 1])
    return np.asarray(np.einsum("nij,ni,nj->n", c, x, y))
