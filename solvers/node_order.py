r"""The order of the points of a batch in memory.

Sum factorisation (:mod:`solvers.assembly_tensor`) takes the first node of all cells, then the second, and so on: every
product is then a small constant matrix times a long one.  So the formulas are evaluated in that order at once, on
arrays of ``q n`` numbers for q nodes and n cells, and nothing is copied on the way.  Scattered points stay cell after
cell.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from rfm.calculus.types import Array
from solvers.grid import Grid
from solvers.quadrature.batch import PointBatch, TensorBatch

Key = TypeVar("Key")


def ordered_points(batch: TensorBatch | PointBatch, grid: Grid) -> tuple[Array, ...]:
    """Physical coordinates: d arrays (q n,) of a tensor batch, node after node, or (n, q) of scattered points."""
    if isinstance(batch, PointBatch):
        return batch.points(grid)
    corners, (count, m), dimension = grid.corners(batch.cells), (len(batch), len(batch.nodes)), grid.dimension
    found = []
    for axis in range(dimension):
        line = np.add.outer(grid.spacing[axis] * batch.nodes, corners[:, axis])[:, None]
        found.append(np.broadcast_to(line, (m**axis, m, m ** (dimension - 1 - axis), count)).ravel())
    return tuple(found)


def ordered_weights(batch: TensorBatch | PointBatch) -> Array:
    """Weights in the order of the points."""
    return batch.weights if isinstance(batch, PointBatch) else batch.weights.T.ravel()


def by_cell(batch: TensorBatch | PointBatch, values: Mapping[Key, Array]) -> dict[Key, Array]:
    """Values at the points as arrays (n, q), without copies."""
    if isinstance(batch, PointBatch):
        return dict(values)
    return {key: array.reshape(-1, len(batch)).T for key, array in values.items()}
