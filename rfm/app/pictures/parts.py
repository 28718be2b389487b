"""Which named part of the boundary each facet of the fitted mesh belongs to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rfm.app.fitted import FittedMesh
from rfm.app.pictures.canvas import PART_COLOURS


@dataclass(frozen=True)
class NamedFacets:
    """Names of the parts, and for every facet the number of its name (nf,)."""

    names: tuple[str, ...]
    number: NDArray[np.int64]

    def colour(self, number: int) -> str:
        """Colour of a part; they repeat when there are many."""
        return PART_COLOURS[number % len(PART_COLOURS)]


def named_facets(mesh: FittedMesh) -> NamedFacets:
    """Sort the boundary facets of `mesh` by the named surface, or piece of a surface, they lie on."""
    middle = tuple(np.ascontiguousarray(mesh.points[mesh.facets].mean(axis=1).T))
    names: dict[str, int] = {}
    number = np.zeros(len(mesh.facets), dtype=np.int64)
    for carrier in np.unique(mesh.carriers):
        surface = mesh.surfaces[carrier]
        rows = np.flatnonzero(mesh.carriers == carrier)
        if not surface.pieces:
            number[rows] = names.setdefault(surface.name, len(names))
        coords = tuple(coordinate[rows] for coordinate in middle)
        for piece in surface.pieces:
            here = np.broadcast_to(piece.where(*coords), rows.shape) > 0
            if here.any():
                number[rows[here]] = names.setdefault(".".join(piece.label), len(names))
    return NamedFacets(tuple(names), number)
