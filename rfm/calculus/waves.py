r"""Periodic folds of the line: saw-tooth and triangle waves, exact and as Fourier series.

Notation: h is half a cell; the cells are centred at 0, 2h, 4h, ..., and k(x) is the number of the cell of x.

    saw        x - 2 h k(x)                          every cell is a copy of the first; jumps at the walls
    triangle   (-1)^k (x - 2 h k(x))                 every other cell is mirrored; continuous, slope +-1
               = (2 h/pi) asin(sin(pi x/(2 h)))
    series     (8 h/pi^2) sum over i < n of (-1)^i sin((2 i + 1) pi x/(2 h))/(2 i + 1)^2

The series is the Fourier series of the triangle wave, cut off after n terms: analytic, with an error below
2 h/(pi^2 n).  Source: V. Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), section 6
and example 6.1, after Rvachev.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rfm.calculus.functions import namespace, sin
from rfm.calculus.intervals import Interval, round_down, round_up
from rfm.calculus.jets import Jet
from rfm.calculus.types import Value

__all__ = ["cell", "fold_series", "saw", "triangle"]


def cell(x: Value, half: float, last: float = math.inf, first: float = -math.inf) -> Value:
    """Number of the cell in which x lies, cut to `first` and `last`: a constant with respect to derivatives.

    On intervals the hull of the numbers of all cells that are met.
    """
    if isinstance(x, Jet):
        return cell(x.value, half, last, first)
    if isinstance(x, Interval):
        # rounding may put a wall on either side: look a little beyond both ends
        low, high = round_down(x.lo, 4.0), round_up(x.hi, 4.0)
        return Interval(_number(low, half, last, first), _number(high, half, last, first))
    return _number(x, half, last, first)


def saw(x: Value, half: float, last: float = math.inf, first: float = -math.inf) -> Value:
    """Fold x into ``[-half, half]`` by translation; beyond the cells `first` and `last` it goes on with slope 1."""
    number = cell(x, half, last, first)
    if isinstance(number, Interval) and isinstance(x, Interval):
        crossed = number.lo != number.hi
        moved = x - (2.0 * half) * number
        low = np.fmin(-half, x.lo - 2.0 * half * number.lo)
        high = np.fmax(half, x.hi - 2.0 * half * number.hi)
        return Interval(
            np.where(crossed, round_down(low, 4.0), moved.lo),
            np.where(crossed, round_up(high, 4.0), moved.hi),
        )
    return x - (2.0 * half) * number


def triangle(x: Value, half: float, last: float = math.inf, first: float = -math.inf) -> Value:
    """Fold x into ``[-half, half]`` by reflections at the walls of the cells; continuous, slope +1 and -1.

    Beyond the cells `first` and `last` it goes on with the slope it has there.
    """
    number = cell(x, half, last, first)
    if isinstance(number, Interval) and isinstance(x, Interval):
        with np.errstate(invalid="ignore"):  # at infinity the crests decide alone
            return _triangle_bounds(x, number, half)
    direction = 1.0 - 2.0 * (number % 2.0)
    return (x - (2.0 * half) * number) * direction


def fold_series(x: Value, half: float, terms: int) -> Value:
    """Fourier series of the triangle wave, `terms` terms: analytic."""
    rate = 0.5 * math.pi / half
    total: Value = 0.0
    for i in range(terms):
        odd = 2 * i + 1
        total = total + sin(x * (odd * rate)) * ((-1.0) ** i / odd**2)
    return total * (8.0 * half / math.pi**2)


def _number(x: Any, half: float, last: float, first: float) -> Any:
    library = namespace(x)
    return library.clip(library.floor(x / (2.0 * half) + 0.5), first, last)


def _triangle_bounds(x: Interval, number: Interval, half: float) -> Interval:
    """Values at both ends, and the crests of the walls that lie between them."""
    ends = []
    for end, k in ((x.lo, number.lo), (x.hi, number.hi)):
        low, high = round_down(end - 2.0 * half * k, 8.0), round_up(end - 2.0 * half * k, 8.0)
        slack = np.spacing(np.abs(end) + 2.0 * half * np.abs(k)) * 4.0
        even = k % 2.0 == 0.0
        ends.append((np.where(even, low, -high) - slack, np.where(even, high, -low) + slack))
    (a, b), (c, d) = ends
    # the wall between the cells k and k + 1 is a crest for even k, a trough for odd k
    crossed = number.hi - number.lo
    crest = (crossed >= 2.0) | ((crossed == 1.0) & (number.lo % 2.0 == 0.0))
    trough = (crossed >= 2.0) | ((crossed == 1.0) & (number.lo % 2.0 == 1.0))
    lo, hi = np.fmin(a, c), np.fmax(b, d)
    return Interval(np.where(trough, np.fmin(lo, -half), lo), np.where(crest, np.fmax(hi, half), hi))
