r"""Conditions of any order that hold exactly for every psi, corrected in a collar of a few cells only.

The published structures for a flux condition (Shapiro, Acta Numerica 16, 2007, (7.13) and (7.15)) contain
``w D(psi)`` over the whole domain; they lose an order and have functions that they nearly annihilate.  Here the
correction lives in a *collar* along the part.  Let ua satisfy the values (and slopes) that are prescribed, and u'_m be
ua changed by the general rule (:mod:`structures.catalogue.rule`) so that all other conditions of the part m hold, K_m
the highest order among them.  Then

    u = ua + sum_m [ X_m (u'_m - ua) + w_m^(K_m + 1) X_m psi_m ],
    X_m = chi(w_m / l) prod_{j != m} w_j^e_j / (w_j^e_j + w_m^e_j),      chi(t) = exp(-t^4)

satisfies all conditions at once: u'_m - ua is of the order w_m on its part, where X_m = 1 + O(w_m^2), and X_m
vanishes on every other part to the order e_j that leaves its conditions alone: 2 for values, slopes and fluxes, 4 for a
bending moment or a shear force.  With one flux a part, L(u) = phi scaled so that L(w v) = v, this is

    u = ua + sum_m [ w_m X_m (phi_m - L_m(ua)) + w_m^2 X_m psi_m ].

The psi_m make up for whatever extension the data have away from their part; they need not be of the degree of psi, as
w^(K+1) is of the size h^(K+1).  chi is smooth because everything has to be integrated: a cutoff with a kink costs three
digits.  Of exp(-t^2) and exp(-t^4), the latter has the shorter tail: fewer cells, fewer psi_m that the other
splines nearly represent (docs/structures.md).

Parts that meet need no order: where w_j = w_m = 0 the window X has no limit, but what it multiplies is
as small there as the error of psi, and ``w^k X`` has bounded derivatives of order k.  Only quadrature has to see the
corner.

Notation: w, phi, psi as in the paper; X, chi, l, K as above; e_j is the exponent ``even(kept)`` of a part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

from rfm.calculus.functions import exp
from rfm.calculus.types import Value
from structures.catalogue.rule import Site, changes
from structures.field_expression import Arithmetic, FieldExpr
from structures.layers import layer
from structures.operator import Operator, unknown

COMMON_ZERO = 1e-60
"""Added to ``w_j^e + w_m^e``: only a common zero of both feels it."""

Spared = tuple[FieldExpr, int]
"""A function normalised on another part, and the order to which a window has to vanish there."""


@dataclass(frozen=True)
class Bell:
    """``exp(-(t / length)^4)``."""

    length: float

    def __call__(self, t: Value) -> Value:
        """Value at t of any kind."""
        scaled = t * (1.0 / self.length)
        square = scaled * scaled
        return exp(-(square * square))


def window(
    w: FieldExpr, length: float, others: Sequence[Spared] = (), own: FieldExpr | None = None
) -> FieldExpr:
    """Return X: one on the part, falling off over `length`, zero to a given order where one of the `others` is zero.

    Parameters
    ----------
    w, length
        The function whose level sets the collar follows, and the length over which it ends.
    others
        Functions normalised on the other parts, each with an even order.
    own
        Zero on the part only, where that is a piece of w = 0; w itself by default.
    """
    result: FieldExpr = Arithmetic(Bell(length), (w,))
    for other, order in others:
        vanishing = other**order
        result = result * (vanishing / (vanishing + (w if own is None else own) ** order + COMMON_ZERO))
    return result


def localized(
    essential: Sequence[Operator], sites: Sequence[Site], windows: Sequence[FieldExpr]
) -> tuple[Operator, ...]:
    """Return the structure of the module's docstring, one operator for each component.

    The psi_m take the indices after those of `essential`: one for each of the components :func:`supplemented` of the
    first site, then of the second, and so on.

    Parameters
    ----------
    essential
        ua, one operator a component, which satisfy the essential conditions for every psi.
    sites, windows
        The parts with the other conditions, of order one or more, and their X, see :func:`window`.
    """
    number = 1 + max((psi for u in essential for psi in u.unknowns), default=-1)
    result = list(essential)
    for site, near in zip(sites, windows, strict=True):
        found = changes([layer(site.w, [u]) for u in essential], site.conditions, site.held)
        powers = [site.w**k * near for k in range(site.order + 2)]
        for c, change in enumerate(found):
            for k, level in enumerate(change.levels[1:], 1):
                result[c] = result[c] + (powers[k] * (1.0 / factorial(k))) * level
        for c in supplemented(site):
            result[c] = result[c] + powers[-1] * unknown(result[c].dimension, number)
            number += 1
    return tuple(result)


def supplemented(site: Site) -> tuple[int, ...]:
    """Components of u that get a psi_m: those of which the conditions determine a derivative."""
    determined = {c for condition in site.conditions for _, c in condition.rows}
    if min(determined) < 0:  # a normal or tangential part, in no fixed direction
        return tuple(range(site.conditions[0].components))
    return tuple(sorted(determined))
