r"""Rules on line segments: what the height functions give, kept as lines until points are asked for.

Notation: a *line* is a segment ``start + [0, length] e_k`` in a cell, ``k`` its ``axis``, in unit coordinates of the
cell; it carries a Gauss rule of ``order`` points whose weights are ``weight * w_q`` (:math:`\sum_q w_q = 1`).  A rule
on ``N`` points is stored as ``N / order`` lines, and its moments are sums over lines
(:mod:`solvers.quadrature.moments`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature.batch import PointBatch, PointRule, members, ranked, spans
from solvers.quadrature.pieces import gauss

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rfm.calculus.types import Array
    from solvers.grid import Grid, Integers

    Axes = NDArray[np.int8]


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines in boxes or cells.

    Attributes
    ----------
    start
        First end, shape ``(L, d)``.
    axis
        Direction, int8, shape ``(L,)``.
    length, weight
        Length and total weight, shape ``(L,)``.
    """

    start: Array
    axis: Axes
    length: Array
    weight: Array

    def __len__(self) -> int:
        """Number of lines."""
        return len(self.weight)

    def take(self, rows: Integers) -> Lines:
        """Return some of the lines."""
        return Lines(self.start[rows], self.axis[rows], self.length[rows], self.weight[rows])

    def points(self, order: int) -> tuple[Array, Array]:
        """Return coordinates ``(N, d)`` and weights ``(N,)`` of Gauss points, `order` on each line."""
        t, w = gauss(order)
        nodes = np.repeat(self.start[:, None, :], order, axis=1)
        for k in range(self.start.shape[1]):
            nodes[:, :, k] += np.where(self.axis == k, self.length, 0.0)[:, None] * t
        return nodes.reshape(-1, nodes.shape[2]), np.multiply.outer(self.weight, w).ravel()


@dataclass(frozen=True, eq=False)
class LineRule:
    """Each cell has lines of its own, in any number; cells are ordered by that number.

    Parameters
    ----------
    cells
        Cell indices, shape ``(n, d)``, none twice.
    begin
        The lines of cell ``i`` are those from ``begin[i]`` to ``begin[i + 1] - 1``; shape ``(n + 1,)``.
    lines
        The lines; weights are physical.
    order
        Gauss points on each line.
    """

    cells: Integers
    begin: Integers
    lines: Lines
    order: int

    @property
    def size(self) -> int:
        """Number of points."""
        return self.order * len(self.lines)

    def __len__(self) -> int:
        """Number of cells."""
        return len(self.cells)

    @property
    def first(self) -> Integers:
        """The points of cell ``i`` are those from ``first[i]`` to ``first[i + 1] - 1``; shape ``(n + 1,)``."""
        return self.order * self.begin

    @property
    def counts(self) -> Integers:
        """Number of points of each cell, shape ``(n,)``."""
        return np.diff(self.first)

    @property
    def nodes(self) -> Array:
        """Unit coordinates of the points, shape ``(N, d)``."""
        return self.lines.points(self.order)[0]

    @property
    def weights(self) -> Array:
        """Physical weights of the points, shape ``(N,)``."""
        return np.multiply.outer(self.lines.weight, gauss(self.order)[1]).ravel()

    def on_points(self) -> PointRule:
        """Return the rule with its points laid out."""
        nodes, weights = self.lines.points(self.order)
        return PointRule(self.cells, self.first, nodes, weights)

    def points(self, grid: Grid) -> tuple[Array, ...]:
        """Return physical coordinates, one array ``(N,)`` per direction."""
        return self.on_points().points(grid)

    def take(self, rows: slice | Integers) -> LineRule:
        """Return some of the cells (in ascending order)."""
        chosen = np.arange(len(self))[rows]
        begin, where = members(self.begin, chosen)
        return LineRule(self.cells[chosen], begin, self.lines.take(where), self.order)

    def padded(self) -> PointBatch:
        """Return the rule with as many points in every cell."""
        return self.on_points().padded()

    def chunks(self, max_points: int) -> Iterator[PointBatch]:
        """Cut into padded batches of at most about ``max_points`` points, padding included."""
        for span in spans(self.counts, max_points):
            yield self.take(span).padded()

    @classmethod
    def gather(
        cls, cells: Integers, rows: Sequence[Integers], parts: Sequence[Lines], order: int
    ) -> LineRule:
        """Sort lines by cells.

        Parameters
        ----------
        cells
            Cells that rows refer to, shape ``(n, d)``; those without a line are left out.
        rows, parts
            Lines with physical weights, and the row of ``cells`` each lies in, in parts.
        order
            Gauss points on each line.
        """
        count = sum(map(len, parts))
        owner = np.concatenate([np.zeros(0, dtype=np.int64), *rows])
        ranking, begin, entries = ranked(owner, len(cells))
        place = np.empty(count, dtype=np.int64)
        place[entries] = np.arange(count)
        lines = Lines(
            np.empty((count, cells.shape[1])),
            np.empty(count, dtype=np.int8),
            np.empty(count),
            np.empty(count),
        )
        done = 0
        # part by part to its place: no copy of all lines in between
        for part in parts:
            at = place[done : done + len(part)]
            lines.start[at], lines.axis[at] = part.start, part.axis
            lines.length[at], lines.weight[at] = part.length, part.weight
            done += len(part)
        return cls(cells[ranking], begin, lines, order)
