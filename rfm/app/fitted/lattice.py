"""Cells of the background grid divided into subcells, whose corners are numbered once.

Corners have integer coordinates on the finest lattice that any subcell uses, so equal corners of
different cells are recognised without comparing coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from rfm.app.fitted.simplices import Ints
from rfm.calculus.types import Array


@dataclass(frozen=True)
class Lattice:
    """The finest lattice: `fine` intervals per cell in every direction.

    Attributes
    ----------
    lower, spacing
        Lower corner of the grid and the sides of its cells, each of length d.
    cells
        Number of cells in every direction.
    """

    lower: Array
    spacing: Array
    cells: Ints
    fine: int

    def subcells(self, cells: Ints, divisions: int) -> Ints:
        """Corners (n * divisions^d, 2^d) of the subcells of `cells` (n, d), as flat lattice indices.

        The corners of a subcell are in C order: the last direction varies fastest.
        """
        dimension, step = len(self.cells), self.fine // divisions
        strides = self._strides()
        cell_starts = (cells * self.fine) @ strides
        offsets = np.array(list(product(range(divisions), repeat=dimension))) * step @ strides
        corners = np.array(list(product((0, step), repeat=dimension))) @ strides
        starts = (cell_starts[:, None] + offsets).reshape(-1, 1)
        return np.asarray(starts + corners, dtype=np.int64)

    def number(self, blocks: Sequence[Ints]) -> tuple[Array, list[Ints]]:
        """Coordinates of the corners in use (n, d) and the blocks renumbered to them."""
        shape = self.cells * self.fine + 1
        used = np.zeros(int(np.prod(shape)), dtype=bool)
        for block in blocks:
            used[block] = True
        flat = np.flatnonzero(used)
        new = np.empty(len(used), dtype=np.int32)
        new[flat] = np.arange(len(flat), dtype=np.int32)
        indices = np.stack(np.unravel_index(flat, tuple(shape)), axis=1)
        coordinates = self.lower + indices * (self.spacing / self.fine)
        return coordinates, [new[block].astype(np.int64) for block in blocks]

    def _strides(self) -> Ints:
        shape = self.cells * self.fine + 1
        return np.append(np.cumprod(shape[:0:-1])[::-1], 1).astype(np.int64)


def kuhn_simplices(dimension: int) -> Ints:
    """Corners (d!, d + 1) of the simplices that fill a cell, corners in C order, volumes positive.

    Every simplex walks from the lowest to the highest corner along the axes in one order (Kuhn's
    triangulation); neighbouring cells cut their common face alike.
    """
    simplices = []
    for order in permutations(range(dimension)):
        steps = [2 ** (dimension - 1 - axis) for axis in order]
        walk = [sum(steps[:count]) for count in range(dimension + 1)]
        inversions = sum(a > b for n, a in enumerate(order) for b in order[n + 1 :])
        if inversions % 2:
            walk[0], walk[1] = walk[1], walk[0]
        simplices.append(walk)
    return np.array(simplices, dtype=np.int64)
