"""Oblique derivative: l . grad u + h u = g with a direction l that is nowhere tangential.

    u = psi + w / (l . N) (g - h psi - l . grad psi) + w^2 psi2,    N = grad w.

The derivative along l of the correction is (l . N) times its factor on w = 0.  1 / (l . N) is continued into
the domain as s / (s^2 + w^2), s = l . N, which stays finite where s vanishes.  Shapiro (Acta Numerica 16,
2007), section 7.
"""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.rule import completed
from structures.catalogue.samples import ELLIPSE, first, second
from structures.catalogue.scalar_conditions import Oblique
from structures.features import normalised
from structures.field_expression import FieldExpr
from structures.layers import layer
from structures.operator import Operator, unknown


def oblique(
    w: Field | FieldExpr, direction: Sequence[Datum], value: Datum, coefficient: Datum = 0.0
) -> Operator:
    """Return u with l . grad u + h u = g where w vanishes.

    Parameters
    ----------
    w
        Normalised to first order (any w with a slope would do).
    direction, value, coefficient
        l, g and h.
    """
    psi = layer(w, [unknown(len(direction))])
    (u,) = completed([psi], [Oblique(value, tuple(direction), coefficient)])
    return u


def examples() -> list[OnBoundary]:
    """The normal turned by a good 20 degrees."""
    part = ELLIPSE.part("all")
    direction = (lambda x, y: x - 0.4 * y - 0.1, lambda x, y: y + 0.4 * x)
    u = oblique(normalised(ELLIPSE, part, 1), direction, first, second)
    return [OnBoundary(ELLIPSE, [u], [(part, traces.oblique(first, direction, second))])]


ENTRY = Entry(
    name="oblique",
    satisfies="l . grad u + h u = g, l not tangential",
    formula="u = psi + w/(l . grad w) (g - h psi - l . grad psi) + w^2 psi2",
    conditions=("oblique derivative",),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
