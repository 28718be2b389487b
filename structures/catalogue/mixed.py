"""Mixed: u = g where w1 vanishes, k du/dn + h u = q where w2 vanishes.

Shapiro (Acta Numerica 16, 2007), (7.15): the structures of the two parts joined by the weights (7.10).  Two
forms:

*published*, one unknown, u1 = g + w1 psi,

    u = u1 + w1 w2 / (w1 + w2) F,

*general rule*, with what the published form leaves out (a free second normal derivative on part 2) and the
weights' exponents one above the order of what they must not disturb,

    u = u1 + W w2 F + w1 w2^2 psi2,    W = w1^2 / (w1^2 + w2^2),

both with F = (h u1 - q) / k - D u1, D = grad w2 . grad, which is the flux that u1 lacks.  w1 / (w1 + w2) is
one on part 2 and zero on part 1.  The published form contains w2 D psi all over the domain: it is incomplete
and nearly singular (psi close to the kernel of 1 - w2 D).  It is given as it is commonly written with one
unknown; the print of (7.15) in the survey was not at hand to compare.
"""

from __future__ import annotations

from collections.abc import Callable

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.rule import Site, combined
from structures.catalogue.samples import PLATE, SHELL, first, positive, second
from structures.catalogue.scalar_conditions import Flux
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.operator import D, Operator, unknown


def mixed_published(
    w1: Field | FieldExpr,
    w2: Field | FieldExpr,
    dimension: int,
    value: Datum,
    flux: Datum,
    conductivity: Datum = 1.0,
    coefficient: Datum = 0.0,
) -> Operator:
    """Return (7.15) with one unknown.

    Parameters
    ----------
    w1, w2
        Zero on the Dirichlet part, and on the flux part, there normalised to first order.
    dimension
        Number of coordinates.
    value, flux, conductivity, coefficient
        g; q, k and h.
    """
    w1, w2, h, q, k = field(w1), field(w2), field(coefficient), field(flux), field(conductivity)
    psi = unknown(dimension)
    u1 = field(value) + w1 * psi
    return u1 + (w1 * w2 / (w1 + w2)) * ((h * u1 - q) / k - D(w2, u1))


def mixed(
    w1: Field | FieldExpr,
    w2: Field | FieldExpr,
    dimension: int,
    value: Datum,
    flux: Datum,
    conductivity: Datum = 1.0,
    coefficient: Datum = 0.0,
) -> Operator:
    """Return the structure of the general rule with two unknowns; parameters of :func:`mixed_published`."""
    w1, w2 = field(w1), field(w2)
    psi, psi2 = unknown(dimension, 0), unknown(dimension, 1)
    sites = [Site(w1, (), kept=1), Site.of(w2, [Flux(flux, conductivity, coefficient)])]
    (u,) = combined([field(value) + w1 * psi], sites)
    return u + w1 * w2**2 * psi2


def examples() -> list[OnBoundary]:
    """Value on the rim, flux on the hole."""
    return _examples(mixed)


def published_examples() -> list[OnBoundary]:
    """The same for (7.15)."""
    return _examples(mixed_published)


def _examples(build: Callable[..., Operator]) -> list[OnBoundary]:
    rim, hole = PLATE.part("rim"), PLATE.part("hole")
    outer, inner = SHELL.part("outer"), SHELL.part("inner")
    data = first, second, positive, 0.7
    plane = build(normalised(PLATE, rim, 1), normalised(PLATE, hole, 1), 2, *data)
    space = build(normalised(SHELL, outer, 1), normalised(SHELL, inner, 1), 3, *data)
    flux = traces.flux(second, positive, 0.7)
    return [
        OnBoundary(PLATE, [plane], [(rim, traces.value(first)), (hole, flux)]),
        OnBoundary(SHELL, [space], [(outer, traces.value(first)), (inner, flux)]),
    ]


ENTRY = Entry(
    name="mixed",
    satisfies="u = g on part 1, k du/dn + h u = q on part 2",
    formula="u = u1 + W w2 ((h u1 - q)/k - D u1) + w1 w2^2 psi2, u1 = g + w1 psi",
    conditions=("value", "flux"),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
PUBLISHED = Entry(
    name="mixed-published",
    satisfies="u = g on part 1, k du/dn + h u = q on part 2",
    formula="u = u1 + w1 w2/(w1 + w2) ((h u1 - q)/k - D u1), u1 = g + w1 psi (7.15)",
    conditions=("value", "flux"),
    unknowns=1,
    normalisation=1,
    derivatives=1,
    examples=published_examples,
)
