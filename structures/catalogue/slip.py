"""Normal and tangential displacement of a vector field, on walls of any shape.

Slip, a roller on a curved wall: n . u = g, with N = grad w the inward normal,

    u = psi - N (g + N . psi) + w psi'.

No sliding: u - n (n . u) = t - n (n . t),

    u = psi + (t - psi) - N (N . (t - psi)) + w psi'.

psi' (one more unknown for each component) gives back the values away from the wall that the projection
removes: without it the normal component of u would be prescribed wherever |grad w| = 1.  No division by |N|:
where grad w vanishes inside the domain u is just psi + w psi'.  Shapiro (Acta Numerica 16, 2007), section 7;
the general rule with a condition of order zero.
"""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.rule import completed
from structures.catalogue.samples import PLATE, SHELL, first, positive, second
from structures.catalogue.vector_conditions import Normal, Tangential
from structures.features import normalised
from structures.field_expression import FieldExpr
from structures.layers import layer
from structures.operator import Operator, unknown


def slip(w: Field | FieldExpr, dimension: int, value: Datum = 0.0) -> list[Operator]:
    """Return u with n . u = g where w vanishes, n outward.

    Parameters
    ----------
    w
        Normalised to first order.
    dimension
        Number of coordinates and components.
    value
        g.
    """
    return completed(
        [layer(w, [unknown(dimension, c)]) for c in range(dimension)], [Normal(value, dimension)]
    )


def no_sliding(w: Field | FieldExpr, given: Sequence[Datum]) -> list[Operator]:
    """Return u with the tangential part of ``given`` where w vanishes."""
    dimension = len(given)
    return completed(
        [layer(w, [unknown(dimension, c)]) for c in range(dimension)], [Tangential(tuple(given))]
    )


def examples() -> list[OnBoundary]:
    """Slip in the plane and in space."""
    plane = slip(normalised(PLATE, PLATE.part("all"), 1), 2, first)
    space = slip(normalised(SHELL, SHELL.part("all"), 1), 3, first)
    trace = traces.normal_component(first)
    return [
        OnBoundary(PLATE, plane, [(PLATE.part(p), trace) for p in ("rim", "hole")]),
        OnBoundary(SHELL, space, [(SHELL.part(p), trace) for p in ("outer", "inner")]),
    ]


def sliding_examples() -> list[OnBoundary]:
    """The tangential part, in the plane and in space."""
    plane = no_sliding(normalised(PLATE, PLATE.part("all"), 1), (first, second))
    space = no_sliding(normalised(SHELL, SHELL.part("all"), 1), (first, second, positive))
    flat, solid = (traces.tangential_components(v) for v in ((first, second), (first, second, positive)))
    return [
        OnBoundary(PLATE, plane, [(PLATE.part(p), flat) for p in ("rim", "hole")]),
        OnBoundary(SHELL, space, [(SHELL.part(p), solid) for p in ("outer", "inner")]),
    ]


ENTRY = Entry(
    name="slip",
    satisfies="n . u = g, also on curved walls (roller)",
    formula="u = psi - N (g + N . psi) + w psi', N = grad w",
    conditions=("normal component",),
    unknowns=2,
    normalisation=1,
    derivatives=0,
    examples=examples,
)
NO_SLIDING = Entry(
    name="no-sliding",
    satisfies="u - n (n . u) = t - n (n . t)",
    formula="u = t + N (N . (psi - t)) + w psi'",
    conditions=("tangential components",),
    unknowns=2,
    normalisation=1,
    derivatives=0,
    examples=sliding_examples,
)
