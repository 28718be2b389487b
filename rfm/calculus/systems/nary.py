r"""R-functions of any number of arguments, without folding pairs.

**Associative p-norms.** With the parts :math:`f^+ = \max(f, 0)`, :math:`f^- = \max(-f, 0)`

.. math:: f_1 \wedge \dots \wedge f_n =
          \begin{cases} \bigl(\sum f_i^{-p}\bigr)^{-1/p} & \text{if all } f_i > 0, \\
                        -\bigl(\sum (f_i^-)^p\bigr)^{1/p} & \text{otherwise.} \end{cases}

The upper line is the R_p-equivalence, equation (5.3) of [1], of n arguments; it is continued by the p-norm of what
is negative.  Both lines are associative, and so is their union (which R_p itself is not for n > 2); the value does
not depend on the order.  Where one argument vanishes and the others are positive it equals that argument up to
order p + 1, so normalisation is kept to order p.  It is p times differentiable there, p - 1 times where the others
are negative, and continuous where two vanish.

**Rvachev's sums of powers** of n arguments ([1], section 3; [2]) are m times continuously differentiable everywhere:

.. math:: f_1 \wedge \dots \wedge f_n = \sum_i (-1)^m f_i^m (f_i - |f_i|) + \prod_i f_i^m (f_i + |f_i|).

They vanish to order m + 1 on the boundary: for deciding signs, not for weights.

References: [1] Shapiro, Acta Numerica 16 (2007), 239-303; [2] Rvachev, Theory of R-functions and some applications
(Naukova Dumka, Kiev 1982, in Russian).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

from rfm.calculus.functions import guarded_power, maximum, minimum, power, where
from rfm.calculus.intervals import Interval
from rfm.calculus.jet import value_of
from rfm.calculus.systems.base import RSystem, monotone
from rfm.calculus.systems.conditional import equivalence
from rfm.calculus.types import Value
from rfm.errors import GeometryError


@dataclass(frozen=True)
class RNorm(RSystem):
    """The associative system of p-norms; `p` is a positive integer, odd ones too."""

    p: int = 2

    def __post_init__(self) -> None:
        if self.p < 1:
            raise GeometryError(f"the system of p-norms needs p >= 1, got {self.p}")

    @property
    def analytic_across(self) -> bool:
        """The pieces meet where one argument changes sign."""
        return False

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return the conjunction, or its mirror image."""
        return monotone(self._conjunction, f, g) if sign < 0 else -monotone(self._conjunction, -f, -g)

    def _conjunction(self, f: Value, g: Value) -> Value:
        p, least = self.p, value_of(minimum(f, g))
        # Where one vanishes, inside: its slope is there.  Of intervals both lines have the bound 0, outside is tight.
        both = least > 0.0 if isinstance(least, Interval) else least >= 0.0
        inside = equivalence(f, g, p)
        outside = guarded_power(power(maximum(-f, 0.0), p) + power(maximum(-g, 0.0), p), 1.0 / p)
        return where(both, inside, -outside)


@dataclass(frozen=True)
class RSum(RSystem):
    """Rvachev's n-ary sums of powers, `m` times continuously differentiable; m >= 1."""

    m: int = 1

    def __post_init__(self) -> None:
        if self.m < 1:
            raise GeometryError(f"the n-ary sums of powers need m >= 1, got {self.m}")

    @property
    def smoothness(self) -> int:
        """The exponent m."""
        return self.m

    def kappa(self, f: Value, g: Value) -> Value:
        """Return (f g)^2: the pieces meet where one argument changes sign."""
        return (f * g) ** 2

    @property
    def analytic_across(self) -> bool:
        """The pieces meet where one argument changes sign."""
        return False

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return the formula for two arguments."""
        return self.join((f, g), sign)

    def join(self, values: Sequence[Value], sign: float) -> Value:
        """Return the formula for all arguments at once."""
        # f - |f| = -2 f^- and f + |f| = 2 f^+, so that all powers are of non-negative numbers.
        terms = [-value if sign > 0 else value for value in values]
        power_of = self.m + 1
        outside = reduce(lambda a, b: a + b, [power(maximum(-f, 0.0), power_of) for f in terms])
        inside = reduce(lambda a, b: a * b, [2.0 * power(maximum(f, 0.0), power_of) for f in terms])
        result = inside - 2.0 * outside
        return -result if sign > 0 else result
