r"""The system R_alpha, with alpha a number, a function of the arguments or a field.

.. math:: f \wedge g,\; f \vee g =
          \frac{1}{1 + \alpha}\bigl(f + g \mp \sqrt{f^2 + g^2 - 2 \alpha f g}\bigr), \qquad -1 < \alpha \le 1.

alpha = 1 gives minimum and maximum, alpha = 0 the system R_0.  A function alpha(f, g) has to be symmetric in f
and g.  The disjunction takes alpha(-f, -g), so that De Morgan's law holds for every alpha; where alpha is even,
as Rvachev asks, that is alpha(f, g).  The radicand is computed as a sum of squares,
:math:`(f - \alpha g)^2 + (1 - \alpha^2) g^2`.

References: Shapiro, Acta Numerica 16 (2007), section 3; Rvachev, Theory of R-functions and some applications
(Naukova Dumka, Kiev 1982, in Russian).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from rfm.calculus.functions import guarded_power, hypot
from rfm.calculus.intervals import Interval
from rfm.calculus.jet import value_of
from rfm.calculus.systems.base import RSystem, monotone
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError

PROBES = (-0.8, -0.3, 0.0, 0.2, 1.0, 2.5)
"""Arguments at which the symmetry of a function alpha is checked."""


@dataclass(frozen=True)
class RAlpha(RSystem):
    """The system R_alpha with a constant -1 < alpha < 1; `R0` is alpha = 0, `R1` is alpha = 1."""

    alpha: float = 0.0

    def __post_init__(self) -> None:
        if not -1.0 < self.alpha < 1.0:
            raise GeometryError(f"R_alpha needs -1 < alpha < 1, got {self.alpha}; alpha = 1 is the system r1")

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return (f + g + sign*sqrt(f^2 + g^2 - 2 alpha f g))/(1 + alpha)."""
        if self.alpha == 0.0:
            return monotone(lambda a, b: a + b + sign * hypot(a, b), f, g)
        scale, root = 1.0 / (1.0 + self.alpha), math.sqrt(1.0 - self.alpha**2)
        return monotone(lambda a, b: (a + b + sign * hypot(a - self.alpha * b, root * b)) * scale, f, g)


R0 = RAlpha(0.0)


@dataclass(frozen=True)
class RAlphaOf(RSystem):
    """The system R_alpha whose alpha is a symmetric function of the two arguments.

    Parameters
    ----------
    alpha
        Called as ``alpha(f, g)`` with values of any kind, returns a value in (-1, 1].

    Raises
    ------
    GeometryError
        At construction where alpha is not symmetric or not above -1, at evaluation where a value is not in (-1, 1].
    """

    alpha: Callable[[Value, Value], Value]

    def __post_init__(self) -> None:
        for f, g in combinations(PROBES, 2):
            one, other = (float(_checked(self.alpha(*pair))) for pair in ((f, g), (g, f)))
            if not math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-12):
                raise GeometryError(
                    f"alpha of R_alpha must be symmetric, but alpha({f}, {g}) = {one:g} "
                    f"and alpha({g}, {f}) = {other:g}"
                )

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return R_alpha with the alpha of the values; the disjunction by De Morgan's law."""
        alpha = self.alpha(f, g) if sign < 0 else self.alpha(-f, -g)
        return combined(f, g, alpha, sign)


@dataclass(frozen=True)
class RAlphaField(RSystem):
    """The system R_alpha whose alpha is a field of the coordinates; ``at(*coords)`` gives it at a point."""

    alpha: Field

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Refuse: values alone do not say where they are taken."""
        raise GeometryError("this R_alpha depends on the coordinates: combine values by system.at(x, y)")

    def at(self, *coords: Value) -> RSystem:
        """Return the system with the alpha of the coordinates."""
        return _Fixed(_checked(self.alpha(*coords)))


@dataclass(frozen=True, eq=False)
class _Fixed(RSystem):
    """The system R_alpha with an alpha that is a value: an array, a jet, ..."""

    alpha: Value

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return R_alpha of the values."""
        return combined(f, g, self.alpha, sign)


def combined(f: Value, g: Value, alpha: Value, sign: float) -> Value:
    """Return (f + g + sign*sqrt(f^2 + g^2 - 2 alpha f g))/(1 + alpha), alpha a value of any kind.

    Raises
    ------
    GeometryError
        Where alpha is not in (-1, 1].
    """
    alpha = _checked(alpha)
    first = f - alpha * g
    radicand = first * first + (1.0 - alpha * alpha) * (g * g)
    return (f + g + sign * guarded_power(radicand, 0.5)) / (1.0 + alpha)


def _checked(alpha: Value) -> Value:
    """Return alpha; an interval is refused only if it lies outside as a whole."""
    value = value_of(alpha)
    if isinstance(value, Interval):
        bad, shown = _outside(value.hi, value.lo), value.lo
    elif isinstance(value, (int, float, np.ndarray, np.generic)):
        bad, shown = _outside(value, value), value
    else:
        return alpha  # a traced array has no values to look at
    if np.any(bad):
        worst = float(np.broadcast_to(shown, np.shape(bad))[bad].flat[0])
        raise GeometryError(f"R_alpha needs -1 < alpha <= 1, got alpha = {worst:g}")
    return alpha


def _outside(high: Any, low: Any) -> Any:
    return np.logical_not((np.asarray(high) > -1.0) & (np.asarray(low) <= 1.0))
