"""Minimum and maximum, and the systems R_0^m and R_p made of powers.

Upper sign: conjunction.  Source: Shapiro, Acta Numerica 16 (2007), section 3.

    R_1       min(f, g), max(f, g)
    R_0^m     (f + g -+ sqrt(f^2 + g^2)) (f^2 + g^2)^(m/2)
    R_p       f + g -+ (f^p + g^p)^(1/p),   p even
"""

from __future__ import annotations

from dataclasses import dataclass

from rfm.calculus.functions import guarded_power, maximum, minimum, power
from rfm.calculus.systems.alpha import R0
from rfm.calculus.systems.base import RSystem, monotone
from rfm.calculus.types import Value
from rfm.errors import GeometryError


@dataclass(frozen=True)
class R1(RSystem):
    """Minimum and maximum."""

    def kappa(self, f: Value, g: Value) -> Value:
        """Return (f - g)^2: there is a kink where both are equal."""
        return (f - g) ** 2

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return the minimum or the maximum."""
        return minimum(f, g) if sign < 0 else maximum(f, g)


@dataclass(frozen=True)
class R0m(RSystem):
    """The system R_0^m, m times continuously differentiable; `m` is a positive integer."""

    m: int = 2

    def __post_init__(self) -> None:
        if self.m < 1:
            raise GeometryError(f"R_0^m needs m >= 1, got {self.m}; m = 0 is the system r0")

    @property
    def smoothness(self) -> int:
        """The exponent m."""
        return self.m

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
        return monotone(lambda a, b: a + b + sign * guarded_power(power(a, p) + power(b, p), 1.0 / p), f, g)
