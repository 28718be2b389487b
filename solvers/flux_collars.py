"""Collars of the flux conditions of a problem: how wide they are, and which other parts their windows must spare.

Each surface that carries a flux condition is a piece of its own (:mod:`structures.localized`).  The width of a collar
is a few cells, less where another part is near; parts so far away that the window is zero to rounding on them are left
out.

Notation: l the length of a window, h the cell width, w normalised on the piece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array
from rfm.geometry.distance import distance
from solvers.flux_conditions import boundary_pieces, site_of
from solvers.problem import Problem
from structures.catalogue.rule import Site, even
from structures.contact import boundary_points, meeting_points
from structures.field_expression import FieldExpr, field
from structures.localized import Spared, localized, supplemented, window
from structures.operator import Operator

LENGTHS = {1: 1.75, 2: 1.25, 3: 1.0}
"""l in cell widths, where there is room, by the highest order of the conditions.  Measured (docs/structures.md): for a
flux 1.5 to 2 are equally accurate; the condition number grows tenfold, and below more Gauss points are needed.  For the
edges of plates shorter is better."""
ROOM = 2.0
"""Distance to the nearest other part in lengths l, at least (parts that meet do not count)."""
VANISHED = 2.45
"""chi is zero to rounding at so many lengths: exp(-2.45^4) = 2e-16."""
REACH = 2.2
"""The second splines live where w is below so many lengths (2.2 to 3.85 cells: no multiple of half a cell, at which
rounding would decide on aligned grids); one layer of cells fewer costs a factor of 10 in the error, one more is
nearly nothing times large coefficients."""


@dataclass(frozen=True, eq=False)
class Collar:
    """A piece of boundary with a flux condition.

    Attributes
    ----------
    site
        The conditions with their normalised function w.
    length
        l of its window.
    others
        Functions normalised on the other parts that the window has to spare, and to which order.
    meeting
        Those of them whose part meets this one.
    own
        Normalised on the piece alone; it differs from w where several pieces lie on one surface.
    """

    site: Site
    length: float
    others: tuple[Spared, ...]
    meeting: tuple[FieldExpr, ...]
    own: FieldExpr

    @property
    def window(self) -> FieldExpr:
        """X of the structure."""
        return window(self.site.w, self.length, self.others, self.own)

    @property
    def components(self) -> tuple[int, ...]:
        """Components of u that have a second spline here."""
        return supplemented(self.site)


def collars_of(problem: Problem, spacing: float) -> tuple[Collar, ...]:
    """Collars of the flux conditions of a problem on cells of width `spacing`.

    Raises
    ------
    DiscretizationError
        There is no exact structure for one of the conditions.
    """
    domain = problem.domain
    pieces = list(boundary_pieces(problem))
    ws = [field(distance(domain, piece)) for piece, _ in pieces]
    # pieces of one surface share its smooth function; what is normalised on a piece alone has no gradient at its ends
    carriers = [
        w if piece.where is None else field(distance(domain, replace(piece, where=None)))
        for w, (piece, _) in zip(ws, pieces, strict=True)
    ]
    points = [boundary_points(domain, piece) for piece, _ in pieces]
    sites = [site_of(problem, given, carrier) for carrier, (_, given) in zip(carriers, pieces, strict=True)]
    found = []
    for m, (piece, _) in enumerate(pieces):
        if not sites[m].conditions:
            continue
        rest = [j for j in range(len(pieces)) if j != m]
        level = {j: lowest(carriers[m], points[j]) for j in rest}
        widest = LENGTHS[sites[m].order] * spacing
        near = [j for j in rest if level[j] < VANISHED * widest]
        touching = [j for j in near if len(meeting_points(domain, piece, pieces[j][0]))]
        gaps = [lowest(ws[m], points[j]) for j in near if j not in touching]
        length = min([widest, *(gap / ROOM for gap in gaps)])
        spared = [j for j in near if j in touching or level[j] < VANISHED * length]
        found.append(
            Collar(
                sites[m],
                length,
                tuple((ws[j], even(sites[j].kept)) for j in spared),
                tuple(ws[j] for j in touching),
                ws[m],
            )
        )
    return tuple(found)


def lowest(w: FieldExpr, points: Array) -> float:
    """Least value of w at points (n, d)."""
    with np.errstate(all="ignore"):
        return float(np.nanmin(partials(w, tuple(points.T), 0)[0]))


def collared(essential: Sequence[Operator], collars: Sequence[Collar]) -> tuple[Operator, ...]:
    """Structure that satisfies all conditions for every choice of its splines."""
    return localized(essential, [c.site for c in collars], [c.window for c in collars])
