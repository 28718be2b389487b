r"""Interval arithmetic: guaranteed bounds of a formula over boxes.

Notation: [lo, hi] with lo <= hi; for every formula F built from these operations,
{F(x) : x in X} is contained in F(X) (inclusion isotonicity). Bounds are arrays, one entry for each box.
Results are rounded outward by more than the rounding error of the operation: the bound is moved by 2^-52
of itself, twice the largest error of a correctly rounded operation; functions move it further (`enclosures`).
Where a formula is undefined on a whole box the answer is the whole line, "nothing is known".

Reference: Moore, Kearfott, Cloud, Introduction to Interval Analysis (SIAM 2009), chapters 2, 4 and 5.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rfm.calculus.taylor import repeated_product
from rfm.calculus.tri_state import TriState
from rfm.calculus.types import Value

EPSILON = 2.0**-52
# Not the smallest denormal: arithmetic on denormals is a hundred times slower than on other numbers.
TINY = 1e-300


def round_down(x: Any, ulps: float = 1.0) -> Any:
    """Move a computed bound down by `ulps` * 2^-52 of itself."""
    return x - (np.abs(x) * (ulps * EPSILON) + TINY)


def round_up(x: Any, ulps: float = 1.0) -> Any:
    """Move a computed bound up by `ulps` * 2^-52 of itself."""
    return x + (np.abs(x) * (ulps * EPSILON) + TINY)


class Interval:
    """Closed intervals [lo, hi], one for each entry of the arrays `lo` and `hi`.

    Parameters
    ----------
    lo, hi
        Bounds, numbers or arrays with ``lo <= hi``; infinite bounds are allowed.

    Notes
    -----
    Numbers and arrays are exact points. ``x * x`` with the same object is the tight square. Comparisons
    give a `TriState`.
    """

    __slots__ = ("hi", "lo")
    __array_ufunc__ = None  # so that array * interval reaches Interval.__rmul__
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, lo: Any, hi: Any) -> None:
        self.lo = lo
        self.hi = hi

    @staticmethod
    def of(x: Value) -> Interval:
        """Take a number or an array for an interval without width."""
        return x if isinstance(x, Interval) else Interval(x, x)

    @staticmethod
    def whole(like: Any) -> Interval:
        """Return the whole line, in the shape of the array `like`."""
        bound = np.full(np.shape(like), np.inf)
        return Interval(-bound, bound)

    @property
    def width(self) -> Any:
        """Length of the interval."""
        return self.hi - self.lo

    @property
    def middle(self) -> Any:
        """Midpoint of the interval."""
        return self.lo + 0.5 * (self.hi - self.lo)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the arrays of bounds."""
        return np.broadcast_shapes(np.shape(self.lo), np.shape(self.hi))

    def contains(self, x: Any) -> Any:
        """Tell where the points `x` lie in the intervals."""
        return (self.lo <= x) & (x <= self.hi)

    def hull(self, other: Value) -> Interval:
        """Return the smallest intervals that contain both."""
        other = Interval.of(other)
        return Interval(np.minimum(self.lo, other.lo), np.maximum(self.hi, other.hi))

    def __repr__(self) -> str:
        return f"Interval({self.lo!r}, {self.hi!r})"

    def __add__(self, other: Value) -> Interval:
        if isinstance(other, Interval):
            return Interval(round_down(self.lo + other.lo), round_up(self.hi + other.hi))
        if not _is_point(other):
            return NotImplemented
        return Interval(round_down(self.lo + other), round_up(self.hi + other))

    __radd__ = __add__

    def __sub__(self, other: Value) -> Interval:
        if isinstance(other, Interval):
            return Interval(round_down(self.lo - other.hi), round_up(self.hi - other.lo))
        if not _is_point(other):
            return NotImplemented
        return Interval(round_down(self.lo - other), round_up(self.hi - other))

    def __rsub__(self, other: Value) -> Interval:
        if not _is_point(other):
            return NotImplemented
        return Interval(round_down(other - self.hi), round_up(other - self.lo))

    def __neg__(self) -> Interval:
        return Interval(-self.hi, -self.lo)

    def __pos__(self) -> Interval:
        return self

    def __mul__(self, other: Value) -> Interval:
        if other is self:
            squared: Interval = _integer_power(self, 2)
            return squared
        if isinstance(other, Interval):
            with np.errstate(invalid="ignore", over="ignore"):
                corners = (self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi)
                lo = np.fmin(np.fmin(corners[0], corners[1]), np.fmin(corners[2], corners[3]))
                hi = np.fmax(np.fmax(corners[0], corners[1]), np.fmax(corners[2], corners[3]))
                return _outward(lo, hi)
        if not _is_point(other):
            return NotImplemented
        with np.errstate(invalid="ignore", over="ignore"):
            a, b = self.lo * other, self.hi * other
            if isinstance(other, int | float):
                return _outward(a, b) if other >= 0 else _outward(b, a)
            return _outward(np.fmin(a, b), np.fmax(a, b))

    __rmul__ = __mul__

    def __truediv__(self, other: Value) -> Interval:
        if isinstance(other, int | float) and other != 0.0:
            a, b = self.lo / other, self.hi / other
            return _outward(a, b) if other > 0.0 else _outward(b, a)
        if not isinstance(other, Interval) and not _is_point(other):
            return NotImplemented
        return self * Interval.of(other)._reciprocal()

    def __rtruediv__(self, other: Value) -> Interval:
        if not _is_point(other):
            return NotImplemented
        return Interval.of(other) * self._reciprocal()

    def _reciprocal(self) -> Interval:
        """Return 1/x, the whole line where the interval contains 0."""
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            lo, hi = round_down(np.divide(1.0, self.hi)), round_up(np.divide(1.0, self.lo))
        if np.any(bad := np.logical_not((self.lo > 0.0) | (self.hi < 0.0))):
            lo, hi = np.where(bad, -np.inf, lo), np.where(bad, np.inf, hi)
        return Interval(lo, hi)

    def __pow__(self, exponent: Value) -> Interval:
        if not isinstance(exponent, Interval) and not _is_point(exponent):
            return NotImplemented
        if not isinstance(exponent, int | float | np.number):
            from rfm.calculus.functions import exp, log

            result: Interval = exp(log(self) * exponent)
            return result
        if float(exponent).is_integer():
            n = int(exponent)
            return _integer_power(self, n) if n >= 0 else _integer_power(self, -n)._reciprocal()
        return _real_power(self, float(exponent))

    def __rpow__(self, base: Value) -> Interval:
        from rfm.calculus.functions import exp, log

        result: Interval = exp(self * log(base))
        return result

    def __abs__(self) -> Interval:
        return Interval(_mignitude(self), np.maximum(np.abs(self.lo), np.abs(self.hi)))

    # A comparison that involves a nan is undecided: `possible` is the negation of the opposite.

    def __lt__(self, other: Value) -> TriState:
        other = Interval.of(other)
        return TriState(self.hi < other.lo, np.logical_not(self.lo >= other.hi))

    def __le__(self, other: Value) -> TriState:
        other = Interval.of(other)
        return TriState(self.hi <= other.lo, np.logical_not(self.lo > other.hi))

    def __gt__(self, other: Value) -> TriState:
        other = Interval.of(other)
        return TriState(self.lo > other.hi, np.logical_not(self.hi <= other.lo))

    def __ge__(self, other: Value) -> TriState:
        other = Interval.of(other)
        return TriState(self.lo >= other.hi, np.logical_not(self.hi < other.lo))

    def __eq__(self, other: object) -> TriState:  # type: ignore[override]
        return (self <= other) & (self >= other)

    def __ne__(self, other: object) -> TriState:  # type: ignore[override]
        return ~(self == other)


def _is_point(x: Value) -> bool:
    return isinstance(x, int | float | np.ndarray | np.generic)


def _outward(lo: Any, hi: Any, ulps: float = 1.0) -> Interval:
    """Round outward; a nan (0 * inf, inf - inf) says that nothing is known."""
    lo, hi = round_down(lo, ulps), round_up(hi, ulps)
    if np.isnan(np.sum(lo)) or np.isnan(np.sum(hi)):
        bad = np.isnan(lo) | np.isnan(hi)
        lo, hi = np.where(bad, -np.inf, lo), np.where(bad, np.inf, hi)
    return Interval(lo, hi)


def _mignitude(x: Interval) -> Any:
    """Return the smallest absolute value in the interval."""
    return np.maximum(np.maximum(x.lo, -x.hi), 0.0)


def _integer_power(x: Interval, n: int) -> Interval:
    """x**n, n >= 0, tight: even powers have their minimum at the point nearest 0."""
    if n == 0:
        return Interval(np.ones(np.shape(x.lo)), np.ones(np.shape(x.hi)))
    if n == 1:
        return x
    with np.errstate(over="ignore", under="ignore"):
        if n % 2:
            return _outward(repeated_product(x.lo, n), repeated_product(x.hi, n), ulps=n)
        top = repeated_product(np.maximum(np.abs(x.lo), np.abs(x.hi)), n)
        bottom = repeated_product(_mignitude(x), n)
    result = _outward(bottom, top, ulps=n)
    return Interval(np.maximum(result.lo, 0.0), result.hi)


def _real_power(x: Interval, exponent: float) -> Interval:
    """x**r on the part of the interval with x >= 0; nothing is known where that is empty."""
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        a, b = np.maximum(x.lo, 0.0) ** exponent, np.where(x.hi < 0.0, np.nan, x.hi) ** exponent
    result = _outward(a, b, ulps=4) if exponent > 0.0 else _outward(b, a, ulps=4)
    return Interval(np.where(np.isneginf(result.lo), result.lo, np.maximum(result.lo, 0.0)), result.hi)
