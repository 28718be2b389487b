r"""Factors that are one at a corner, to some order, and vanish where the functions of the corner are not wanted.

Let B be a weight of the other essential parts of the boundary and t = B/B(corner).  Then

.. math:: \varphi = 1 - (1 - s)^m, \qquad s = t \sqrt{\frac{1 + \kappa}{1 + \kappa t^2}}

vanishes with B and is :math:`1 + O(\varrho^m)` at a distance rho from the corner; kappa keeps s below 2 where t is
large, and there is no pole where t is negative, outside the domain.  It varies on the scale of the domain, so splines
on few cells make up for it.

Where the functions of a corner cannot be continued through the whole domain (round a hole they come back with another
value) there is a window of the length l as well,

.. math:: \varphi = e^{-(\varrho/l)^4} = 1 + O(\varrho^4),

below rounding from 2.5 l on; the cells have to resolve it.  It alone is the factor where other boundary lies on the
line of an edge, where the functions do not vanish.
"""

from __future__ import annotations

from dataclasses import dataclass

from rfm.calculus.functions import exp, sqrt
from rfm.calculus.types import Field, Value

VANISHED = 36.0 ** (1 / 4)
"""Distance, in lengths of the window, from which on it is below rounding."""


@dataclass(frozen=True, eq=False)
class Fading:
    """``1 - (1 - s)^m``, zero where the weight is."""

    weight: Field
    at_corner: float
    saturation: float
    order: int

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        t = self.weight(*coords) * (1.0 / self.at_corner)
        k = self.saturation
        s = t if k == 0.0 else t / sqrt((1.0 + k * (t * t)) * (1.0 / (1.0 + k)))
        return 1.0 - (1.0 - s) ** self.order


@dataclass(frozen=True)
class Window:
    """``exp(-(rho/l)^4)`` around a point."""

    point: tuple[float, ...]
    length: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        total: Value = 0.0
        for x, centre in zip(coords, self.point, strict=True):
            total = total + (x - centre) * (x - centre)
        squared = total * (1.0 / self.length**2)
        return exp(-1.0 * (squared * squared))


def fading(weight: Field, at_corner: float, largest: float, order: int) -> Fading:
    """The factor of a weight whose largest value in the domain is `largest`."""
    t = largest / at_corner
    return Fading(weight, at_corner, (t * t - 4.0) / (3.0 * t * t) if t > 2.0 else 0.0, order)
