"""Derivatives of all splines of a cell at its points, and where these splines are in the coefficient array."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.splines import tables
from solvers.web import SplineSpace


def order_of(keys: Iterable[tuple[int, int]], dimension: int) -> int:
    """Highest derivative among numbers of multi-indices."""
    highest = max(max(key) for key in keys)
    order = 0
    while len(multi_indices(dimension, order)) <= highest:
        order += 1
    return order


def node_table(batch: TensorBatch | PointBatch) -> Array:
    """Unit coordinates (n, q, d) of a batch; n = 1 when all cells share them."""
    return batch.unit_points()[None] if isinstance(batch, TensorBatch) else batch.nodes


def spline_table(space: SplineSpace, nodes: Array, order: int) -> list[Array]:
    """Derivatives of the splines of a cell at its nodes: for each multi-index an array (n, q, (p+1)^d)."""
    line = tables(space.degree, nodes, order)  # (order + 1, n, q, d, p + 1)
    spacing = space.grid.spacing
    found = []
    for alpha in multi_indices(nodes.shape[2], order):
        factors: Sequence[Array] = [line[r, :, :, axis] / spacing[axis] ** r for axis, r in enumerate(alpha)]
        product = factors[0]
        for factor in factors[1:]:
            product = (product[:, :, :, None] * factor[:, :, None, :]).reshape(*product.shape[:2], -1)
        found.append(product)
    return found


def local_indices(space: SplineSpace, cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Flat indices of the (p+1)^d splines on each cell, shape (n, (p+1)^d)."""
    offsets = np.indices((space.degree + 1,) * cells.shape[1]).reshape(cells.shape[1], -1)
    index = cells[:, :, None] + offsets[None]
    flat: NDArray[np.int64] = np.ravel_multi_index(tuple(np.moveaxis(index, 1, 0)), space.shape)
    return flat
