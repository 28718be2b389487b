"""Dirichlet: u = g + w psi (Kantorovich; Shapiro, Acta Numerica 16, 2007, section 7).

The work is done in :mod:`structures.dirichlet`; parts with different data are joined into one g.
"""

from __future__ import annotations

from structures.catalogue import traces
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.samples import PLATE, SHELL, first, second
from structures.dirichlet import dirichlet

__all__ = ["ENTRY", "dirichlet"]


def examples() -> list[OnBoundary]:
    """Different data on an ellipse and its hole; one formula on a shell."""
    rim, hole = PLATE.part("rim"), PLATE.part("hole")
    plane = dirichlet(PLATE, [(rim, first), (hole, second)])
    space = dirichlet(SHELL, [(SHELL.part("all"), first)])
    return [
        OnBoundary(PLATE, [plane], [(rim, traces.value(first)), (hole, traces.value(second))]),
        OnBoundary(SHELL, [space], [(SHELL.part(p), traces.value(first)) for p in ("outer", "inner")]),
    ]


ENTRY = Entry(
    name="dirichlet",
    satisfies="u = g_i on part i",
    formula="u = g + w psi",
    conditions=("value",),
    unknowns=1,
    normalisation=0,
    derivatives=0,
    examples=examples,
)
