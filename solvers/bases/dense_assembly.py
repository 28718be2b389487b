r"""Assembly for bases whose functions all overlap: one dense matrix.

At points, :math:`A = \sum_{\alpha\alpha'} B_\alpha^T C_{\alpha\alpha'} B_{\alpha'}` with the tables
:math:`B_\alpha` of the derivatives, points as rows, in chunks of points that keep the tables small. A symmetric form is
given by its blocks with ``alpha <= alpha'``; each is added once, those on the diagonal halved, and the sum is made
symmetric at the end.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.bases.basis import Blocks, Loads
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import PointBatch, TensorBatch

WORK = 1_500_000
"""Numbers in the tables of one chunk of points."""


class Tabulated(Protocol):
    """A space whose functions can be tabulated at points."""

    @property
    def grid(self) -> Grid: ...  # noqa: D102
    @property
    def n_dofs(self) -> int: ...  # noqa: D102

    def table(self, cells: Integers, nodes: Array, order: int) -> Array:
        """Derivatives at the nodes (n, q, d) of cells (n, d), shape (n_alpha, n * q, n_dofs)."""
        ...


class DenseAssembler:
    """Accumulates the dense matrix and the load of a space over batches of cells.

    Parameters
    ----------
    space
        Space of the unknown.
    symmetric
        The form is symmetric; its blocks are given for ``alpha <= alpha'`` only.
    """

    def __init__(self, space: Tabulated, symmetric: bool = True) -> None:
        self.space, self.symmetric = space, symmetric
        self.matrix = np.zeros((space.n_dofs, space.n_dofs))
        self.load = np.zeros(space.n_dofs)

    def add(self, batch: TensorBatch | PointBatch, blocks: Blocks, loads: Loads) -> None:
        """Add the integrals over `batch`; see :meth:`solvers.assembly.Assembler.add`."""
        if not len(batch.cells) or not (blocks or loads):
            return
        dimension = batch.cells.shape[1]
        order = order_of(blocks, loads, dimension)
        count = batch.weights.shape[1]
        rows = count * len(multi_indices(dimension, order)) * self.space.n_dofs
        step = max(1, WORK // rows)
        for start in range(0, len(batch.cells), step):
            piece = slice(start, start + step)
            cells = batch.cells[piece]
            if isinstance(batch, TensorBatch):
                nodes = np.broadcast_to(batch.unit_points(), (len(cells), count, dimension))
            else:
                nodes = batch.nodes[piece]
            table = self.space.table(cells, nodes, order)
            self._add_rows(table, {k: v[piece].ravel() for k, v in blocks.items()})
            for alpha, values in loads.items():
                self.load += values[piece].ravel() @ table[alpha]

    def finish(self) -> tuple[Any, Array]:
        """Matrix (n_dofs, n_dofs) and load (n_dofs,)."""
        return (self.matrix + self.matrix.T if self.symmetric else self.matrix), self.load

    def _add_rows(self, table: Array, blocks: Blocks) -> None:
        """Add ``sum B_a^T C_ab B_b`` for coefficients (points,)."""
        for alpha in sorted({a for a, _ in blocks}):
            image = np.zeros(table.shape[1:])
            for (a, b), values in blocks.items():
                if a == alpha:
                    image += (values * self.share(a, b))[:, None] * table[b]
            self.matrix += table[alpha].T @ image

    def share(self, alpha: int, beta: int) -> float:
        """Factor of a block: half for those on the diagonal of a symmetric form."""
        return 0.5 if self.symmetric and alpha == beta else 1.0


def order_of(blocks: Blocks | Mapping[Any, Array], loads: Loads, dimension: int) -> int:
    """Highest order of derivative among the keys."""
    highest = max([*(max(key) for key in blocks), *loads], default=0)
    order = 0
    while len(multi_indices(dimension, order)) <= highest:
        order += 1
    return order
