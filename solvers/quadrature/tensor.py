"""Gauss rules on whole cells."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature.batch import TensorBatch
from solvers.quadrature.pieces import gauss

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from solvers.grid import Grid, Integers


def tensor_weights(weights: Array, dimension: int) -> Array:
    """Return products of one-dimensional weights, shape ``(m**d,)``, C order."""
    return np.asarray(reduce(np.multiply.outer, [weights] * dimension)).ravel()


def inner_rule(grid: Grid, cells: Integers, points: int) -> TensorBatch:
    """Return the tensor Gauss rule on whole cells ``(n, d)`` with ``points`` points a direction."""
    nodes, weights = gauss(points)
    weight = grid.cell_volume * tensor_weights(weights, grid.dimension)
    return TensorBatch(cells, nodes, np.broadcast_to(weight, (len(cells), weight.size)))
