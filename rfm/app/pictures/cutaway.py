"""A solid with the octant next to the eye taken away, so that the inside is seen.

The octant is removed from the shape itself; the fitted mesh of what is left has the cut faces among its
boundary facets, and they show the field inside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rfm.app.fitted import EdgeCells, FittedMesh, fit
from rfm.app.pictures.render import Camera, View, look
from rfm.calculus.jets import partials
from rfm.calculus.types import Array

if TYPE_CHECKING:
    from rfm.app.record import RunRecord
    from rfm.geometry.shape import Shape
    from solvers.grid import Grid

AZIMUTH, ELEVATION = -58.0, 28.0
OCTANT = np.array([1.0, -1.0, 1.0])
"""Signs of the coordinates in the octant that the eye looks into."""


def cut_open(record: RunRecord, subcells: int | None = None) -> FittedMesh:
    """Boundary of the domain of `record` without the octant (the mesh holds no inner cells)."""
    from rfm.geometry.primitives_3d import half_space

    grid, domain = record.grid, record.domain
    centre = middle_of(record)
    faces = [half_space(centre, tuple(OCTANT[j] * row)) for j, row in enumerate(np.eye(3))]
    opened = domain - (faces[0] & faces[1] & faces[2])
    return fit(opened, grid, _boundary_cells(record, np.array(centre), opened), subcells)


def middle_of(record: RunRecord) -> tuple[float, float, float]:
    """Middle of the cells that belong to the domain: where the cuts and slices are made."""
    occupied = np.argwhere(record.classification.state >= 0)
    low, high = occupied.min(axis=0), occupied.max(axis=0) + 1
    lower, upper = record.domain.box.lower, record.domain.box.upper
    low = np.maximum(record.grid.lower + low * record.grid.spacing, lower)
    high = np.minimum(record.grid.lower + high * record.grid.spacing, upper)
    x, y, z = 0.5 * (low + high)
    return float(x), float(y), float(z)


def _boundary_cells(record: RunRecord, centre: Array, opened: Shape) -> EdgeCells:
    """Cells at the boundary of the opened shape; those inside are left out, nothing of them is seen."""
    grid, state = record.grid, record.classification.state
    old = EdgeCells.of(record.classification)
    nearest, farthest = _along_the_octant(grid, centre)
    tolerance = 1e-9 * float(np.max(grid.spacing))
    removed = nearest > tolerance
    sliced = (state == 1) & ~removed & (farthest >= -tolerance)
    sliced[tuple(old.edge.T)] = False
    kept = ~removed[tuple(old.edge.T)]
    edge = np.concatenate([old.edge[kept], np.argwhere(sliced)])
    active = np.zeros((len(edge), len(opened.surfaces)), dtype=bool)
    for column, surface in enumerate(record.domain.surfaces):
        if surface in opened.surfaces:
            active[: kept.sum(), opened.surfaces.index(surface)] = old.active[kept, column]
    return EdgeCells(np.empty((0, 3), dtype=np.int64), edge, active)


def _along_the_octant(grid: Grid, centre: Array) -> tuple[Array, Array]:
    """Smallest and largest of the three coordinates into the octant, least over the axes, per cell."""
    shape = tuple(int(count) for count in grid.cells)
    nearest, farthest = np.full(shape, np.inf), np.full(shape, np.inf)
    for axis in range(3):
        low = grid.lower[axis] + grid.spacing[axis] * np.arange(shape[axis])
        ends = OCTANT[axis] * (np.stack([low, low + grid.spacing[axis]]) - centre[axis])
        along = [1, 1, 1]
        along[axis] = shape[axis]
        nearest = np.minimum(nearest, ends.min(axis=0).reshape(along))
        farthest = np.minimum(farthest, ends.max(axis=0).reshape(along))
    return nearest, farthest


def view(mesh: FittedMesh, pixels: int) -> View:
    """The boundary facets of `mesh` seen from the removed octant."""
    corners = mesh.points[mesh.facets]
    camera = Camera.around(corners.reshape(-1, 3), AZIMUTH, ELEVATION)
    return look(corners, facet_normals(mesh), camera, pixels)


def facet_normals(mesh: FittedMesh) -> Array:
    """Unit normals (nf, 3, 3) at the corners of the facets, exact for the surface that carries them."""
    corners = mesh.points[mesh.facets]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.repeat(flat[:, None], 3, axis=1)
    for number in np.unique(mesh.carriers):
        rows = np.flatnonzero(mesh.carriers == number)
        coords = tuple(corners[rows].reshape(-1, 3).T.copy())
        with np.errstate(all="ignore"):
            slopes = partials(mesh.surfaces[number].function, coords, 1)[1:].T.reshape(-1, 3, 3)
        usable = np.isfinite(slopes).all(axis=(1, 2)) & ((slopes**2).sum(axis=2) > 0).all(axis=1)
        normals[rows[usable]] = slopes[usable]
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    return np.asarray(normals / np.where(lengths > 0, lengths, 1))
