"""All structures by name, and the table of what each satisfies."""

from __future__ import annotations

from types import MappingProxyType

from rfm.errors import StructureError
from structures.catalogue import (
    clamped,
    components,
    dirichlet,
    free,
    interface,
    mixed,
    multipart,
    neumann,
    oblique,
    periodic,
    piece,
    robin,
    slip,
    supported,
    taylor_entry,
    traction,
)
from structures.catalogue.entry import Entry

_ENTRIES = (
    dirichlet.ENTRY,
    neumann.ENTRY,
    robin.ENTRY,
    oblique.ENTRY,
    mixed.ENTRY,
    mixed.PUBLISHED,
    taylor_entry.ENTRY,
    clamped.ENTRY,
    supported.ENTRY,
    free.ENTRY,
    periodic.ENTRY,
    interface.ENTRY,
    piece.ENTRY,
    multipart.ENTRY,
    components.ENTRY,
    slip.ENTRY,
    slip.NO_SLIDING,
    traction.ENTRY,
    traction.FRICTIONLESS,
)

CATALOGUE: MappingProxyType[str, Entry] = MappingProxyType({entry.name: entry for entry in _ENTRIES})
"""Every entry by name."""

COLUMNS = ("structure", "satisfies", "formula", "psi", "order of w", "derivatives")
"""psi: unknowns for each component; order of w: its normalisation (0: any weight); derivatives: highest of a psi."""


def entry(name: str) -> Entry:
    """Return a structure of the catalogue.

    Raises
    ------
    StructureError
        When there is none of that name; lists the names.
    """
    if name not in CATALOGUE:
        raise StructureError(f"unknown structure {name!r}; choose one of {', '.join(CATALOGUE)}")
    return CATALOGUE[name]


def rows() -> list[tuple[str, ...]]:
    """Return the table of the catalogue, as text."""
    return [
        (e.name, e.satisfies, e.formula, str(e.unknowns), str(e.normalisation), str(e.derivatives))
        for e in CATALOGUE.values()
    ]


def markdown() -> str:
    """Return the table for the documentation."""
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join((row[0], row[1], f"`{row[2]}`", *row[3:])) + " |" for row in rows()]
    return "\n".join(lines)
