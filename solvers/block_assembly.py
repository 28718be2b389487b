r"""Assembly for several unknown splines: a matrix of blocks, one for each pair of them.

A vector field has one spline for each component, a structure with a collar correction has a second spline of lower
degree near the boundary.  With :math:`\psi_m` in the space m, the quadratic functional of
:mod:`solvers.equations.density` gives :math:`A_{mm'}` and :math:`f_m`; pairs of one space are assembled by what
:meth:`solvers.bases.basis.Space.assembler` gives, pairs of different spaces by
:class:`solvers.cross_assembly.CrossAssembler`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.bases.basis import Accumulator, Psi, Space
from solvers.corners.space import CornerSpace, SplineCornerAssembler
from solvers.cross_assembly import CrossAssembler
from solvers.equations.density import Blocks, Loads
from solvers.problem import SolverOptions
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.web import SplineSpace

if TYPE_CHECKING:
    from solvers.assembly_stencil import Stencil

Key = tuple[int, int]

LARGE = 2000
"""Unknowns above which a dense matrix of blocks is made sparse, when it is."""
MOSTLY_ZERO = 0.4
"""Part of the entries up to which a matrix counts as sparse."""


class BlockAssembler:
    """Accumulates the matrix and the load of several splines over batches of cells.

    Parameters
    ----------
    spaces
        Space of each spline; splines that share one space share the object.
    symmetric
        The form is symmetric; blocks are then given for ``(m, alpha) <= (m', alpha')`` only.
    """

    def __init__(self, spaces: Sequence[Space], symmetric: bool = True) -> None:
        self.spaces, self.symmetric = tuple(spaces), symmetric
        self._pairs: dict[Key, Accumulator] = {}
        for m, space in enumerate(self.spaces):
            self._pairs[m, m] = space.assembler(symmetric)

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

    def stencils(self) -> dict[Key, Stencil]:
        """Matrices of all B-splines, for those pairs of splines that share one space."""
        from solvers.assembly import Assembler

        return {key: pair.stencil for key, pair in self._pairs.items() if isinstance(pair, Assembler)}

    def functions(self, unknowns: Array) -> tuple[Psi, ...]:
        """The function of each spline."""
        ends = np.cumsum([space.n_dofs for space in self.spaces])
        parts = np.split(unknowns, ends[:-1])
        return tuple(space.function(part) for space, part in zip(self.spaces, parts, strict=True))

    def constant(self) -> Array:
        """Unknowns of splines that are all 1."""
        return np.concatenate([space.constant for space in self.spaces])

    def options(self, options: SolverOptions) -> SolverOptions:
        """Options that let the linear solver choose among unknowns that depend on each other."""
        return replace(options, redundant=any(space.redundant for space in self.spaces))

    def _pair(self, m: int, other: int) -> Accumulator:
        if (m, other) not in self._pairs:
            first, second = self.spaces[m], self.spaces[other]
            self._pairs[m, other] = (
                first.assembler(symmetric=False) if first is second else between(first, second)
            )
        return self._pairs[m, other]


def between(first: Space, second: Space) -> Accumulator:
    """Assembler of a form between two different spaces.

    Raises
    ------
    DiscretizationError
        They are not both spaces of splines.
    """
    if isinstance(first, SplineSpace) and isinstance(second, SplineSpace):
        return CrossAssembler(first, second)
    if isinstance(first, SplineSpace) and isinstance(second, CornerSpace):
        return SplineCornerAssembler(first, second)
    raise DiscretizationError(
        "a structure with a second spline in a collar (conditions: exact) needs basis: web-spline or b-spline"
    )


def joined(grid: list[list[Any]], sizes: Sequence[int]) -> Any:
    """One matrix of a square grid of blocks (None: zero); an array when all blocks are arrays.

    A matrix too large for a dense factorisation to be cheap becomes sparse all the same, when it is mostly zero.
    """
    arrays = [block for row in grid for block in row if block is not None]
    dense = all(isinstance(block, np.ndarray) for block in arrays)
    if dense and sum(sizes) > LARGE:
        filled_part = sum(np.count_nonzero(block) for block in arrays) / sum(sizes) ** 2
        dense = filled_part > MOSTLY_ZERO
    if dense:
        filled = [
            [np.zeros((sizes[i], sizes[j])) if block is None else block for j, block in enumerate(row)]
            for i, row in enumerate(grid)
        ]
        return np.block(filled)
    from scipy.sparse import block_array, csr_array

    sparse = [[None if block is None else csr_array(block) for block in row] for row in grid]
    return block_array(sparse, format="csr")
