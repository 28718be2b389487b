"""Grids, classifications and batches made by hand, so that spaces and assembly are tested on their own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solvers.grid import Grid
from solvers.quadrature.batch import PointBatch, TensorBatch


@dataclass(frozen=True)
class States:
    """All that a spline space asks of a classification."""

    state: np.ndarray


def unit_grid(*cells):
    """Grid with unequal spacings, so that mixed-up directions are noticed."""
    return Grid(np.zeros(len(cells)), 1.0 / (np.array(cells) + np.arange(len(cells))), np.array(cells))


def ball_states(grid, radius=0.45):
    """Cells inside, cut by and outside the ball around the middle of the grid, radius relative to its sides."""
    n = np.asarray(grid.cells)
    lower = np.moveaxis(np.indices(tuple(n)), 0, -1) / n - 0.5
    upper = lower + 1.0 / n
    far = (np.maximum(np.abs(lower), np.abs(upper)) ** 2).sum(axis=-1)
    near = np.where(lower * upper < 0, 0.0, np.minimum(np.abs(lower), np.abs(upper)) ** 2).sum(axis=-1)
    state = np.where(far <= radius**2, 1, np.where(near < radius**2, 0, -1))
    return States(state.astype(np.int8))


def full_states(grid):
    """Every cell inside."""
    return States(np.ones(tuple(grid.cells), dtype=np.int8))


def gauss_batch(grid, cells, count):
    """Tensor Gauss rule on whole cells."""
    nodes, line = np.polynomial.legendre.leggauss(count)
    weights = np.ones(1)
    for h in grid.spacing:
        weights = np.multiply.outer(weights, line * h / 2).ravel()
    return TensorBatch(cells, (nodes + 1) / 2, np.tile(weights, (len(cells), 1)))


def as_points(batch):
    """Return the same rule with points of its own in each cell."""
    nodes = np.tile(batch.unit_points(), (len(batch.cells), 1, 1))
    return PointBatch(batch.cells, nodes, batch.weights)


def to_array(matrix):
    """Return `matrix` as an array, however it is stored."""
    return matrix if isinstance(matrix, np.ndarray) else matrix.toarray()
