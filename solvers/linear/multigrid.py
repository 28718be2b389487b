r"""Conjugate gradients with geometric multigrid on the two-scale relation of splines.

One V-cycle: a sweep of the multiplicative Schwarz method (:mod:`solvers.linear.schwarz`), the correction of the
coarser lattice (:mod:`solvers.linear.lattice`), the same sweep backwards.  Every level is scaled to a unit diagonal,
which takes care of the weight: near the boundary an entry has the size of the weight's square.

The whole preconditioner is in single precision, as long as the inverses of the tiles, as ill-conditioned as
:math:`4^{pd}`, allow it: half the memory, the same iterations.  Iterations do not depend on the grid, and little on
the degree (docs/spaces.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.extension import Indices
from solvers.linear.iterative import conjugate_gradients
from solvers.linear.lattice import Lattice
from solvers.linear.schwarz import Schwarz, tiled
from solvers.linear.system import ScaledSystem, nbytes

COARSEST = 300
"""Unknowns of a component that are solved for directly; more where half as many cells have over half as many."""
SINGLE = 18
"""``(p + 1) d`` up to which single precision does: degree 8 in the plane, 5 in space."""
MISSING = (
    "the linear solver multigrid needs one grid of splines and an energy, which global bases, periodic splines, "
    "several spaces (conditions: exact, interfaces) and least squares do not have: choose auto"
)


@dataclass(frozen=True, eq=False)
class Level:
    """The smoother of a matrix with unit diagonal, and the prolongation from the next coarser one."""

    smoother: Schwarz
    prolongation: Any


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """Levels from fine to coarse, and the inverse on the coarsest lattice."""

    levels: tuple[Level, ...]
    inverse: Array

    def cycle(self, load: Array, depth: int = 0) -> Array:
        """One V-cycle from zero."""
        if depth == len(self.levels):
            coarse: Array = self.inverse @ load
            return coarse
        level = self.levels[depth]
        x = np.zeros_like(load)
        level.smoother.sweep(x, load)
        rest = level.prolongation.T @ (load - level.smoother.matrix @ x)
        x += level.prolongation @ self.cycle(rest, depth + 1)
        level.smoother.sweep(x, load, backwards=True)
        return x

    @property
    def nbytes(self) -> int:
        """Memory of all levels."""
        sparse = nbytes(*(m for level in self.levels for m in (level.smoother.matrix, level.prolongation)))
        return sparse + sum(level.smoother.nbytes for level in self.levels) + int(self.inverse.nbytes)

    def __call__(self, load: Array) -> Array:
        """V-cycle for a load in double precision."""
        return self.cycle(load.astype(self.inverse.dtype)).astype(float)


@dataclass(frozen=True)
class GeometricMultigrid:
    """Conjugate gradients with a V-cycle on the lattice of the system."""

    limit: int = 200

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve to the relative residual `tolerance`.

        Raises
        ------
        NumericsError
            The system is not one of splines on a grid.
        """
        if system.lattice is None:
            raise NumericsError(MISSING)
        cycle = hierarchy(system, system.lattice)
        system.kept["multigrid"] = cycle.nbytes
        return conjugate_gradients(system.apply, system, tolerance, self.limit, cycle)


def hierarchy(system: ScaledSystem, lattice: Lattice) -> Hierarchy:
    """Levels of a system on a lattice."""
    from scipy.sparse import block_diag, csr_array

    components, kind = lattice.components, precision(lattice)
    matrix, scale = csr_array(system.original), system.scale
    matrix.sort_indices()
    levels = []
    while lattice.size > COARSEST:
        coarse, one = lattice.coarser()
        if 2 * coarse.size > lattice.size:
            break
        smoother = Schwarz.of(matrix, scale, tiles(lattice), kind)
        matrix = coarse.matrix()
        prolongation = csr_array(block_diag([one] * components, format="csr") if components > 1 else one)
        prolongation.data *= np.repeat(1.0 / scale, np.diff(prolongation.indptr))
        diagonal = matrix.diagonal()
        scale = np.where(diagonal > 0, diagonal, 1.0) ** -0.5
        prolongation.data *= scale[prolongation.indices]
        levels.append(Level(smoother, prolongation.astype(kind)))
        lattice = coarse
    # the pseudo-inverse, for a matrix with a null space has one on every level
    full = scale[:, None] * matrix.toarray() * scale
    inverse = np.linalg.pinv(full, rcond=1e-13, hermitian=True)
    return Hierarchy(tuple(levels), inverse.astype(kind))


def precision(lattice: Lattice) -> DTypeLike:
    """Precision of the preconditioner."""
    return np.float32 if (lattice.degree + 1) * len(lattice.shape) <= SINGLE else np.float64


def tiles(lattice: Lattice) -> Indices:
    """Tiles of all components, filled up with -1."""
    one = tiled(lattice, *tiling(lattice.degree, len(lattice.shape)))
    shifted = [np.where(one < 0, -1, one + c * lattice.size) for c in range(lattice.components)]
    # tiles of all components know conditions that couple them (slip); of high degree in space they would be too large
    return np.concatenate(shifted, axis=1 if len(lattice.shape) < 3 or lattice.degree < 4 else 0)


def tiling(degree: int, dimension: int) -> tuple[int, int]:
    """Edge and distance of the tiles: the more they overlap, the fewer the iterations, and the more memory."""
    if degree < 4:
        return 4, 3
    return (2 * degree - 2, degree) if dimension < 3 or degree < 6 else (8, 4)
