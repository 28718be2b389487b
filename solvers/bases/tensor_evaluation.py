"""Evaluation of tensor products of global functions on the nodes of a batch.

Tensor batches are treated on the tensor grid of all their nodes: the cells of a *slab* (a range of cells in the first
direction) are placed in it, so that one table serves a whole direction.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rfm.calculus.types import Array
from solvers.bases.lines import Line
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import TensorBatch


@dataclass(frozen=True, eq=False)
class Slab:
    """Rows of a tensor batch whose cells fill a box of cells more or less.

    Attributes
    ----------
    rows
        Rows of the batch.
    lower, shape
        The box: its lowest cell, its number of cells in each direction.
    cells
        Cells relative to `lower`, shape (n, d).
    nodes
        Nodes of a cell, the same in each direction.
    """

    rows: Integers
    lower: Integers
    shape: tuple[int, ...]
    cells: Integers
    nodes: Array

    def place(self, values: Array) -> Array:
        """Values (n, m^d) of the batch on the tensor grid of the box, zero elsewhere."""
        d, m = len(self.shape), len(self.nodes)
        box = np.zeros((*self.shape, *(m,) * d))
        box[tuple(self.cells.T)] = values[self.rows].reshape(-1, *(m,) * d)
        order = [axis for j in range(d) for axis in (j, d + j)]
        return box.transpose(order).reshape([n * m for n in self.shape])

    def gather(self, grid_values: Array) -> Array:
        """Values (n, m^d) on the cells from values on the tensor grid of the box."""
        d, m = len(self.shape), len(self.nodes)
        split = grid_values.reshape([size for n in self.shape for size in (n, m)])
        cells_first = split.transpose([2 * j for j in range(d)] + [2 * j + 1 for j in range(d)])
        found: Array = cells_first[tuple(self.cells.T)].reshape(len(self.cells), -1)
        return found

    @cached_property
    def steps(self) -> tuple[Array, ...]:
        """Coordinates of the nodes in cells, one array for each direction."""
        return tuple(
            (low + np.arange(n)[:, None] + self.nodes).ravel()
            for low, n in zip(self.lower, self.shape, strict=True)
        )

    def tables(self, line: Line, degree: int, grid: Grid, order: int) -> list[Array]:
        """Derivatives of the line's functions at the nodes in each direction, (order + 1, nodes, count)."""
        return [
            physical(line.table(degree, step / grid.cells[j], order), grid, j)
            for j, step in enumerate(self.steps)
        ]


def slabs(batch: TensorBatch, most_nodes: int) -> Iterator[Slab]:
    """Cut a batch into slabs whose tensor grids have at most about `most_nodes` nodes."""
    if not len(batch.cells):
        return
    cells = np.asarray(batch.cells)
    layer = len(batch.nodes) ** cells.shape[1] * int(np.prod(np.ptp(cells[:, 1:], axis=0) + 1))
    thickness = max(1, most_nodes // layer)
    number = (cells[:, 0] - cells[:, 0].min()) // thickness
    for k in np.unique(number):
        rows = np.flatnonzero(number == k)
        lower = cells[rows].min(axis=0)
        shape = tuple(int(n) for n in cells[rows].max(axis=0) - lower + 1)
        yield Slab(rows, lower, shape, cells[rows] - lower, batch.nodes)


def point_tables(
    line: Line, degree: int, grid: Grid, cells: Integers, nodes: Array, order: int
) -> list[Array]:
    """Derivatives at scattered points (n, q, d): for each direction (order + 1, n * q, count)."""
    unit = (cells[:, None, :] + nodes) / grid.cells
    flat = unit.reshape(-1, unit.shape[-1])
    return [physical(line.table(degree, flat[:, j], order), grid, j) for j in range(flat.shape[1])]


def physical(table: Array, grid: Grid, axis: int) -> Array:
    """Derivatives with respect to x from those with respect to the unit coordinate of the box (in place)."""
    length = float(grid.spacing[axis] * grid.cells[axis])
    for r in range(1, len(table)):
        table[r] /= length**r
    return table


def on_tensor_grid(coefficients: Array, tables: Sequence[Array], alpha: Sequence[int]) -> Array:
    """Derivative alpha of a tensor expansion on a tensor grid of nodes."""
    values = coefficients
    for table, r in zip(tables, alpha, strict=True):
        values = np.tensordot(values, table[r], axes=(0, 1))  # the contracted axis leaves, the nodes go last
    return values


def on_points(coefficients: Array, tables: Sequence[Array], alpha: Sequence[int]) -> Array:
    """Derivative alpha of a tensor expansion at scattered points."""
    values = np.tensordot(tables[0][alpha[0]], coefficients, axes=(1, 0))
    for table, r in zip(tables[1:], alpha[1:], strict=True):
        values = np.einsum("qi...,qi->q...", values, table[r])
    return values
