"""Quadrature rules on many cells at once.

Notation: ``n`` cells, ``d`` directions, ``q`` points a cell.  Nodes are unit coordinates of their cell, weights are
*physical*: the sum of ``weights * f(points)`` is the integral over the pieces of the domain (or of its boundary) that
lie in these cells.  No cell occurs twice in a batch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from solvers.grid import Grid, Integers


@dataclass(frozen=True, eq=False)
class TensorBatch:
    """One tensor grid of nodes shared by all cells, with weights that differ from cell to cell.

    Parameters
    ----------
    cells
        Cell indices, shape ``(n, d)``.
    nodes
        Nodes in ``[0, 1]``, the same in each direction, shape ``(m,)``.
    weights
        Physical weights, shape ``(n, m**d)``, C order (last direction fastest); negative ones may occur in folded
        rules (see :mod:`solvers.quadrature.moments`).
    """

    cells: Integers
    nodes: Array
    weights: Array

    @property
    def size(self) -> int:
        """Number of points."""
        return int(self.weights.size)

    def __len__(self) -> int:
        """Number of cells."""
        return len(self.cells)

    def unit_points(self) -> Array:
        """Return the tensor nodes in unit coordinates, shape ``(m**d, d)``, C order."""
        return np.asarray(list(product(self.nodes, repeat=self.cells.shape[1])), dtype=np.float64)

    def points(self, grid: Grid) -> tuple[Array, ...]:
        """Return physical coordinates, one array ``(n, m**d)`` per direction."""
        return grid.points(self.cells, self.unit_points())

    def take(self, rows: slice) -> TensorBatch:
        """Return some of the cells."""
        return TensorBatch(self.cells[rows], self.nodes, self.weights[rows])

    def chunks(self, max_points: int) -> Iterator[TensorBatch]:
        """Cut into batches of about ``max_points`` points."""
        step = max(1, max_points // max(1, self.weights.shape[1]))
        for start in range(0, len(self), step):
            yield self.take(slice(start, start + step))


@dataclass(frozen=True, eq=False)
class PointBatch:
    """Each cell has points of its own.

    Cells are ordered by their number of points; short rules are padded with zero weights at a repeated valid node, and
    :meth:`chunks` cuts the padding off again.

    Parameters
    ----------
    cells
        Cell indices, shape ``(n, d)``.
    nodes
        Unit coordinates, shape ``(n, q, d)``.
    weights
        Physical weights, shape ``(n, q)``, positive but for the padding.
    normals
        Outward unit normals, shape ``(n, q, d)``, of boundary rules; None for volume rules.
    """

    cells: Integers
    nodes: Array
    weights: Array
    normals: Array | None = None

    @property
    def size(self) -> int:
        """Number of points, padding included."""
        return int(self.weights.size)

    def __len__(self) -> int:
        """Number of cells."""
        return len(self.cells)

    def points(self, grid: Grid) -> tuple[Array, ...]:
        """Return physical coordinates, one array ``(n, q)`` per direction."""
        return grid.points(self.cells, self.nodes)

    def take(self, rows: slice) -> PointBatch:
        """Return some of the cells, without columns that are padding in all of them."""
        weights = self.weights[rows]
        used = np.flatnonzero(weights.any(axis=0)) if weights.size else np.zeros(0, dtype=np.int64)
        q = int(used[-1]) + 1 if used.size else min(1, weights.shape[1])
        normals = None if self.normals is None else self.normals[rows, :q]
        return PointBatch(self.cells[rows], self.nodes[rows, :q], weights[:, :q], normals)

    def chunks(self, max_points: int) -> Iterator[PointBatch]:
        """Cut into batches of at most about ``max_points`` points, padding included."""
        counts = np.count_nonzero(self.weights, axis=1)
        start = 0
        while start < len(self):
            # Rows are sorted by length, so a chunk is as wide as its last row.
            widths = np.maximum.accumulate(np.maximum(counts[start:], 1))
            fits = int(np.searchsorted(widths * np.arange(1, len(widths) + 1), max_points, side="right"))
            stop = start + max(1, fits)
            yield self.take(slice(start, stop))
            start = stop

    @classmethod
    def gather(
        cls, cells: Integers, rows: Integers, nodes: Array, weights: Array, normals: Array | None = None
    ) -> PointBatch:
        """Build a batch from a flat list of points.

        Parameters
        ----------
        cells
            Cells that rows refer to, shape ``(n, d)``; those without a point are left out.
        rows
            Row of ``cells`` each point belongs to, shape ``(N,)``.
        nodes, weights, normals
            Unit coordinates ``(N, d)``, physical weights ``(N,)``, normals ``(N, d)`` or None.
        """
        d = cells.shape[1]
        counts = np.bincount(rows, minlength=len(cells))
        ranking = np.argsort(counts, kind="stable")
        ranking = ranking[counts[ranking] > 0]
        n, q = len(ranking), int(counts.max(initial=0))
        place = np.empty(len(cells), dtype=np.int64)
        place[ranking] = np.arange(n)
        order = np.argsort(rows, kind="stable")
        first = np.zeros(len(cells), dtype=np.int64)
        first[1:] = np.cumsum(counts)[:-1]
        sorted_rows = rows[order]
        column = np.arange(len(rows)) - first[sorted_rows]
        flat = place[sorted_rows] * q + column
        heads = order[first[ranking]] if n else order[:0]

        def fill(values: Array) -> Array:
            padded = np.repeat(values[heads], q, axis=0)
            padded[flat] = values[order]
            return padded.reshape(n, q, d)

        padded_weights = np.zeros(n * q)
        padded_weights[flat] = weights[order]
        return cls(
            cells[ranking],
            fill(nodes),
            padded_weights.reshape(n, q),
            None if normals is None else fill(normals),
        )
