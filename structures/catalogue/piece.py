"""A condition on a piece of one part, say where x > 0.2 on a circle, and another on the rest.

The piece's w is trimmed: its carrier's function joined with the condition t >= 0 so that it vanishes on the
piece only and keeps its slope there (Shapiro, Acta Numerica 16, 2007, (5.1); :mod:`rfm.geometry.trimming`).
Otherwise nothing changes: u = g + w psi and the corrections of :mod:`structures.catalogue.multipart`.  At the
ends of the piece, where the conditions change, the trimmed function and the solution itself are singular.
"""

from __future__ import annotations

from rfm.calculus import types
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.catalogue import traces
from structures.catalogue.condition import Condition
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.multipart import multipart
from structures.catalogue.samples import ELLIPSE, first, second
from structures.catalogue.scalar_conditions import Flux, Value
from structures.operator import Operator


def split(part: Part, where: types.Field) -> tuple[Part, Part]:
    """Return the piece of a part where a field is positive, and the rest."""
    piece = part.restricted(where, f"{part.name} (piece)")
    return piece, part.restricted(lambda *x: -where(*x), f"{part.name} (rest)")


def on_piece(
    domain: Shape, part: Part, where: types.Field, inside: Condition, outside: Condition | None = None
) -> list[Operator]:
    """Return u with one condition on a piece and, if given, another on the rest of a part.

    Parameters
    ----------
    domain, part
        The shape and a part of its boundary.
    where
        Positive on the piece.
    inside, outside
        The conditions.
    """
    piece, rest = split(part, where)
    conditions = [(piece, [inside])] + ([(rest, [outside])] if outside is not None else [])
    return multipart(domain, conditions, inside.components)


def _right(x: types.Value, y: types.Value) -> types.Value:
    return x - 0.2


def examples() -> list[OnBoundary]:
    """A value where x > 0.2, a flux on the rest of an ellipse."""
    whole = ELLIPSE.part("all")
    piece, rest = split(whole, _right)
    u = on_piece(ELLIPSE, whole, _right, Value(first), Flux(second))
    return [OnBoundary(ELLIPSE, u, [(piece, traces.value(first)), (rest, traces.flux(second))])]


ENTRY = Entry(
    name="piece",
    satisfies="any condition where t > 0 on a part, another on the rest",
    formula="w trimmed by t (5.1), then as multipart",
    conditions=("value", "flux"),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
