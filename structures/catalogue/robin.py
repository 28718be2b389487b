"""Robin: k du/dn + h u = g, n outward.

    u = psi - w D psi + w (h psi - g) / k + w^2 psi2,    D = grad w . grad.

On w = 0: u = psi, du/dn = -D u = -(h psi - g) / k.  Shapiro (Acta Numerica 16, 2007), section 7.
"""

from __future__ import annotations

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.samples import PLATE, SHELL, first, positive, second
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.operator import D, Operator, unknown


def robin(
    w: Field | FieldExpr, dimension: int, coefficient: Datum, value: Datum, conductivity: Datum = 1.0
) -> Operator:
    """Return u with k du/dn + h u = g where w vanishes, n outward.

    Parameters
    ----------
    w
        Normalised to first order.
    dimension
        Number of coordinates.
    coefficient, value, conductivity
        h, g and k.
    """
    w, h, g, k = field(w), field(coefficient), field(value), field(conductivity)
    psi, psi2 = unknown(dimension, 0), unknown(dimension, 1)
    return psi - w * D(w, psi) + (w / k) * (h * psi - g) + w**2 * psi2


def examples() -> list[OnBoundary]:
    """Plane and space."""
    plane = robin(normalised(PLATE, PLATE.part("all"), 1), 2, second, first, positive)
    space = robin(normalised(SHELL, SHELL.part("all"), 1), 3, second, first, positive)
    trace = traces.flux(first, positive, second)
    return [
        OnBoundary(PLATE, [plane], [(PLATE.part(p), trace) for p in ("rim", "hole")]),
        OnBoundary(SHELL, [space], [(SHELL.part(p), trace) for p in ("outer", "inner")]),
    ]


ENTRY = Entry(
    name="robin",
    satisfies="k du/dn + h u = g",
    formula="u = psi - w D psi + w (h psi - g)/k + w^2 psi2",
    conditions=("flux", "value"),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
