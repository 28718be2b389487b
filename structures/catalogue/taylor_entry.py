"""Value and normal derivatives up to order m, (7.1) of Shapiro (Acta Numerica 16, 2007).

    u = sum_{k=0..m} w^k / k! f*_k + w^(m+1) psi.

See :mod:`structures.taylor`; the conditions of Theorem 7 for data and psi alike.  Parts of different order
are joined by (7.12).
"""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.samples import ELLIPSE, first, positive, second
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.operator import Operator, unknown
from structures.taylor import taylor


def prescribed_derivatives(
    w: Field | FieldExpr, derivatives: Sequence[Datum], dimension: int, normaliser: str = "jets"
) -> Operator:
    """Return u with given value and derivatives along the normal into the domain where w vanishes.

    Parameters
    ----------
    w
        Normalised to the order m of the highest derivative.
    derivatives
        f_0, ..., f_m.
    dimension
        Number of coordinates.
    normaliser
        See :func:`structures.taylor.taylor`.
    """
    rest = field(w) ** len(derivatives) * unknown(dimension)
    return taylor(w, derivatives, dimension, normaliser) + rest


def examples() -> list[OnBoundary]:
    """Three data on an ellipse, by both normalisers."""
    part, data = ELLIPSE.part("all"), (first, second, positive)
    w = normalised(ELLIPSE, part, 2)
    checks = [(part, traces.value(first)), (part, traces.normal_derivative(second, 1))]
    checks.append((part, traces.normal_derivative(positive, 2)))
    return [
        OnBoundary(ELLIPSE, [prescribed_derivatives(w, data, 2, name)], checks)
        for name in ("jets", "composition")
    ]


ENTRY = Entry(
    name="taylor",
    satisfies="u = f_0 and d^k u/dn^k = f_k, k = 1..m",
    formula="u = sum_k w^k/k! f*_k + w^(m+1) psi (7.1)",
    conditions=("value", "normal derivatives"),
    unknowns=1,
    normalisation=2,
    derivatives=0,
    examples=examples,
)
