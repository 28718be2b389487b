r"""Normalisation: unit normal slope and vanishing higher normal derivatives on the zero set.

Notation: w is *normalised to order m* when ``w = 0``, ``dw/dn = 1`` and ``d^k w/dn^k = 0`` for k = 2..m on the
boundary, n the inward unit normal (along a straight line).  Source: Shapiro, Acta Numerica 16 (2007), section 4:

    (4.9)    w1 = f / sqrt(f^2 + |grad f|^2)
    (4.10)   wm = w(m-1) - (1/m!) w1^m D_m w(m-1),    D_m = (grad w1 . d/dx)^m with grad w1 held fixed

Away from the boundary (4.10) as published neither keeps the sign of f nor stays bounded (grad w1 is not a unit
vector there, and w1^m D_m may be anything), so that the zero set grows.  With ``rho = w1^(m-1) D_m w(m-1) / m!`` the
step used here is

    wm = w(m-1) - w1 rho / (1 + (rho/b)^4)^(1/4),    b = 2^(1-m)

It differs from (4.10) by ``O(w1^(5m-4))``, far less than the order of the step, and ``|wm - w(m-1)| < b |w1|`` leaves
``wm / w1`` between 0 and 2 everywhere.

One evaluation of a step expands the step below once, as a jet of higher order, which yields the value and all
derivatives that D_m needs; orders up to four cost microseconds a point.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from math import factorial, inf, prod

import numpy as np

from rfm.calculus.functions import sqrt
from rfm.calculus.jets import derivatives, multi_indices, variables
from rfm.calculus.r_systems import RSystem
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError

_HIGHEST = 16
_AGAINST = (0.37, 0.9)


def normalise(field: Field, dim: int, order: int = 1) -> Field:
    """Normalise a function whose gradient does not vanish on its zero set: (4.9), then (4.10).

    Parameters
    ----------
    field
        Smooth; ``order`` derivatives across the zero set are needed.
    dim
        Number of coordinates.
    order
        How many normal derivatives are prescribed.

    Raises
    ------
    GeometryError
        When the order is not at least 1.
    """
    _check(order)
    return raised(Slope(field), dim, order)


def raised(first: Field, dim: int, order: int) -> Field:
    """Raise a function that is normalised to order 1 already, by (4.10) alone.

    Dividing it by its gradient again, as (4.9) does, would harm it wherever that gradient is not one.
    """
    _check(order)
    return reduce(lambda below, degree: Step(below, first, dim, degree), range(2, order + 1), first)


def kept_order(system: RSystem) -> float:
    """Return the order to which R-functions of a system keep normalisation (Theorem 4).

    At a regular point of the boundary one argument t vanishes, the other one is g > 0.  The conjunction is
    then ``t + c_2 t^2 + ...``; the order is that of the last vanishing c, infinite when all vanish (r1), and 0
    when the slope is not one.  Measured by a jet in t.
    """
    return min(_kept(system, g) for g in _AGAINST)


@dataclass(frozen=True, eq=False)
class Slope:
    """Equation (4.9)."""

    field: Field

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value, *slopes = derivatives(self.field, coords, 1)
        return value / sqrt(reduce(lambda total, slope: total + slope * slope, slopes, value * value))


@dataclass(frozen=True, eq=False)
class Step:
    """One step of (4.10), limited so that the sign stays; m = ``degree``."""

    below: Field
    first: Field
    dim: int
    degree: int

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        first, *slopes = derivatives(self.first, coords, 1)
        expansion = derivatives(self.below, coords, self.degree)
        total: Value = 0.0
        for alpha, partial in zip(multi_indices(self.dim, self.degree), expansion, strict=True):
            if sum(alpha) == self.degree:
                powers = [slope**power for slope, power in zip(slopes, alpha, strict=True) if power]
                total = total + partial * (prod(powers) * (1.0 / prod(map(factorial, alpha))))
        rho = first ** (self.degree - 1) * total
        limited = rho / sqrt(sqrt(1.0 + (rho * 2.0 ** (self.degree - 1)) ** 4))
        return expansion[0] - first * limited


def _check(order: int) -> None:
    if order < 1:
        raise GeometryError(f"order of normalisation must be at least 1, got {order}")


def _kept(system: RSystem, g: float) -> float:
    (t,) = variables((np.zeros(1),), _HIGHEST)
    found = [float(np.asarray(c).item()) for c in system.conjunction(t, np.full(1, g)).coefficients]
    if abs(found[1] - 1.0) > 1e-9:
        return 0
    return next((k - 1 for k, c in enumerate(found) if k > 1 and abs(c) > 1e-9), inf)
