r"""Assembly for tensor products of global functions, by sum factorisation.

On the tensor grid of all nodes of a batch (coefficients are zero off the domain's cells)

.. math:: A_{(i_1 i_2)(j_1 j_2)} = \sum_{k_1} B_{i_1 k_1} B'_{j_1 k_1}
          \Bigl(\sum_{k_2} C_{k_1 k_2} B_{i_2 k_2} B'_{j_2 k_2}\Bigr),

one direction after the other with tables of products, of :math:`n^2` columns for n functions a direction. With K
nodes a direction that is some :math:`K^2 n^2 + K n^4` products in the plane where points as rows cost
:math:`K^2 n^4`. Blocks that agree in the derivatives of the directions still to come are added before they are
contracted. Scattered points (boundary rules) are treated as rows of a dense table.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.bases.basis import Blocks, Loads
from solvers.bases.dense_assembly import DenseAssembler, order_of
from solvers.bases.tensor import TensorSpace
from solvers.bases.tensor_evaluation import slabs
from solvers.quadrature.batch import PointBatch, TensorBatch

NODES = 600_000
"""Nodes of a slab."""
INTERMEDIATE = 12_000_000
"""Numbers in the largest intermediate array of a slab."""

Pairs = tuple[tuple[int, int], ...]
"""Derivatives of the two factors in each direction."""


class TensorAssembler(DenseAssembler):
    """Accumulates the dense matrix and the load of a tensor space over batches of cells."""

    def __init__(self, space: TensorSpace, symmetric: bool = True) -> None:
        super().__init__(space, symmetric)
        self.tensor = space
        self._pairs = np.zeros((space.count**2,) * space.grid.dimension)

    def add(self, batch: TensorBatch | PointBatch, blocks: Blocks, loads: Loads) -> None:
        """Add the integrals over `batch`; see :meth:`solvers.assembly.Assembler.add`."""
        if isinstance(batch, PointBatch) or not len(batch.cells):
            super().add(batch, blocks, loads)
            return
        d, space = batch.cells.shape[1], self.tensor
        order = order_of(blocks, loads, d)
        alphas = multi_indices(d, order)
        for slab in slabs(batch, self._most_nodes(batch, len(blocks))):
            tables = slab.tables(space.line, space.degree, space.grid, order)
            single = {alphas[alpha]: slab.place(values) for alpha, values in loads.items()}
            if single:
                self.load += contracted(single, partial(_single, tables)).ravel()
            products = Products(tables)
            double: dict[Pairs, Array] = {}
            for (alpha, beta), values in blocks.items():
                key = tuple(zip(alphas[alpha], alphas[beta], strict=True))
                placed = self.share(alpha, beta) * slab.place(values)
                double[key] = double[key] + placed if key in double else placed
            if double:
                self._pairs += contracted(double, products)

    def finish(self) -> tuple[Any, Array]:
        """Matrix (n_dofs, n_dofs) and load (n_dofs,)."""
        d, n = self.tensor.grid.dimension, self.tensor.count
        order = [2 * j for j in range(d)] + [2 * j + 1 for j in range(d)]
        self.matrix += self._pairs.reshape((n,) * (2 * d)).transpose(order).reshape(self.matrix.shape)
        self._pairs[:] = 0.0
        return super().finish()

    def _most_nodes(self, batch: TensorBatch, blocks: int) -> int:
        """Nodes of a slab for which neither the coefficients nor the intermediate arrays grow too large."""
        d, m = batch.cells.shape[1], len(batch.nodes)
        across = m ** (d - 1) * int(np.prod(np.ptp(batch.cells[:, 1:], axis=0) + 1))
        rows = INTERMEDIATE // self.tensor.count ** (2 * (d - 1))
        return max(1, min(NODES, int(rows * across)) // max(1, blocks // 6))


def _single(tables: list[Array], axis: int, order: int) -> Array:
    table: Array = tables[axis][order]
    return table


class Products:
    """Tables (nodes, n^2) of products of two functions, by direction and derivatives, made when needed."""

    def __init__(self, tables: list[Array]) -> None:
        self._tables = tables
        self._made: dict[tuple[int, tuple[int, int]], Array] = {}

    def __call__(self, axis: int, orders: tuple[int, int]) -> Array:
        """Products of the derivatives `orders` in direction `axis`."""
        key = (axis, orders)
        if key not in self._made:
            left, right = (self._tables[axis][r] for r in orders)
            self._made[key] = (left[:, :, None] * right[:, None, :]).reshape(len(left), -1)
        return self._made[key]


def contracted(stage: Any, table: Any) -> Array:
    """Contract arrays on a tensor grid with the tables that their keys name, last direction first, and add them.

    Parameters
    ----------
    stage
        Arrays (K_1, ..., K_d) by a key with one entry for each direction.
    table
        ``(direction, entry of the key) -> (K, columns)``.
    """
    dimension = len(next(iter(stage)))
    for axis in range(dimension - 1, -1, -1):
        following: dict[Any, Array] = {}
        for key, values in stage.items():
            kept = values.shape[:axis]
            rest = values.shape[axis + 1 :]
            flat = values.reshape(*kept, values.shape[axis], -1)
            image = np.matmul(table(axis, key[axis]).T, flat).reshape(*kept, -1, *rest)
            shorter = key[:axis]
            following[shorter] = following[shorter] + image if shorter in following else image
        stage = following
    result: Array = stage[()]
    return result
