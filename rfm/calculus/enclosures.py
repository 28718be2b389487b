"""Enclosures of the elementary functions over intervals.

Every function takes and returns an `Interval`. The library functions behind them are accurate to a few
units in the last place, so their values are moved outward by `ULPS` of them. Arguments are cut to the
domain of definition; where nothing of them is left, the whole line is returned.

Reference: Moore, Kearfott, Cloud, Introduction to Interval Analysis (SIAM 2009), chapter 5.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rfm.calculus.intervals import Interval, round_down, round_up
from rfm.calculus.types import Value

ULPS = 8.0
# Distance to an extremum, in periods, below which a sine is taken to reach it; covers the rounding of
# the argument's reduction.
SLACK = 1e-13


def _bounded(lo: Any, hi: Any) -> Interval:
    lo, hi = round_down(lo, ULPS), round_up(hi, ULPS)
    if np.any(bad := np.isnan(lo) | np.isnan(hi)):
        lo, hi = np.where(bad, -np.inf, lo), np.where(bad, np.inf, hi)
    return Interval(lo, hi)


def _increasing(
    function: Callable[[Any], Any], start: float = -np.inf, end: float = np.inf
) -> Callable[[Interval], Interval]:
    """Enclose an increasing function that is defined on [start, end]."""

    def enclose(x: Interval) -> Interval:
        with np.errstate(all="ignore"):
            lo, hi = np.maximum(x.lo, start), np.minimum(x.hi, end)
            empty = lo > hi
            return _bounded(np.where(empty, np.nan, function(lo)), np.where(empty, np.nan, function(hi)))

    return enclose


def _arccosine(x: Interval) -> Interval:
    y = _increasing(np.arcsin, -1.0, 1.0)(x)
    return 0.5 * np.pi - y


def _hyperbolic_cosine(x: Interval) -> Interval:
    magnitude = abs(x)
    with np.errstate(over="ignore"):
        y = _bounded(np.cosh(magnitude.lo), np.cosh(magnitude.hi))
    return Interval(np.maximum(y.lo, 1.0), y.hi)


def _wave(function: Callable[[Any], Any], crest: float) -> Callable[[Interval], Interval]:
    """Enclose a sine or cosine with its crests at 2 pi (k + `crest`), its troughs half a period on."""

    def enclose(x: Interval) -> Interval:
        with np.errstate(invalid="ignore"):
            a, b = x.lo / (2.0 * np.pi) - crest, x.hi / (2.0 * np.pi) - crest
            slack = SLACK * (1.0 + np.maximum(np.abs(a), np.abs(b)))
            top = np.ceil(a - slack) <= np.floor(b + slack)
            bottom = np.ceil(a - 0.5 - slack) <= np.floor(b - 0.5 + slack)
            p, q = function(x.lo), function(x.hi)
            lo = np.where(bottom, -1.0, round_down(np.minimum(p, q), ULPS))
            hi = np.where(top, 1.0, round_up(np.maximum(p, q), ULPS))
        # fmax and fmin also turn the nan of an infinite argument into the bound.
        return Interval(np.fmax(lo, -1.0), np.fmin(hi, 1.0))

    return enclose


def _tangent(x: Interval) -> Interval:
    with np.errstate(invalid="ignore"):
        a, b = x.lo / np.pi, x.hi / np.pi
        slack = SLACK * (1.0 + np.maximum(np.abs(a), np.abs(b)))
        pole = ~(np.ceil(a - 0.5 - slack) > np.floor(b - 0.5 + slack))
        return _bounded(np.where(pole, np.nan, np.tan(x.lo)), np.where(pole, np.nan, np.tan(x.hi)))


def _error_function(x: Any) -> Any:
    from scipy.special import erf

    return erf(x)


UNARY: dict[str, Callable[[Interval], Interval]] = {
    "sin": _wave(np.sin, 0.25),
    "cos": _wave(np.cos, 0.0),
    "tan": _tangent,
    "asin": _increasing(np.arcsin, -1.0, 1.0),
    "acos": _arccosine,
    "atan": _increasing(np.arctan),
    "sinh": _increasing(np.sinh),
    "cosh": _hyperbolic_cosine,
    "tanh": _increasing(np.tanh),
    "exp": _increasing(np.exp),
    "log": _increasing(np.log, 0.0),
    "sqrt": _increasing(np.sqrt, 0.0),
    "erf": _increasing(_error_function),
}


def arctangent2(y: Value, x: Value) -> Interval:
    """Enclose atan2(y, x): the angles of the corners, and both ends of the branch where the cut is met."""
    y, x = Interval.of(y), Interval.of(x)
    corners = np.broadcast_arrays(*[np.arctan2(b, a) for a in (x.lo, x.hi) for b in (y.lo, y.hi)])
    lo, hi = np.minimum.reduce(corners), np.maximum.reduce(corners)
    # Off the origin and the cut (x <= 0, y = 0) the angle takes its extremes over a box in the corners.
    cut = (x.lo <= 0.0) & (y.lo <= 0.0) & (y.hi >= 0.0)
    return _bounded(np.where(cut, -np.pi, lo), np.where(cut, np.pi, hi))


def hypotenuse(a: Value, b: Value) -> Interval:
    """Enclose sqrt(a^2 + b^2)."""
    return UNARY["sqrt"](Interval.of(a) ** 2 + Interval.of(b) ** 2)
