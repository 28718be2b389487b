"""The general rule: from any field to one that satisfies the conditions of a part.

For B u = phi of order k with principal symbol sigma (:mod:`structures.catalogue.condition`)

    u' = u + w^k / k! F,    sigma F = phi - B u  on w = 0,

has B u' = phi there, and the derivatives of u' below order k are those of u.  Several conditions on one part
are applied in ascending order, so that later ones do not disturb earlier ones.  (7.13) of Shapiro (Acta
Numerica 16, 2007) is the case B = D: u' = psi + w (phi - D psi).

Where u = g + W psi with W vanishing to order e on the part (its value is held there, e = 1), the boundary value of
B u has no derivative of psi above order k - e: those are multiplied with W.  A part says so (:attr:`Site.held`), and
the formulas leave them out: the edge of a simply supported plate needs first derivatives of psi, not second ones.

Parts that meet, or come near each other, share the corrections by the weights (7.10)

    u' = u + sum_i W_i (u'_i - u),

W_i = 1 on part i and zero to order mu_j on part j.  mu_j above the order of the conditions of part j leaves
them alone. W_i has no limit at a corner where parts meet.  ``successive`` first applies the plain corrections
one after the other, which is all there is to do at right angles with compatible data; then the weights only
multiply what is left, which is small near the corner.

Notation: N = grad w, u'_i the field corrected for part i alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from structures.catalogue.condition import Condition
from structures.field_expression import FieldExpr
from structures.layers import Layers, layer
from structures.operator import Operator, known, unknown
from structures.transfinite import weights


@dataclass(frozen=True, eq=False)
class Site:
    """A part with its conditions.

    Attributes
    ----------
    w
        Zero on the part with unit inward slope, positive elsewhere in the domain.
    conditions
        What holds there; none: values that are already right and must be kept.
    kept
        Derivatives of the field below this order must not be changed by other parts.
    held
        The order e to which the share ``W psi`` of an unknown vanishes on the part, by unknown; those not mentioned
        may have any share.
    """

    w: FieldExpr
    conditions: tuple[Condition, ...]
    kept: int
    held: Mapping[int, int] = field(default_factory=dict)

    @classmethod
    def of(cls, w: FieldExpr, conditions: Sequence[Condition], held: Mapping[int, int] | None = None) -> Site:
        """Return a part whose conditions are to be satisfied."""
        ordered = tuple(sorted(conditions, key=lambda condition: condition.order))
        return cls(w, ordered, max(condition.order for condition in ordered) + 1, held or {})

    @property
    def order(self) -> int:
        """Highest order of its conditions."""
        return max(condition.order for condition in self.conditions)


def changes(
    u: Sequence[Layers], conditions: Sequence[Condition], held: Mapping[int, int] | None = None
) -> list[Layers]:
    """Return what has to be added to u so that all conditions hold on the part, in ascending order of the conditions.

    Parameters
    ----------
    u
        The components of the field, in levels of the part's w.
    conditions
        What shall hold.
    held
        See :class:`Site`.
    """
    found = [layer(component.w, [known(component.dimension, 0.0)]) for component in u]
    for condition in sorted(conditions, key=lambda c: c.order):
        residual = [
            phi - b for phi, b in zip(condition.values, _applied(condition, u, found, held), strict=True)
        ]
        pairs = zip(found, condition.solved(residual, u[0].w), strict=True)
        found = [component.raised(condition.order, change) for component, change in pairs]
    return found


def _applied(
    condition: Condition, u: Sequence[Layers], change: Sequence[Layers], held: Mapping[int, int] | None
) -> list[Operator]:
    """Return B(u + change) on the part, without the derivatives of unknowns whose coefficients in B u vanish there."""
    if not held:
        return condition.applied([a + b for a, b in zip(u, change, strict=True)])
    left = []
    for b, more in zip(condition.applied(u), condition.applied(change), strict=True):
        kept = (
            term
            for term in b.terms
            if term.psi not in held or sum(term.alpha) <= condition.order - held[term.psi]
        )
        left.append(Operator(b.dimension, b.offset, tuple(kept)) + more)
    return left


def levels(
    u: Sequence[Layers], conditions: Sequence[Condition], held: Mapping[int, int] | None = None
) -> list[Layers]:
    """Return u with its levels changed so that all conditions hold on the part; see :func:`changes`."""
    return [a + b for a, b in zip(u, changes(u, conditions, held), strict=True)]


def corrected(u: Sequence[Operator], site: Site) -> list[Operator]:
    """Return u' that satisfies the conditions of one part."""
    return [found.total() for found in levels([layer(site.w, [c]) for c in u], site.conditions, site.held)]


def completed(u: Sequence[Layers], conditions: Sequence[Condition]) -> list[Operator]:
    """Return u' that satisfies conditions of order K or less, and what they leave open, ``u' + w^(K+1) psi'``.

    Parameters
    ----------
    u
        The components, in levels of the part's w; their unknowns are counted from zero.
    conditions
        What shall hold.
    """
    found = [change.total() for change in levels(u, conditions)]
    number = 1 + max(psi for component in u for level in component.levels for psi in level.unknowns)
    rest = u[0].w ** (1 + max(condition.order for condition in conditions))
    return [c + rest * unknown(c.dimension, number + i) for i, c in enumerate(found)]


def combined(u: Sequence[Operator], sites: Sequence[Site], successive: bool = False) -> list[Operator]:
    """Return u' that satisfies the conditions of all parts.

    Parameters
    ----------
    u
        Components; they satisfy the conditions of the sites without any.
    sites
        The parts.
    successive
        Apply the corrections one after the other before the weights take care of the rest; each adds
        the order of its conditions to the highest derivative of psi.
    """
    active = [site for site in sites if site.conditions]
    if len(sites) == 1:
        return corrected(u, sites[0]) if active else list(u)
    if successive:
        for site in active:
            u = corrected(u, site)
    shares = weights([site.w for site in sites], [even(site.kept) for site in sites])
    result = list(u)
    for site, share in zip(sites, shares, strict=True):
        if site.conditions:
            changed = corrected(u, site)
            result = [total + share * (new - old) for total, new, old in zip(result, changed, u, strict=True)]
    return result


def even(order: int) -> int:
    """Return the next even exponent: weights without poles beyond a common corner."""
    return 2 * ((order + 1) // 2)
