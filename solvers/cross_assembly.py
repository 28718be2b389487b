r"""Assembly of a form between two different spline spaces on one grid.

.. math:: A_{ij} = \sum_k \sum_{\alpha\alpha'} C_{\alpha\alpha'}(x_k)\,
          \partial^\alpha B_i(x_k)\, \partial^{\alpha'} B'_j(x_k)

The second space is a small one (a collar near part of the boundary), so the cells that neither space uses are
skipped and the rest is done cell by cell with dense tables.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.splines import tables
from solvers.web import SplineSpace

WORK = 4_000_000
"""Numbers in the tables of one chunk of cells."""


class CrossAssembler:
    """Accumulates the matrix between two spaces.

    Parameters
    ----------
    rows, columns
        The spaces; both on the same grid.
    """

    def __init__(self, rows: SplineSpace, columns: SplineSpace) -> None:
        self.rows, self.columns = rows, columns
        self._used = used_cells(rows) & used_cells(columns)
        self._triplets: list[tuple[NDArray[np.int64], NDArray[np.int64], Array]] = []

    def add(
        self,
        batch: TensorBatch | PointBatch,
        blocks: Mapping[tuple[int, int], Array],
        loads: Mapping[int, Array],
    ) -> None:
        """Add the integrals over `batch`; there are no loads between two spaces.

        Raises
        ------
        ValueError
            A load is given.
        """
        if loads:
            raise ValueError("a form between two spaces has no load")
        chosen = np.flatnonzero(self._used[tuple(batch.cells.T)])
        if not len(chosen) or not blocks:
            return
        order = order_of(blocks, len(self.rows.shape))
        nodes = node_table(batch)
        sizes = [(space.degree + 1) ** len(space.shape) for space in (self.rows, self.columns)]
        step = max(1, WORK // (nodes.shape[1] * sum(sizes) * len(multi_indices(len(self.rows.shape), order))))
        for start in range(0, len(chosen), step):
            piece = chosen[start : start + step]
            where = nodes if len(nodes) == 1 else nodes[piece]
            left, right = (spline_table(space, where, order) for space in (self.rows, self.columns))
            element = np.zeros((len(piece), *sizes))
            for alpha in {a for a, _ in blocks}:
                image = sum(
                    values[piece][:, :, None] * right[b] for (a, b), values in blocks.items() if a == alpha
                )
                element += np.matmul(left[alpha].swapaxes(1, 2), np.asarray(image))
            first, second = (local_indices(space, batch.cells[piece]) for space in (self.rows, self.columns))
            self._triplets.append(
                (
                    np.broadcast_to(first[:, :, None], element.shape).ravel(),
                    np.broadcast_to(second[:, None, :], element.shape).ravel(),
                    element.ravel(),
                )
            )

    def finish(self) -> tuple[Any, Array]:
        """Matrix (n_dofs of rows, n_dofs of columns) as CSR, and an empty load."""
        from scipy.sparse import coo_array

        shape = (int(np.prod(self.rows.shape)), int(np.prod(self.columns.shape)))
        if not self._triplets:
            return coo_array((self.rows.n_dofs, self.columns.n_dofs)).tocsr(), np.zeros(0)
        i, j, values = (np.concatenate(part) for part in zip(*self._triplets, strict=True))
        full = coo_array((values, (i, j)), shape=shape).tocsr()
        return (self.rows.extension @ full @ self.columns.extension.T).tocsr(), np.zeros(0)


def used_cells(space: SplineSpace) -> NDArray[np.bool_]:
    """Cells on which some relevant spline of the space lives."""
    relevant = np.zeros(int(np.prod(space.shape)), dtype=bool)
    relevant[space.free.dofs] = True
    relevant[space.free.outer] = True
    relevant = relevant.reshape(space.shape)
    for axis in range(relevant.ndim):
        view = np.moveaxis(relevant, axis, 0)
        cells = view.shape[0] - space.degree
        relevant = np.moveaxis(
            reduce(np.logical_or, [view[s : s + cells] for s in range(space.degree + 1)]), 0, axis
        )
    return relevant


def order_of(blocks: Mapping[tuple[int, int], Array], dimension: int) -> int:
    """Highest derivative among the keys of `blocks`."""
    highest = max(max(key) for key in blocks)
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
