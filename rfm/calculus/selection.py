"""Piecewise functions: where, minimum, maximum, absolute value, sign.

On jets the pieces are chosen by the values, and the derivatives are those of the chosen piece. On
intervals an undecided condition gives the hull of both pieces.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.jets import Jet
from rfm.calculus.taylor import is_zero
from rfm.calculus.tri_state import TriState
from rfm.calculus.types import Value


def namespace(*values: Value) -> Any:
    """Return `jax.numpy` when one of the values is a JAX array, else `numpy`; never imports JAX by itself."""
    jax = sys.modules.get("jax")
    if jax is not None and any(isinstance(x, jax.Array) for x in values):
        import jax.numpy as jnp

        return jnp
    return np


def where(condition: Any, a: Value, b: Value) -> Value:
    """Return `a` where the condition holds, else `b`.

    Parameters
    ----------
    condition
        Boolean, Boolean array or the `TriState` of a comparison of intervals.
    a, b
        Values of any kind; both are evaluated everywhere.
    """
    if isinstance(a, Jet) or isinstance(b, Jet):
        return _where_jets(condition, a, b)
    if isinstance(condition, TriState):
        p, q = Interval.of(a), Interval.of(b)
        yes, no = condition.certain, np.logical_not(condition.possible)
        return Interval(
            np.where(yes, p.lo, np.where(no, q.lo, np.minimum(p.lo, q.lo))),
            np.where(yes, p.hi, np.where(no, q.hi, np.maximum(p.hi, q.hi))),
        )
    if isinstance(condition, bool | np.bool_):
        return a if condition else b
    if isinstance(a, Interval) or isinstance(b, Interval):
        p, q = Interval.of(a), Interval.of(b)
        return Interval(np.where(condition, p.lo, q.lo), np.where(condition, p.hi, q.hi))
    return namespace(condition, a, b).where(condition, a, b)


def _where_jets(condition: Any, a: Value, b: Value) -> Jet:
    p, q = _common(a, b)
    return Jet(
        p.dim,
        p.order,
        tuple(
            [
                x if is_zero(x) and is_zero(y) else where(condition, x, y)
                for x, y in zip(p.coefficients, q.coefficients, strict=True)
            ]
        ),
    )


def _common(a: Value, b: Value) -> tuple[Jet, Jet]:
    """Write both as jets of one order."""
    if not isinstance(a, Jet):
        return b * 0.0 + a, b
    if not isinstance(b, Jet):
        return a, a * 0.0 + b
    return a.truncate(b.order), b.truncate(a.order)


def minimum(a: Value, b: Value) -> Value:
    """Return the smaller value; on jets the expansion of it (of `a` where both are equal)."""
    if isinstance(a, Jet) or isinstance(b, Jet):
        p, q = _common(a, b)
        chosen = _where_jets(p.value <= q.value, p, q)
        return Jet(p.dim, p.order, (minimum(p.value, q.value), *chosen.coefficients[1:]))
    if isinstance(a, Interval) or isinstance(b, Interval):
        a, b = Interval.of(a), Interval.of(b)
        return Interval(np.minimum(a.lo, b.lo), np.minimum(a.hi, b.hi))
    return namespace(a, b).minimum(a, b)


def maximum(a: Value, b: Value) -> Value:
    """Return the larger value; on jets the expansion of it (of `a` where both are equal)."""
    if isinstance(a, Jet) or isinstance(b, Jet):
        p, q = _common(a, b)
        chosen = _where_jets(p.value >= q.value, p, q)
        return Jet(p.dim, p.order, (maximum(p.value, q.value), *chosen.coefficients[1:]))
    if isinstance(a, Interval) or isinstance(b, Interval):
        a, b = Interval.of(a), Interval.of(b)
        return Interval(np.maximum(a.lo, b.lo), np.maximum(a.hi, b.hi))
    return namespace(a, b).maximum(a, b)


def absolute(x: Value) -> Value:
    """Return the absolute value; its derivative at 0 is taken from the right."""
    if isinstance(x, Jet):
        chosen = _where_jets(x.value >= 0.0, x, -x)
        return Jet(x.dim, x.order, (abs(x.value), *chosen.coefficients[1:]))
    return abs(x)


def sign(x: Value) -> Value:
    """Return -1, 0 or 1 by the sign of the value: a constant with respect to derivatives."""
    if isinstance(x, Jet):
        return sign(x.value)
    if isinstance(x, Interval):
        return Interval(np.sign(x.lo), np.sign(x.hi))
    return namespace(x).sign(x)
