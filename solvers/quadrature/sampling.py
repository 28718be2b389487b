"""Polynomial interpolants of surface functions on boxes.

A surface of known degree is reproduced exactly (to rounding); any other is interpolated with degree 8 at Chebyshev
points and compared with the function between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.jets import partials
from rfm.errors import GeometryError
from solvers.quadrature import bernstein

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.surface import Surface
    from solvers.grid import Grid, Integers

DEGREE = 8
"""Degree of interpolants, and the highest one that is trusted to be exact."""

ACCURACY = 1e-12
"""Largest interpolation error, relative to the function on the box, that needs no subdivision."""

EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, eq=False)
class Samples:
    """Bernstein coefficients ``(n, K+1, ..., K+1)``, their rounding noise ``(n,)`` and interpolation error ``(n,)``."""

    coefficients: Array
    noise: Array
    error: Array

    @property
    def good(self) -> Array:
        """Whether the interpolant stands for the function, shape ``(n,)``."""
        scale = np.abs(self.coefficients.reshape(len(self.noise), -1)).max(axis=1, initial=0.0)
        return np.asarray(self.error <= ACCURACY * scale)


def degree_of(surface: Surface) -> int:
    """Return the degree in which a surface is represented."""
    if surface.degree is None or surface.degree > DEGREE:
        return DEGREE
    return max(1, surface.degree)


def is_exact(surface: Surface) -> bool:
    """Whether :func:`sample` reproduces the surface without interpolation error."""
    return surface.degree is not None and surface.degree <= DEGREE


def relative_noise(grid: Grid, degree: int) -> float:
    """Return the rounding level of Bernstein coefficients relative to the largest of them.

    Conversion to coefficients amplifies rounding like ``2**degree``; coordinates are rounded relative to their size,
    not to that of a cell.
    """
    extent = float((np.maximum(np.abs(grid.lower), np.abs(grid.upper)) / grid.spacing).max())
    return EPS * (2.0 ** (degree + 3) + 16.0 * extent)


def values_at(surface: Surface, coords: tuple[Array, ...]) -> Array:
    """Return values of a surface function, checked to be finite.

    Raises
    ------
    GeometryError
        If the function is not finite somewhere on the grid.
    """
    with np.errstate(all="ignore"):
        values = np.broadcast_to(partials(surface.function, coords, 0)[0], np.shape(coords[0]))
    if not np.isfinite(values).all():
        bad = np.unravel_index(int(np.argmin(np.isfinite(values))), values.shape)
        where = ", ".join(f"{float(np.broadcast_to(x, values.shape)[bad]):.6g}" for x in coords)
        raise GeometryError(
            f"the function of '{surface.name or 'function'}' is not finite at ({where}): shapes need functions "
            f"that are defined on the whole box of the grid"
        )
    return np.asarray(values)


def sample(surface: Surface, grid: Grid, cells: Integers, lower: Array, width: Array, degree: int) -> Samples:
    """Interpolate a surface on boxes inside cells.

    Parameters
    ----------
    surface
        The surface.
    grid
        The grid.
    cells
        Cells, shape ``(n, d)``.
    lower, width
        Lower corner and side lengths of the boxes in unit coordinates of their cell, shape ``(n, d)``.
    degree
        Degree of the interpolant in each direction (at least the surface's own when that is exact).
    """
    d = grid.dimension
    values = values_at(surface, _tensor_points(grid, cells, lower, width, bernstein.lobatto(degree)))
    c = bernstein.interpolate(values, d)
    scale = np.abs(c.reshape(len(c), -1)).max(axis=1, initial=0.0)
    noise = relative_noise(grid, degree) * scale
    error = np.zeros(len(c))
    if not is_exact(surface):
        between = bernstein.lobatto(degree)
        between = 0.5 * (between[1:] + between[:-1])[1::2]
        expected = values_at(surface, _tensor_points(grid, cells, lower, width, between))
        found = c
        matrix = bernstein.basis(degree, between)
        for axis in range(-d, 0):
            found = bernstein.transform(matrix, found, axis)
        error = np.abs(found - expected).reshape(len(c), -1).max(axis=1, initial=0.0)
    return Samples(c, noise, error)


def _tensor_points(grid: Grid, cells: Integers, lower: Array, width: Array, t: Array) -> tuple[Array, ...]:
    """Physical coordinates of tensor points, one array ``(n, q, ..., q)`` per direction."""
    d = grid.dimension
    corner = grid.lower + grid.spacing * (cells + lower)
    side = grid.spacing * width
    shape = (len(cells), *[len(t)] * d)
    coords = []
    for j in range(d):
        axis = [1] * d
        axis[j] = len(t)
        along = corner[:, j, None] + side[:, j, None] * t
        # The far end is computed as the near end of the next cell is, so that both see the same face.
        along[:, -1] = np.where(
            t[-1] == 1.0,
            grid.lower[j] + grid.spacing[j] * (cells[:, j] + lower[:, j] + width[:, j]),
            along[:, -1],
        )
        coords.append(np.broadcast_to(along.reshape(len(cells), *axis), shape))
    return tuple(coords)


def corner_points(grid: Grid, cells: Integers) -> tuple[Array, ...]:
    """Return physical coordinates of the ``2**d`` corners of cells, one array ``(n, 2**d)`` per direction."""
    corners = np.asarray(list(product((0.0, 1.0), repeat=grid.dimension)))
    return grid.points(cells, corners)
