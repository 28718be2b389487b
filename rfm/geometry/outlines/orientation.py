"""Which way three points turn, exactly.

Notation: ``turn(p, q, r)`` is the sign of ``(q - p) x (r - p)``, positive when r lies to the left of the line
from p to q.  Where rounding could change the sign it is found in rational arithmetic (the filter of
J. R. Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, Discrete
Comput. Geom. 18 (1997), 305-363).
"""

from __future__ import annotations

import sys
from fractions import Fraction

from rfm.calculus.types import Array

_FILTER = 8.0 * sys.float_info.epsilon


def turn(p: Array, q: Array, r: Array) -> int:
    """Exact sign (-1, 0, 1) of the turn at points ``(2,)``."""
    (px, py), (qx, qy), (rx, ry) = (point.tolist() for point in (p, q, r))
    first, second = (qx - px) * (ry - py), (qy - py) * (rx - px)
    if abs(first - second) > _FILTER * (abs(first) + abs(second)):
        return 1 if first > second else -1
    px, py, qx, qy, rx, ry = (Fraction(value) for value in (px, py, qx, qy, rx, ry))
    exact = (qx - px) * (ry - py) - (qy - py) * (rx - px)
    return (exact > 0) - (exact < 0)
