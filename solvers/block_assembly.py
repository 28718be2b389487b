r"""Assembly for several unknown splines: a matrix of blocks, one for each pair of them.

A vector field has one spline for each component, a structure with a collar correction has a second spline of lower
degree near the boundary.  With :math:`\psi_m` in the space m, the quadratic functional of
:mod:`solvers.equations.density` gives :math:`A_{mm'}` and :math:`f_m`; pairs of one space are assembled by
:class:`solvers.assembly.Assembler`, pairs of different spaces by :class:`solvers.cross_assembly.CrossAssembler`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.assembly import Assembler
from solvers.cross_assembly import CrossAssembler
from solvers.equations.density import Blocks, Loads
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.web import SplineSpace

Key = tuple[int, int]


class BlockAssembler:
    """Accumulates the matrix and the load of several splines over batches of cells.

    Parameters
    ----------
    spaces
        Space of each spline; splines that share one space share the object.
    symmetric
        The form is symmetric; blocks are then given for ``(m, alpha) <= (m', alpha')`` only.
    """

    def __init__(self, spaces: Sequence[SplineSpace], symmetric: bool = True) -> None:
        self.spaces, self.symmetric = tuple(spaces), symmetric
        self._pairs: dict[Key, Assembler | CrossAssembler] = {}
        for m, space in enumerate(self.spaces):
            self._pairs[m, m] = Assembler(space, symmetric)

    def add(self, batch: TensorBatch | PointBatch, blocks: Blocks, loads: Loads) -> None:
        """Add the integrals over `batch`; see :func:`solvers.equations.density.pull_back` for the keys."""
        matrices: dict[Key, dict[Key, Array]] = {(m, m): {} for m in range(len(self.spaces))}
        for ((m, alpha), (other, beta)), values in blocks.items():
            matrices.setdefault((m, other), {})[alpha, beta] = values
        for (m, other), entries in matrices.items():
            if m == other:
                vector = {alpha: values for (k, alpha), values in loads.items() if k == m}
                self._pairs[m, m].add(batch, entries, vector)
            else:
                self._pair(m, other).add(batch, entries, {})

    def finish(self) -> tuple[Any, Array]:
        """Matrix (array or CSR) and load of all unknowns, spline after spline."""
        count = len(self.spaces)
        finished = {key: pair.finish() for key, pair in self._pairs.items()}
        load = np.concatenate([finished[m, m][1] for m in range(count)])
        if count == 1:
            return finished[0, 0][0], load
        grid = [
            [finished[m, n][0] if (m, n) in finished else None for n in range(count)] for m in range(count)
        ]
        if self.symmetric:
            for m, n in self._pairs:
                if m < n:
                    grid[n][m] = finished[m, n][0].T
        return joined(grid, [space.n_dofs for space in self.spaces]), load

    def split(self, unknowns: Array) -> list[Array]:
        """Full coefficient array of each spline."""
        ends = np.cumsum([space.n_dofs for space in self.spaces])
        parts = np.split(unknowns, ends[:-1])
        return [space.full_coefficients(part) for space, part in zip(self.spaces, parts, strict=True)]

    def _pair(self, m: int, other: int) -> Assembler | CrossAssembler:
        if (m, other) not in self._pairs:
            first, second = self.spaces[m], self.spaces[other]
            pair = Assembler(first, symmetric=False) if first is second else CrossAssembler(first, second)
            self._pairs[m, other] = pair
        return self._pairs[m, other]


def joined(grid: list[list[Any]], sizes: Sequence[int]) -> Any:
    """One matrix of a square grid of blocks (None: zero); an array when all blocks are arrays."""
    if all(block is None or isinstance(block, np.ndarray) for row in grid for block in row):
        filled = [
            [np.zeros((sizes[i], sizes[j])) if block is None else block for j, block in enumerate(row)]
            for i, row in enumerate(grid)
        ]
        return np.block(filled)
    from scipy.sparse import block_array, csr_array

    sparse = [[None if block is None else csr_array(block) for block in row] for row in grid]
    return block_array(sparse, format="csr")
