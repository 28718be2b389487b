"""Real roots in ``[0, 1]`` of many one-dimensional Bernstein polynomials at once.

Notation: ``c (N, K + 1)`` are the coefficients of ``N`` polynomials; values below ``tolerance (N,)`` in modulus count
as zero.  By the variation diminishing property a polynomial has no root where its coefficients keep their sign and
exactly one where they change it once; all others are halved until that decides.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature import bernstein

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from solvers.grid import Integers

HALVINGS = 26
"""Two roots nearer than 2^-26 are taken for a double one (the accuracy to which a double root is known)."""

NEWTON_STEPS = 60


def monotone_root(c: Array) -> Array:
    """Return the root of polynomials that are monotone on ``[0, 1]`` and change sign there.

    Parameters
    ----------
    c
        Coefficients, shape ``(..., K + 1)``.

    Returns
    -------
    Array
        Roots clipped to ``[0, 1]``, shape ``(...)``; meaningless where there is no sign change.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        match c.shape[-1]:
            case 1:
                root = np.full(c.shape[:-1], 0.5)
            case 2:
                root = c[..., 0] / (c[..., 0] - c[..., 1])
            case 3:
                # The root nearest to zero in the form without cancellation: on a monotone arc it is the one wanted.
                b = 2.0 * (c[..., 1] - c[..., 0])
                a = c[..., 0] - 2.0 * c[..., 1] + c[..., 2]
                root_of = np.sqrt(np.maximum(b * b - 4.0 * a * c[..., 0], 0.0))
                q = -0.5 * (b + np.copysign(root_of, c[..., 2] - c[..., 0]))
                root = c[..., 0] / q
            case _:
                root = _bracketed(c)
    return np.asarray(np.where(np.isnan(root), 0.5, root).clip(0.0, 1.0))


def _bracketed(c: Array) -> Array:
    """Newton's method kept inside a shrinking bracket."""
    shape = c.shape[:-1]
    c = c.reshape(-1, c.shape[-1])
    rising = c[:, -1] > c[:, 0]
    slope_c = bernstein.derivative(c, -1)
    low, high = np.zeros(len(c)), np.ones(len(c))
    t = np.clip(np.nan_to_num(c[:, 0] / (c[:, 0] - c[:, -1]), nan=0.5), 0.0, 1.0)
    todo = np.arange(len(c))
    for _ in range(NEWTON_STEPS):
        now = t[todo]
        value = bernstein.evaluate(c[todo], now)
        left = (value < 0) == rising[todo]
        low[todo] = np.where(left, now, low[todo])
        high[todo] = np.where(left, high[todo], now)
        new = now - value / bernstein.evaluate(slope_c[todo], now)
        inside = (new >= low[todo]) & (new <= high[todo])
        new = np.where(inside, new, 0.5 * (low[todo] + high[todo]))
        t[todo] = new
        todo = todo[(np.abs(new - now) > 4e-16) & (value != 0.0)]
        if not todo.size:
            break
    return t.reshape(shape)


def real_roots(c: Array, tolerance: Array) -> tuple[Integers, Array]:
    """Return all roots inside ``(0, 1)`` as a flat list.

    Parameters
    ----------
    c
        Coefficients, shape ``(N, K + 1)``.
    tolerance
        Size below which a coefficient is rounding noise, shape ``(N,)``.

    Returns
    -------
    tuple
        Polynomial numbers and roots, both of shape ``(M,)``, in no particular order.  Double roots may come twice, and
        a root nearly touched may be reported: for breaking a quadrature rule both are harmless.
    """
    index = np.flatnonzero((c.min(axis=-1) < -tolerance) & (c.max(axis=-1) > tolerance))
    c = c[index]
    if not index.size or c.shape[-1] < 2:
        return index[:0], np.zeros(0)
    if c.shape[-1] == 2:
        return index, np.clip(c[:, 0] / (c[:, 0] - c[:, 1]), 0.0, 1.0)
    if c.shape[-1] == 3:
        return _quadratic(index, c)
    return _subdivided(index, c)


def _quadratic(index: Integers, c: Array) -> tuple[Integers, Array]:
    b = 2.0 * (c[:, 1] - c[:, 0])
    a = c[:, 0] - 2.0 * c[:, 1] + c[:, 2]
    discriminant = b * b - 4.0 * a * c[:, 0]
    # A discriminant of rounding size is a double root.
    touched = discriminant > -1e-13 * (b * b)
    q = -0.5 * (b + np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), b))
    with np.errstate(divide="ignore", invalid="ignore"):
        both = np.stack([c[:, 0] / q, q / a], axis=1)
    good = touched[:, None] & (both > 0.0) & (both < 1.0)
    rows, columns = np.nonzero(good)
    return index[rows], both[rows, columns]


def _subdivided(index: Integers, c: Array) -> tuple[Integers, Array]:
    found_index, found_root = [index[:0]], [np.zeros(0)]
    low, width = np.zeros(len(index)), 1.0
    for _ in range(HALVINGS):
        signs = np.where(c < 0, -1, 1)
        changes = np.count_nonzero(np.diff(signs, axis=-1), axis=-1)
        single = changes == 1
        if single.any():
            found_index.append(index[single])
            found_root.append(low[single] + width * _bracketed(c[single]))
        many = changes > 1
        if not many.any():
            break
        left, right = bernstein.bisect(c[many], -1)
        width *= 0.5
        c = np.concatenate([left, right])
        index = np.concatenate([index[many], index[many]])
        low = np.concatenate([low[many], low[many] + width])
    else:
        found_index.append(index)
        found_root.append(low + 0.5 * width)
    return np.concatenate(found_index), np.concatenate(found_root)
