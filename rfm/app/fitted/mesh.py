"""The mesh of a shape on its background grid, fitted to the boundary.

Cells that are inside are taken whole (divided into equal subcells, so that splines of high degree on
few cells are shown as they are); the subcells that the boundary cuts are divided into simplices, split
along the surfaces of the shape and moved onto them.  Edges and corners stay sharp.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rfm.app.fitted.lattice import Lattice, kuhn_simplices
from rfm.app.fitted.polish import polish
from rfm.app.fitted.simplices import (
    Flags,
    Ints,
    Points,
    Signs,
    simplex_signs,
    snapped,
    split_all,
    state,
    surface_values,
)
from rfm.calculus.types import Array

if TYPE_CHECKING:
    from rfm.geometry.shape import Shape
    from rfm.geometry.surface import Surface
    from solvers.classify import Classification
    from solvers.grid import Grid

SUBCELLS = {1: 200, 2: 96, 3: 40}
"""Subcells along the longest side of the grid, at least, by dimension."""

FEATURE, FLAT_FEATURE = 4, 1
"""Subcells per feature size (radius, half width) of a curved and of a flat surface, up to the limit below."""

FINEST = {1: 16, 2: 16, 3: 4}
"""Further division of a cell at a small feature, at most, by dimension."""

LARGEST_LATTICE = 30_000_000


@dataclass(frozen=True)
class FittedMesh:
    """Points, whole subcells, simplices at the boundary, and the facets of the boundary.

    Attributes
    ----------
    points
        Coordinates (n, d).
    blocks
        Corners of the whole subcells (nb, 2^d), in C order: the last direction varies fastest.
    simplices
        Corners of the simplices (ns, d + 1), volumes positive.
    facets
        Corners of the boundary facets (nf, d); in 2D the domain is to the left of a segment, in 3D
        the corners of a triangle run counter-clockwise seen from outside.
    carriers
        Number of the surface that carries each facet (nf,), an index into `surfaces`.
    surfaces
        Surfaces of the shape.
    """

    points: Array
    blocks: Ints
    simplices: Ints
    facets: Ints
    carriers: Ints
    surfaces: tuple[Surface, ...]

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.points.shape[1])

    @cached_property
    def all_simplices(self) -> Ints:
        """The whole mesh as simplices (triangles in 2D), the blocks divided."""
        divided = self.blocks[:, kuhn_simplices(self.dimension)].reshape(-1, self.dimension + 1)
        return np.concatenate([divided, self.simplices])

    @cached_property
    def measure(self) -> float:
        """Area (volume) of the mesh: that of the shape up to the curvature within a subcell."""
        return float(np.abs(volumes(self.points, self.all_simplices)).sum())


@dataclass(frozen=True)
class EdgeCells:
    """Cells of a grid sorted for the mesh.

    Attributes
    ----------
    whole
        Cells inside (n, d).
    edge
        Cells that the boundary may cut or touch (m, d).
    active
        Which surfaces of the shape pass through each of the latter (m, s).
    """

    whole: Ints
    edge: Ints
    active: Flags

    @classmethod
    def of(cls, classification: Classification) -> EdgeCells:
        """Sort the cells of a classification."""
        touching = np.asarray(classification.touching, dtype=bool)
        inner = (classification.state == 1) & ~touching
        rim = np.ones_like(inner)
        rim[(slice(1, -1),) * inner.ndim] = False  # the boundary may lie just beyond the grid
        given = [np.argwhere(classification.state == 0), np.argwhere(touching)]
        more = np.argwhere(inner & rim)
        active = np.asarray(classification.active, dtype=bool)
        return cls(
            np.argwhere(inner & ~rim),
            np.concatenate([*given, more]),
            np.concatenate([active, np.zeros((len(more), active.shape[1]), dtype=bool)]),
        )


def fit(
    domain: Shape, grid: Grid, cells: Classification | EdgeCells, subcells: int | None = None
) -> FittedMesh:
    """Mesh of `domain` on `grid`, fitted to its boundary.

    Parameters
    ----------
    cells
        The classification of the grid's cells, or those that are wanted.
    subcells
        Subcells along the longest side of the grid, at least (a default by dimension when absent).
    """
    chosen = cells if isinstance(cells, EdgeCells) else EdgeCells.of(cells)
    dimension = grid.dimension
    counts = np.asarray(grid.cells, dtype=np.int64)
    divisions = max(1, math.ceil((subcells or SUBCELLS[dimension]) / int(counts.max())))
    factors = _extra_divisions(grid, domain.surfaces, chosen, divisions)
    lattice = Lattice(grid.lower, grid.spacing, counts, divisions * int(factors.max(initial=1)))
    corners = [lattice.subcells(chosen.whole, divisions)]
    corners += [lattice.subcells(chosen.edge[factors == f], divisions * int(f)) for f in np.unique(factors)]
    x, numbered = lattice.number(corners)
    inner, candidates = numbered[0], np.concatenate([np.empty((0, 2**dimension), np.int64), *numbered[1:]])
    return _split_candidates(domain, x, inner, candidates, np.asarray(grid.spacing) / divisions)


def _split_candidates(domain: Shape, x: Array, inner: Ints, candidates: Ints, sides: Array) -> FittedMesh:
    surfaces, expression = domain.surfaces, domain.expression
    at_edge, local, points = _numbered_points(x, candidates, surfaces)
    # a sliver thinner than the snapping distance vanishes: the whole subcells behind it get the boundary
    touched = _spread(at_edge, np.asarray(points.on.any(axis=1)))[inner].any(axis=1)
    if touched.any():
        candidates, inner = np.concatenate([candidates, inner[touched]]), inner[~touched]
        at_edge, local, points = _numbered_points(x, candidates, surfaces)
    signs = simplex_signs(points, local, surfaces)
    inside = state(expression, surfaces, signs)
    # a whole subcell with corners on a surface may have a facet on the boundary: simplices find it
    divide = (inside == 0) | ((inside > 0) & points.on[local].any(axis=(1, 2)))
    pieces = local[divide][:, kuhn_simplices(x.shape[1])].reshape(-1, x.shape[1] + 1)
    points, simplices, sides_of = split_all(points, pieces, surfaces, expression)
    moved = polish(points.x, points.on, surfaces, 0.5 * float(sides.max()))
    # numbers of the mesh: first the corners of subcells, then the points that splitting made
    old = np.flatnonzero(at_edge)
    x = np.concatenate([x, moved[len(old) :]])
    x[old] = moved[: len(old)]
    back = np.concatenate([old, np.arange(len(x) - len(moved) + len(old), len(x))])
    facets, carriers, opposite = _boundary(domain, simplices, sides_of, points.on)
    simplices = back[simplices]
    size = volumes(x, simplices)
    flipped = size < 0
    simplices[flipped] = simplices[flipped][:, [1, 0, *range(2, simplices.shape[1])]]
    simplices = simplices[np.abs(size) > 1e-12 * float(np.prod(sides))]
    blocks = np.concatenate([inner, candidates[(inside > 0) & ~divide]])
    facets = _outward(x, back[facets], back[opposite])
    return _compact(x, blocks, simplices, facets, carriers, surfaces)


def _numbered_points(x: Array, blocks: Ints, surfaces: tuple[Surface, ...]) -> tuple[Flags, Ints, Points]:
    """Corners of `blocks`: which points they are (n,), the blocks in their numbers, the points."""
    used = np.zeros(len(x), dtype=bool)
    used[blocks] = True
    local = (np.cumsum(used) - 1)[blocks]
    values = surface_values(surfaces, x[used])
    return used, local, snapped(x[used], values, _local_range(values, local))


def _spread(where: Flags, values: Flags) -> Flags:
    """Flags of all points, given those of the points `where`."""
    spread = np.zeros(len(where), dtype=bool)
    spread[where] = values
    return spread


def _extra_divisions(grid: Grid, surfaces: tuple[Surface, ...], cells: EdgeCells, divisions: int) -> Ints:
    """Power of two by which each edge cell is divided further because of a small feature in it."""
    factors = np.ones(len(cells.edge), dtype=np.int64)
    side = float(np.max(grid.spacing)) / divisions
    limit = FINEST[grid.dimension]
    lattice = float(np.prod(np.asarray(grid.cells, dtype=float) * divisions))
    while limit > 1 and lattice * float(limit) ** grid.dimension > LARGEST_LATTICE:
        limit //= 2
    for column, surface in enumerate(surfaces):
        per_feature = FLAT_FEATURE if surface.degree == 1 else FEATURE
        wanted = per_feature * side / surface.size if surface.size > 0 else 1.0
        if wanted > 1:
            factor = min(limit, 2 ** math.ceil(math.log2(wanted)))
            here = cells.active[:, column]
            factors[here] = np.maximum(factors[here], factor)
    return factors


def _local_range(values: Array, blocks: Ints) -> Array:
    """Largest range of each surface function (n, s) over the subcells around a point."""
    ranges = np.ptp(values[blocks], axis=1)
    scale = np.zeros_like(values)
    for corner in blocks.T:
        np.maximum.at(scale, corner, ranges)
    return scale


def _boundary(domain: Shape, simplices: Ints, signs: Signs, on: Flags) -> tuple[Ints, Ints, Ints]:
    """Facets of the `simplices` on a surface beyond which the outside begins.

    The facet lies on the boundary when changing the sign of its surface leads outside.

    Returns
    -------
    facets, carriers, opposite
        Corners (nf, d), number of the surface (nf,), the corner of the simplex not in the facet (nf,).
    """
    surfaces, expression = domain.surfaces, domain.expression
    borne = np.array([not surface.auxiliary for surface in surfaces])
    corner_count = simplices.shape[1]
    facets, opposite = [np.empty((0, corner_count - 1), np.int64)], [np.empty(0, np.int64)]
    carriers = [np.empty(0, np.int64)]
    for left_out in range(corner_count):
        corners = np.delete(simplices, left_out, axis=1)
        common = on[corners].all(axis=1) & borne
        for column in np.flatnonzero(common.any(axis=0)):
            rows = np.flatnonzero(common[:, column])
            beyond = signs[rows].copy()
            beyond[:, column] *= -1
            found = rows[state(expression, surfaces, beyond) < 0]
            common[found] = False
            facets.append(corners[found])
            opposite.append(simplices[found, left_out])
            carriers.append(np.full(len(found), column))
    return np.concatenate(facets), np.concatenate(carriers), np.concatenate(opposite)


def _outward(x: Array, facets: Ints, opposite: Ints) -> Ints:
    """Facets with their corners in the order that has the opposite corners on the inner side."""
    inward = volumes(x, np.concatenate([facets, opposite[:, None]], axis=1))
    wrong = inward < 0 if x.shape[1] == 2 else inward > 0
    turned = facets.copy()
    turned[wrong] = turned[wrong][:, [1, 0, *range(2, facets.shape[1])]]
    return turned


def _compact(
    x: Array, blocks: Ints, simplices: Ints, facets: Ints, carriers: Ints, surfaces: tuple[Surface, ...]
) -> FittedMesh:
    """Drop the points that nothing uses."""
    used = np.zeros(len(x), dtype=bool)
    used[blocks] = True
    used[simplices] = True
    kept = used[facets].all(axis=1)
    new = np.cumsum(used) - 1
    return FittedMesh(x[used], new[blocks], new[simplices], new[facets[kept]], carriers[kept], surfaces)


def volumes(x: Array, simplices: Ints) -> Array:
    """Signed volumes (m,) of the simplices (areas of triangles in 2D)."""
    edges = x[simplices[:, 1:]] - x[simplices[:, :1]]
    return np.asarray(np.linalg.det(edges) / math.factorial(x.shape[1]))
