"""Clamped edge: value and normal derivative, u = g and du/dn = q, n outward.

    u = g - w (q + D g) + w^2 psi,    D = grad w . grad,

the generalised Taylor polynomial (7.1) of order one and its remainder (Shapiro, Acta Numerica 16, 2007).
With g = q = 0 it is u = w^2 psi, and any smooth weight will do.
"""

from __future__ import annotations

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.samples import PLATE, first, second
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.operator import Operator, unknown
from structures.taylor import taylor


def clamped(w: Field | FieldExpr, dimension: int, value: Datum = 0.0, slope: Datum = 0.0) -> Operator:
    """Return u with u = g and du/dn = q where w vanishes, n outward.

    Parameters
    ----------
    w
        Normalised to first order.
    dimension
        Number of coordinates.
    value, slope
        g and q.
    """
    w = field(w)
    return taylor(w, [value, -field(slope)], dimension) + w**2 * unknown(dimension)


def examples() -> list[OnBoundary]:
    """An elliptic plate with a hole, both edges clamped."""
    u = clamped(normalised(PLATE, PLATE.part("all"), 1), 2, first, second)
    held = [(PLATE.part(p), t) for p in ("rim", "hole") for t in (traces.value(first), traces.flux(second))]
    return [OnBoundary(PLATE, [u], held)]


ENTRY = Entry(
    name="clamped",
    satisfies="u = g and du/dn = q",
    formula="u = g - w (q + D g) + w^2 psi",
    conditions=("value", "flux"),
    unknowns=1,
    normalisation=1,
    derivatives=0,
    examples=examples,
)
