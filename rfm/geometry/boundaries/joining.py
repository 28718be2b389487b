r"""Joining the functions of many pieces into that of their union, in any number and on values of any kind.

Notation: w_i >= 0 vanishes on piece i.  R_p-equivalence [1],

    (5.3)   w = w_1 w_2 / (w_1^p + w_2^p)^(1/p),   that is   w^(-p) = sum_i w_i^(-p),

is zero on the union and keeps the normalisation to order p.  It is evaluated as
``w = w_k (sum_i (w_k / w_i)^p)^(-1/p)`` with the nearest piece k: no power overflows, and w is as smooth as w_k
on piece k itself.

The functions lie along the last axis of arrays; :func:`spread` gives coordinates of every kind (numbers,
arrays, jets, intervals, JAX arrays) that axis.

Reference: [1] Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), section 5.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rfm.calculus.intervals import Interval, round_down, round_up
from rfm.calculus.jet import value_of
from rfm.calculus.jets import Jet
from rfm.calculus.selection import namespace, where
from rfm.calculus.taylor import is_zero, repeated_product
from rfm.calculus.types import Value

ROUNDING = 32.0
"""Units in the last place by which a bound of a joint function is moved outward, beside one for each piece."""


def spread(x: Value) -> Value:
    """Give a value of any kind one more axis at the end; numbers stay."""
    if isinstance(x, Jet):
        return Jet(x.dim, x.order, tuple([spread(c) for c in x.coefficients]))
    if isinstance(x, Interval):
        return Interval(spread(x.lo), spread(x.hi))
    return x[..., None] if np.ndim(x) else x


def joint(w: Value, p: int) -> Value:
    """Join the functions along the last axis by (5.3)."""
    if isinstance(w, Interval):
        # increasing in every argument: the bounds of the arguments give those of the result
        lo, hi = np.broadcast_arrays(np.maximum(w.lo, 0.0), w.hi)
        return _outward(_nearest_first(lo, p), _nearest_first(hi, p), lo.shape[-1])
    if isinstance(w, Jet) and isinstance(w.value, Interval):
        rest = 1.0 / _total(1.0 / repeated_product(w, p), w.value.shape) ** (1.0 / p)
        return Jet(w.dim, w.order, (joint(w.value, p), *rest.coefficients[1:]))
    return _nearest_first(w, p)


def joint_of_two(a: Value, b: Value, p: int) -> Value:
    """Join two functions by (5.3)."""
    if isinstance(a, Interval):
        lo = joint_of_two(np.maximum(a.lo, 0.0), np.maximum(b.lo, 0.0), p)
        return _outward(lo, joint_of_two(a.hi, b.hi, p), 2)
    if isinstance(a, Jet) and isinstance(a.value, Interval):
        rest = 1.0 / (1.0 / repeated_product(a, p) + 1.0 / repeated_product(b, p)) ** (1.0 / p)
        return Jet(a.dim, a.order, (joint_of_two(a.value, b.value, p), *rest.coefficients[1:]))
    first = value_of(a) <= value_of(b)
    near, far = where(first, a, b), where(first, b, a)
    ratio = near / where(value_of(far) <= 0.0, 1.0, far)
    return near * (repeated_product(ratio, p) + 1.0) ** (-1.0 / p)


def _nearest_first(w: Value, p: int) -> Value:
    value = value_of(w)
    library = namespace(value)
    nearest = library.argmin(value, axis=-1)[..., None]
    chosen = _along(w, value.shape, lambda c: library.take_along_axis(c, nearest, axis=-1))
    own = library.arange(value.shape[-1]) == nearest
    # a piece that touches the nearest one just here does not count: the value is zero anyway
    others = where(own | (value <= 0.0), 1.0, w)
    total = _total(repeated_product(where(own, 1.0, chosen / others), p), value.shape)
    return _along(chosen, (*value.shape[:-1], 1), lambda c: c[..., 0]) * total ** (-1.0 / p)


def _total(w: Value, shape: tuple[int, ...]) -> Value:
    return _along(w, shape, lambda c: c.sum(axis=-1))


def _along(w: Value, shape: tuple[int, ...], reduction: Callable[[Any], Any]) -> Value:
    """Reduce the last axis of a value of any kind, whose coefficients broadcast to `shape`."""
    if isinstance(w, Jet):
        reduced = [c if is_zero(c) else _along(c, shape, reduction) for c in w.coefficients]
        return Jet(w.dim, w.order, tuple(reduced))
    if isinstance(w, Interval):
        return _outward(_along(w.lo, shape, reduction), _along(w.hi, shape, reduction), shape[-1])
    return reduction(namespace(w).broadcast_to(w, shape))


def _outward(lo: Any, hi: Any, count: int) -> Interval:
    ulps = ROUNDING + count
    return Interval(round_down(lo, ulps), round_up(hi, ulps))
