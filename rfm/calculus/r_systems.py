r"""R-functions: real functions that do Boolean algebra on signs.

Notation: f, g are values of functions that are positive inside and negative outside; f ^ g (conjunction)
is positive exactly where both are, f v g (disjunction) where one is, -f is the negation. Every system obeys
De Morgan's law f v g = -((-f) ^ (-g)). The upper sign belongs to the conjunction ([1], section 3):

    R_alpha   (f + g -+ sqrt(f^2 + g^2 - 2 alpha f g))/(1 + alpha),   -1 < alpha <= 1
    R_1       min(f, g), max(f, g)                                    (R_alpha with alpha = 1)
    R_0       f + g -+ sqrt(f^2 + g^2)                                (R_alpha with alpha = 0)
    R_0^m     (f + g -+ sqrt(f^2 + g^2)) (f^2 + g^2)^(m/2)
    R_p       f + g -+ (f^p + g^p)^(1/p),   p even

R_0 is analytic except at f = g = 0; R_0^m is m times differentiable there too, and R_p keeps normalisation
to order p - 1.

References: [1] Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), 239-303;
[2] Rvachev, Theory of R-functions and some applications (Naukova Dumka, Kiev 1982, in Russian).
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce

from rfm.calculus.functions import absolute, guarded_power, hypot, maximum, minimum, power, where
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import Jet
from rfm.calculus.types import Value
from rfm.errors import GeometryError


class RSystem(ABC):
    """A sufficiently complete system of R-functions; arguments are values of any kind."""

    @abstractmethod
    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return the conjunction (`sign` = -1) or the disjunction (`sign` = +1) of two values."""

    def conjunction(self, *args: Value) -> Value:
        """Return f_1 ^ f_2 ^ ..., combined from the left; positive where all are."""
        return self._fold(args, -1.0)

    def disjunction(self, *args: Value) -> Value:
        """Return f_1 v f_2 v ..., combined from the left; positive where one is."""
        return self._fold(args, 1.0)

    def negation(self, f: Value) -> Value:
        """Return -f."""
        return -f

    def _fold(self, args: tuple[Value, ...], sign: float) -> Value:
        if not args:
            raise ValueError("an R-conjunction or R-disjunction needs at least one argument")
        return reduce(lambda f, g: self.pair(f, g, sign), args)


def _monotone(pair: Callable[[Value, Value], Value], f: Value, g: Value) -> Value:
    """Evaluate a function that increases in both arguments; then the bounds of an interval are exact."""
    if isinstance(f, Jet) or isinstance(g, Jet):
        jet = pair(f, g)
        v = f.value if isinstance(f, Jet) else f
        w = g.value if isinstance(g, Jet) else g
        if isinstance(v, Interval) or isinstance(w, Interval):
            return Jet(jet.dim, jet.order, (_monotone(pair, v, w), *jet.coefficients[1:]))
        return jet
    if isinstance(f, Interval) or isinstance(g, Interval):
        f, g = Interval.of(f), Interval.of(g)
        # Degenerate intervals, not numbers: their arithmetic keeps account of the rounding.
        low = pair(Interval(f.lo, f.lo), Interval(g.lo, g.lo))
        high = pair(Interval(f.hi, f.hi), Interval(g.hi, g.hi))
        return Interval(low.lo, high.hi)
    return pair(f, g)


@dataclass(frozen=True)
class R1(RSystem):
    """Minimum and maximum."""

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return the minimum or the maximum."""
        return minimum(f, g) if sign < 0 else maximum(f, g)


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
            return _monotone(lambda a, b: a + b + sign * hypot(a, b), f, g)
        # f^2 + g^2 - 2 alpha f g = (f - alpha g)^2 + (1 - alpha^2) g^2, a sum of squares also in rounding.
        scale, root = 1.0 / (1.0 + self.alpha), math.sqrt(1.0 - self.alpha**2)
        return _monotone(lambda a, b: (a + b + sign * hypot(a - self.alpha * b, root * b)) * scale, f, g)


R0 = RAlpha(0.0)


@dataclass(frozen=True)
class R0m(RSystem):
    """The system R_0^m, m times continuously differentiable; `m` is a positive integer."""

    m: int = 2

    def __post_init__(self) -> None:
        if self.m < 1:
            raise GeometryError(f"R_0^m needs m >= 1, got {self.m}; m = 0 is the system r0")

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return (f + g + sign*sqrt(f^2 + g^2)) (f^2 + g^2)^(m/2)."""
        squares = f**2 + g**2
        factor = squares ** (self.m // 2) if self.m % 2 == 0 else guarded_power(squares, 0.5) ** self.m
        return R0.pair(f, g, sign) * factor


@dataclass(frozen=True)
class Rp(RSystem):
    """The system R_p, normalised to order p - 1; `p` is even and positive."""

    p: int = 2

    def __post_init__(self) -> None:
        if self.p < 2 or self.p % 2:
            raise GeometryError(f"R_p needs an even p >= 2, got {self.p}")

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return f + g + sign*(f^p + g^p)^(1/p)."""
        p = self.p
        return _monotone(lambda a, b: a + b + sign * guarded_power(power(a, p) + power(b, p), 1.0 / p), f, g)


def equivalence(a: Value, b: Value, p: int = 2) -> Value:
    """Join two distance functions of pieces of boundary into that of their union, equation (5.3).

    Parameters
    ----------
    a, b
        Values of functions that vanish on one piece each, normalised to order `p`.
    p
        Order to which the normalisation is kept.

    Returns
    -------
    Value
        ``a*b/(|a|^p + |b|^p)^(1/p)``, 0 where both vanish.
    """
    if p < 1:
        raise GeometryError(f"the R-equivalence needs p >= 1, got {p}")
    powers = power(a, p) + power(b, p) if p % 2 == 0 else power(absolute(a), p) + power(absolute(b), p)
    root = guarded_power(powers, 1.0 / p)
    value = root.value if isinstance(root, Jet) else root
    return a * b / where(value == 0.0, 1.0, root)


_PATTERNS: tuple[tuple[str, Callable[[str], RSystem]], ...] = (
    (r"r1", lambda _: R1()),
    (r"r0", lambda _: R0),
    (r"r0m(\d+)", lambda text: R0m(int(text))),
    (r"rp(\d+)", lambda text: Rp(int(text))),
    (r"ralpha([-+.\d]+)", lambda text: RAlpha(float(text))),
)

# The names worth listing to a user; `system` knows the other parameters too.
NAMES: tuple[str, ...] = ("r0", "r1", "rp2", "rp4", "r0m1", "r0m2")


def system(name: str) -> RSystem:
    """Return the R-system with a name: ``r1``, ``r0``, ``r0m2``, ``rp4``, ``ralpha0.5``, ...

    Raises
    ------
    GeometryError
        If there is none; the message lists the names.
    """
    for pattern, build in _PATTERNS:
        match = re.fullmatch(pattern, name.strip().lower())
        if match:
            return build(match.group(1) if match.groups() else "")
    raise GeometryError(f"unknown R-system {name!r}; choose one of {', '.join(NAMES)}")
