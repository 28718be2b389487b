r"""Trimming (5.1) without a unit of length: what makes a piece out of a carrier.

Notation: f vanishes on the carrier and is normalised there, t is positive on the piece that is kept, l is
the size of the piece.  The trimming of [1] is

    (5.1)   w^2 = f^2 + (sqrt(t^2 + f^4) - t)^2 / 4.

It compares t^2 with f^4, so the function of a shape ten times larger is not ten times larger.  Here f^2 below
the inner root is replaced by ``q = f^2 / sqrt(l^2 + f^2)``, which is a length, of second order in f near
the carrier and of first order far away: w is homogeneous of degree one and stays within a bounded ratio
of the distance everywhere.  Near the piece ``w = |f| (1 + O(f^6))`` as in [1].

Reference: [1] Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), section 5.
"""

from __future__ import annotations

from rfm.calculus.functions import absolute, guarded_power, hypot, sqrt, where
from rfm.calculus.jet import value_of
from rfm.calculus.jets import Jet
from rfm.calculus.types import Array, Value


def ball_function(squared: Value, radius: Array) -> Value:
    """Return ``(R^2 - r^2) / sqrt(2 (R^2 + r^2))``: smooth, normalised on the sphere r = R, of linear growth.

    Parameters
    ----------
    squared
        r^2, the squared distance to the centre.
    radius
        R.
    """
    own = radius * radius
    return (own - squared) / sqrt(2.0 * (squared + own))


def trimmed_carrier(f: Value, t: Value, size: Array) -> Value:
    """Trim a carrier of codimension one; not negative, zero on the piece f = 0, t >= 0 only.

    On jets, w is ``|f|`` times a smooth function where t > 0, so that all derivatives exist on the piece
    too: those of the side where f >= 0.
    """
    squared = f * f
    excess = _excess(squared, t, size)
    if not isinstance(excess, Jet):
        return hypot(f, 0.5 * excess)
    kept = value_of(t) > 0.0
    inner = where(kept, t, size)
    root = sqrt(inner * inner + _quartic(squared, size))
    # the excess over f, as a product that has no difference of nearly equal numbers and no quotient by f
    slope = 0.5 * f * squared / ((squared + size * size) * (root + inner))
    return where(kept, absolute(f) * sqrt(slope * slope + 1.0), hypot(f, 0.5 * excess))


def trimmed_around(squared: Value, t: Value, size: Array) -> Value:
    """Trim a carrier of any codimension that is given by the square of its normalised function."""
    excess = 0.5 * _excess(squared, t, size)
    return guarded_power(squared + excess * excess, 0.5)


def conjunction_on_carrier(a: Value, b: Value, squared: Value, size: Array) -> Value:
    """Conjunction of trimming functions under the condition f = 0: ``a + b - sqrt(a^2 + b^2 + q^2)``.

    On the carrier it is the R_0-conjunction, off it an analytic function: the kink of R_0 where a = b = 0
    is confined to the carrier, since only the values there matter.

    Parameters
    ----------
    a, b
        The functions.
    squared
        f^2.
    size
        l.
    """
    return a + b - guarded_power(a * a + b * b + _quartic(squared, size), 0.5)


def _quartic(squared: Value, size: Array) -> Value:
    """Return q^2."""
    return squared * squared / (squared + size * size)


def _excess(squared: Value, t: Value, size: Array) -> Value:
    """Return ``sqrt(t^2 + q^2) - t``."""
    return guarded_power(t * t + _quartic(squared, size), 0.5) - t
