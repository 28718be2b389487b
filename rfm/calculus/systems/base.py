"""What a system of R-functions is: a conjunction and a disjunction that obey De Morgan's law.

Notation: f, g are positive inside and negative outside; the sign -1 stands for the conjunction f ^ g, +1 for
the disjunction f v g = -((-f) ^ (-g)).

Reference: Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), section 3.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import reduce

from rfm.calculus.intervals import Interval
from rfm.calculus.jets import Jet
from rfm.calculus.types import Value


class RSystem(ABC):
    """A sufficiently complete system of R-functions; arguments are values of any kind.

    Attributes
    ----------
    smoothness
        Number of continuous derivatives where the criterion :meth:`kappa` vanishes; elsewhere there are all.
    analytic_across
        Whether a composition goes on smoothly across the boundary of its domain, away from corners.
    """

    @property
    def analytic_across(self) -> bool:
        """Whether the operations are analytic where one argument vanishes and the other does not."""
        return True

    @property
    def smoothness(self) -> int:
        """None by default: the operations are continuous only."""
        return 0

    def kappa(self, f: Value, g: Value) -> Value:
        """Return the criterion of singular points: zero exactly where the operations are not analytic in f, g.

        Where they have a square root of a definite quadratic form, that is where both arguments vanish.
        """
        return f * f + g * g

    @abstractmethod
    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return the conjunction (`sign` = -1) or the disjunction (`sign` = +1) of two values."""

    def join(self, values: Sequence[Value], sign: float) -> Value:
        """Return the conjunction or the disjunction of many values: by pairs from the left.

        Systems with a formula for any number of arguments replace this.
        """
        return reduce(lambda f, g: self.pair(f, g, sign), values)

    def conjunction(self, *args: Value) -> Value:
        """Return f_1 ^ f_2 ^ ..., positive where all are."""
        return self._joined(args, -1.0)

    def disjunction(self, *args: Value) -> Value:
        """Return f_1 v f_2 v ..., positive where one is."""
        return self._joined(args, 1.0)

    def negation(self, f: Value) -> Value:
        """Return -f."""
        return -f

    def at(self, *coords: Value) -> RSystem:
        """Return the system at a point; only systems with coefficients that are fields depend on it."""
        return self

    def _joined(self, args: tuple[Value, ...], sign: float) -> Value:
        if not args:
            raise ValueError("an R-conjunction or R-disjunction needs at least one argument")
        return args[0] if len(args) == 1 else self.join(args, sign)


def monotone(pair: Callable[[Value, Value], Value], f: Value, g: Value) -> Value:
    """Evaluate a function that increases in both arguments; then the bounds of an interval are exact."""
    if isinstance(f, Jet) or isinstance(g, Jet):
        jet = pair(f, g)
        v = f.value if isinstance(f, Jet) else f
        w = g.value if isinstance(g, Jet) else g
        if isinstance(v, Interval) or isinstance(w, Interval):
            return Jet(jet.dim, jet.order, (monotone(pair, v, w), *jet.coefficients[1:]))
        return jet
    if isinstance(f, Interval) or isinstance(g, Interval):
        f, g = Interval.of(f), Interval.of(g)
        # Degenerate intervals, not numbers: their arithmetic keeps account of the rounding.
        low = pair(Interval(f.lo, f.lo), Interval(g.lo, g.lo))
        high = pair(Interval(f.hi, f.hi), Interval(g.hi, g.hi))
        return Interval(low.lo, high.hi)
    return pair(f, g)
