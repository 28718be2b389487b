"""Polynomial interpolants of surface functions on boxes.

A surface of known degree is reproduced exactly (to rounding); any other is interpolated with degree 8 at Chebyshev
points and compared with the function between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.jets import partials
from rfm.errors import GeometryError
from solvers.quadrature import bernstein

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.logic import Mask
    from rfm.geometry.surface import Surface
    from solvers.grid import Grid, Integers

DEGREE = 8
"""Degree of interpolants, and the highest one that is trusted to be exact."""

ACCURACY = 1e-12
"""Largest interpolation error, relative to the function on the box, that needs no subdivision."""

CLEAR = 10.0
"""A function whose interpolant keeps away from zero by so many times its error may have no zero: intervals decide."""

EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, eq=False)
class Samples:
    """Bernstein coefficients ``(n, K+1, ..., K+1)``, noise ``(n,)``, whether they stand for the function ``(n,)``."""

    coefficients: Array
    noise: Array
    good: Mask


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
        values = partials(surface.function, coords, 0)[0]
    if not np.isfinite(values).all():
        bad = np.unravel_index(int(np.argmin(np.isfinite(values))), values.shape)
        where = ", ".join(f"{float(np.broadcast_to(x, values.shape)[bad]):.6g}" for x in coords)
        raise GeometryError(
            f"the function of '{surface.name or 'function'}' is not finite at ({where}): shapes need functions "
            f"that are defined on the whole box of the grid"
        )
    return np.asarray(values)


def sample(
    surfaces: Sequence[Surface],
    surface: Integers,
    box: Integers,
    grid: Grid,
    cells: Integers,
    lower: Array,
    width: Array,
    degree: int,
) -> Samples:
    """Interpolate surfaces on boxes inside cells.

    Parameters
    ----------
    surfaces
        All surfaces.
    surface, box
        What to interpolate: pairs of a surface and a box, shape ``(n,)``.
    grid
        The grid.
    cells
        Cell of each box, shape ``(b, d)``.
    lower, width
        Lower corner and side lengths of the boxes in unit coordinates of their cell, shape ``(b, d)``.
    degree
        Degree of the interpolants in each direction (at least a surface's own when that is exact).
    """
    d = grid.dimension
    nodes = bernstein.lobatto(degree)
    coords = _tensor_points(grid, cells, lower, width, nodes)
    values = np.empty((len(box), *[len(nodes)] * d))
    inexact = []
    for s in np.flatnonzero(np.bincount(surface)).tolist():
        chosen = np.flatnonzero(surface == s)
        values[chosen] = values_at(surfaces[s], tuple(x[box[chosen]] for x in coords))
        if not is_exact(surfaces[s]):
            inexact.append((surfaces[s], chosen))
    c = bernstein.interpolate(values, d)
    scale = np.abs(c.reshape(len(c), -1)).max(axis=1, initial=0.0)
    noise = relative_noise(grid, degree) * scale
    good = np.ones(len(c), dtype=bool)
    for one, chosen in inexact:
        where = box[chosen]
        error = _error(one, c[chosen], grid, cells[where], lower[where], width[where])
        noise[chosen] += error
        low, high = bernstein.bounds(c[chosen], d)
        good[chosen] = error <= ACCURACY * scale[chosen]
        # far from zero only the sign is wanted
        clear = np.flatnonzero(~good[chosen] & (np.maximum(low, -high) > CLEAR * error))
        where = where[clear]
        good[chosen[clear]] = _has_no_zero(one, grid, cells[where], lower[where], width[where])
    return Samples(c, noise, good)


def _error(surface: Surface, c: Array, grid: Grid, cells: Integers, lower: Array, width: Array) -> Array:
    """Greatest difference of interpolants and function between the nodes, shape ``(n,)``."""
    degree = c.shape[1] - 1
    nodes = bernstein.lobatto(degree)
    between = 0.5 * (nodes[1:] + nodes[:-1])[1::2]
    expected = values_at(surface, _tensor_points(grid, cells, lower, width, between))
    matrix = bernstein.basis(degree, between)
    for axis in range(1, c.ndim):
        c = bernstein.transform(matrix, c, axis)
    return np.asarray(np.abs(c - expected).reshape(len(c), -1).max(axis=1, initial=0.0))


def _has_no_zero(surface: Surface, grid: Grid, cells: Integers, lower: Array, width: Array) -> Mask:
    """Whether interval arithmetic says so, shape ``(n,)``."""
    low = (grid.lower + grid.spacing * (cells + lower)).T
    high = (grid.lower + grid.spacing * (cells + lower + width)).T
    with np.errstate(all="ignore"):
        bound = Interval.of(surface.function(*(Interval(a, b) for a, b in zip(low, high, strict=True))))
    return np.broadcast_to((bound.lo > 0.0) | (bound.hi < 0.0), len(cells))


def _tensor_points(grid: Grid, cells: Integers, lower: Array, width: Array, t: Array) -> tuple[Array, ...]:
    """Physical coordinates of tensor points, one array ``(n, 1, ..., q, ..., 1)`` per direction."""
    d = grid.dimension
    corner = grid.lower + grid.spacing * (cells + lower)
    side = grid.spacing * width
    coords = []
    for j in range(d):
        axis = [1] * d
        axis[j] = len(t)
        along = corner[:, j, None] + side[:, j, None] * t
        if t[-1] == 1.0:
            # The far end is computed as the near end of the next cell is, so that both see the same face.
            along[:, -1] = grid.lower[j] + grid.spacing[j] * (cells[:, j] + lower[:, j] + width[:, j])
        coords.append(along.reshape(len(cells), *axis))
    return tuple(coords)
