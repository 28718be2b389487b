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
    from rfm.geometry.logic import Mask
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

    def take(self, rows: slice | Integers) -> TensorBatch:
        """Return some of the cells."""
        return TensorBatch(self.cells[rows], self.nodes, self.weights[rows])

    def chunks(self, max_points: int) -> Iterator[TensorBatch]:
        """Cut into batches of about ``max_points`` points."""
        step = max(1, max_points // max(1, self.weights.shape[1]))
        for start in range(0, len(self), step):
            yield self.take(slice(start, start + step))


@dataclass(frozen=True, eq=False)
class PointBatch:
    """Each cell has points of its own, as many as any other.

    Short rules are padded with zero weights at a repeated valid node.

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

    def take(self, rows: slice | Integers) -> PointBatch:
        """Return some of the cells."""
        normals = None if self.normals is None else self.normals[rows]
        return PointBatch(self.cells[rows], self.nodes[rows], self.weights[rows], normals)

    def chunks(self, max_points: int) -> Iterator[PointBatch]:
        """Cut into batches of about ``max_points`` points."""
        step = max(1, max_points // max(1, self.weights.shape[1]))
        for start in range(0, len(self), step):
            yield self.take(slice(start, start + step))


@dataclass(frozen=True, eq=False)
class PointRule:
    """Each cell has points of its own, in any number; stored without padding, ordered by that number.

    Parameters
    ----------
    cells
        Cell indices, shape ``(n, d)``, none twice.
    first
        The points of cell ``i`` are those from ``first[i]`` to ``first[i + 1] - 1``; shape ``(n + 1,)``.
    nodes, weights, normals
        Unit coordinates ``(N, d)``, physical weights ``(N,)``, outward unit normals ``(N, d)`` or None.
    """

    cells: Integers
    first: Integers
    nodes: Array
    weights: Array
    normals: Array | None = None

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.weights)

    def __len__(self) -> int:
        """Number of cells."""
        return len(self.cells)

    @property
    def counts(self) -> Integers:
        """Number of points of each cell, shape ``(n,)``."""
        return np.diff(self.first)

    def points(self, grid: Grid) -> tuple[Array, ...]:
        """Return physical coordinates, one array ``(N,)`` per direction."""
        corners = grid.corners(self.cells)
        where = np.repeat(np.arange(len(self)), self.counts)
        return tuple(corners[where, j] + grid.spacing[j] * self.nodes[:, j] for j in range(grid.dimension))

    def take(self, rows: slice | Integers) -> PointRule:
        """Return some of the cells (in ascending order)."""
        chosen = np.arange(len(self))[rows]
        first, where = members(self.first, chosen)
        normals = None if self.normals is None else self.normals[where]
        return PointRule(self.cells[chosen], first, self.nodes[where], self.weights[where], normals)

    def padded(self) -> PointBatch:
        """Return the rule with as many points in every cell."""
        where, valid = padding(self.first)
        normals = None if self.normals is None else self.normals[where]
        weights = np.where(valid, self.weights[where], 0.0)
        nodes = self.nodes[where].reshape(*where.shape, self.cells.shape[1])
        return PointBatch(self.cells, nodes, weights, normals)

    def chunks(self, max_points: int) -> Iterator[PointBatch]:
        """Cut into padded batches of at most about ``max_points`` points, padding included."""
        for span in spans(self.counts, max_points):
            yield self.take(span).padded()

    @classmethod
    def gather(
        cls, cells: Integers, rows: Integers, nodes: Array, weights: Array, normals: Array | None = None
    ) -> PointRule:
        """Sort a flat list of points by cells.

        Parameters
        ----------
        cells
            Cells that rows refer to, shape ``(n, d)``; those without a point are left out.
        rows
            Row of ``cells`` each point belongs to, shape ``(N,)``.
        nodes, weights, normals
            As of the rule.
        """
        ranking, first, order = ranked(rows, len(cells))
        normals = None if normals is None else normals[order]
        return cls(cells[ranking], first, nodes[order], weights[order], normals)


def ranked(rows: Integers, count: int) -> tuple[Integers, Integers, Integers]:
    """Order rows by how many entries they have.

    Parameters
    ----------
    rows
        Row of each entry, shape ``(N,)``.
    count
        Number of rows.

    Returns
    -------
    tuple
        The rows that have entries, ascending by their number; where the entries of each begin, one number more; and
        the entries in that order.
    """
    counts = np.bincount(rows, minlength=count)
    ranking = np.argsort(counts, kind="stable")
    place = np.empty(count, dtype=np.min_scalar_type(count))
    place[ranking] = np.arange(count)
    # short integers are sorted by their digits, ten times faster than long ones
    order = np.argsort(place[rows], kind="stable")
    ranking = ranking[counts[ranking] > 0]
    return ranking, np.concatenate([[0], np.cumsum(counts[ranking])]), order


def members(first: Integers, chosen: Integers) -> tuple[Integers, Integers]:
    """Where the entries of chosen rows begin among them, and which entries they are."""
    counts = first[chosen + 1] - first[chosen]
    begin = np.concatenate([[0], np.cumsum(counts)])
    return begin, np.repeat(first[chosen] - begin[:-1], counts) + np.arange(begin[-1])


def padding(first: Integers) -> tuple[Integers, Mask]:
    """Entries of all rows in a table ``(n, q)`` as wide as the longest; short rows repeat their first one.

    Returns
    -------
    tuple
        The entries, and where they are not repetitions.
    """
    counts = np.diff(first)
    column = np.arange(int(counts.max(initial=0)))
    valid = column < counts[:, None]
    return first[:-1, None] + np.where(valid, column, 0), valid


def spans(counts: Integers, limit: int) -> Iterator[slice]:
    """Ranges of rows with ascending ``counts`` that hold, padded, at most about ``limit`` entries."""
    start = 0
    while start < len(counts):
        # The last row of a range is the widest.
        sizes = counts[start:] * np.arange(1, len(counts) - start + 1)
        stop = start + max(1, int(np.searchsorted(sizes, limit, side="right")))
        yield slice(start, stop)
        start = stop
