r"""Conjugate gradients with geometric multigrid on the two-scale relation of splines.

One V-cycle: a smoothing step, the correction of the coarser lattice (:mod:`solvers.linear.lattice`), the same
smoothing step again.  A step is Chebyshev's iteration for :math:`B A` on the upper part :math:`[\lambda/10, \lambda]`
of its spectrum (Adams, Brezina, Hu, Tuminaro, J. Comput. Phys. 188, 2003).  For low degrees B is the identity, all
matrices being scaled to a unit diagonal; above it is the additive Schwarz method of :mod:`solvers.linear.schwarz`.
The diagonal scaling also holds the weight: near the boundary an entry has the size of the weight's square.

Iterations do not depend on the grid, and little on the degree (docs/spaces.md).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.linear.iterative import conjugate_gradients
from solvers.linear.lattice import Lattice
from solvers.linear.schwarz import Schwarz, tiled
from solvers.linear.system import ScaledSystem

COARSEST = 300
"""Unknowns of a component that are solved for directly."""
PART = 0.1
"""Part of the spectrum, from above, that smoothing is for."""
POWER = 30
"""Steps of the power method that estimate the largest eigenvalue, and how much is added to be safe.

The modes of the largest eigenvalues sit at the boundary: of a million unknowns a random vector has little of them, and
with 12 steps an estimate too low cost 27 cycles instead of 6."""
SAFETY = 1.1
LOW = 5
"""Degree plus dimension up to which the diagonal smooths in less time than blocks."""
DIAGONAL_STEPS, BLOCK_STEPS = 3, 2
"""Degree of Chebyshev's iteration."""
MISSING = (
    "the linear solver multigrid needs one grid of splines and an energy, which global bases, periodic splines, "
    "several spaces (conditions: exact, interfaces) and least squares do not have: choose auto"
)


@dataclass(frozen=True, eq=False)
class Level:
    """A matrix with unit diagonal, its smoother, and the prolongation from the next coarser one."""

    matrix: Any
    smooth: Callable[[Array, Array], Array]
    prolongation: Any


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
        levels, coarsest = hierarchy(system, system.lattice)
        matrix = levels[0].matrix if levels else system.scaled_sparse()

        def cycle(load: Array, depth: int = 0) -> Array:
            if depth == len(levels):
                return coarsest(load)
            level = levels[depth]
            x = level.smooth(np.zeros_like(load), load)
            rest = level.prolongation.T @ (load - level.matrix @ x)
            return level.smooth(x + level.prolongation @ cycle(rest, depth + 1), load)

        return conjugate_gradients(lambda v: matrix @ v, system, tolerance, self.limit, cycle)


def hierarchy(system: ScaledSystem, lattice: Lattice) -> tuple[list[Level], Callable[[Array], Array]]:
    """Levels from fine to coarse, and the solution on the coarsest lattice."""
    from scipy.sparse import block_diag, csr_array

    components = len(system.load) // lattice.size
    matrix, scale = csr_array(system.scaled_sparse()), system.scale
    levels = []
    while lattice.size > COARSEST:
        coarse, one = lattice.coarser()
        if coarse.size >= lattice.size:
            break
        prolongation = csr_array(block_diag([one] * components, format="csr") if components > 1 else one)
        prolongation.data *= np.repeat(1.0 / scale, np.diff(prolongation.indptr))
        product = csr_array(prolongation.T @ (matrix @ prolongation))
        diagonal = product.diagonal()
        scale = np.where(diagonal > 0, diagonal, 1.0) ** -0.5
        levels.append(Level(matrix, smoother(matrix, lattice, components), _columns(prolongation, scale)))
        matrix = _columns(product, scale)
        matrix.data *= np.repeat(scale, np.diff(matrix.indptr))
        lattice = coarse
    # the pseudo-inverse, for a matrix with a null space has one on every level
    inverse = np.linalg.pinv(matrix.toarray(), rcond=1e-13, hermitian=True)
    return levels, lambda load: inverse @ load


def smoother(matrix: Any, lattice: Lattice, components: int) -> Callable[[Array, Array], Array]:
    """Chebyshev's iteration for a matrix with unit diagonal."""
    dimension = len(lattice.shape)
    coupled = components > 1 and dimension < 3
    if lattice.degree + dimension <= LOW and not coupled:
        return chebyshev(matrix, lambda v: v, DIAGONAL_STEPS)
    one = tiled(lattice, *tiling(lattice.degree, dimension))
    shifted = [np.where(one < 0, -1, one + c * lattice.size) for c in range(components)]
    # tiles of all components know conditions that couple them (slip); in space they would be too large
    tiles = np.concatenate(shifted, axis=1 if coupled else 0)
    return chebyshev(matrix, Schwarz.of(matrix, tiles), BLOCK_STEPS)


def tiling(degree: int, dimension: int) -> tuple[int, int]:
    """Edge and distance of the tiles: the more they overlap, the fewer the iterations, and the more memory."""
    if degree <= 4:
        return degree + 2, degree
    return (8, 4) if dimension == 3 else (2 * degree, degree)


def chebyshev(matrix: Any, block: Callable[[Array], Array], steps: int) -> Callable[[Array, Array], Array]:
    """Chebyshev's iteration for ``B A x = B b`` from a given x (Saad, *Iterative Methods*, 2003, algorithm 12.1)."""
    vector = np.random.default_rng(0).standard_normal(matrix.shape[0])
    largest = 1.0
    for _ in range(POWER):
        vector = block(matrix @ (vector / np.linalg.norm(vector)))
        largest = float(np.linalg.norm(vector))
    top = SAFETY * largest
    middle, half = top * (1 + PART) / 2, top * (1 - PART) / 2

    def smooth(x: Array, load: Array) -> Array:
        rest = load - matrix @ x if x.any() else load
        ratio = half / middle
        change = block(rest) / middle
        x = x + change
        for _ in range(steps - 1):
            rest = rest - matrix @ change
            following = 1.0 / (2 * middle / half - ratio)
            change = following * (ratio * change + (2 / half) * block(rest))
            x, ratio = x + change, following
        return x

    return smooth


def _columns(matrix: Any, factors: Array) -> Any:
    """CSR matrix with scaled columns, in place."""
    matrix.data *= factors[matrix.indices]
    return matrix
