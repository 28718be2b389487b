"""The methods by name, and the automatic choice among them.

The choice is a list of methods to try in turn. Conjugate gradients with overrelaxation come first on a sparse matrix:
on WEB systems of low degree they beat every factorisation, and when the condition number is too large for them, the
steps they were allowed have cost a fraction of what follows: geometric multigrid for splines on a grid, algebraic
multigrid or a factorisation otherwise. Splines of high degree (5 in 2D, 4 in 3D) or on a fine grid start with
multigrid. Processor seconds on one core of a busy machine: 146864 unknowns of degree 2 in 3D, 1.1 s against 2.4
(Jacobi's preconditioner) and 2.7 (multigrid); 194284 of degree 2 in 2D, 1.5 s against 1.2 (multigrid).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

from rfm.calculus.types import Array
from solvers.linear.direct import DenseCholesky, Pardiso, SuperLU
from solvers.linear.iterative import ConjugateGradients, Multigrid
from solvers.linear.multigrid import GeometricMultigrid
from solvers.linear.pivoted import PivotedCholesky
from solvers.linear.relaxation import Overrelaxation
from solvers.linear.system import ScaledSystem

if TYPE_CHECKING:
    from solvers.linear.lattice import Lattice

SMALL = 800
"""Unknowns up to which a sparse matrix is solved as a dense one."""
DENSE_LIMIT = 8000
"""Unknowns up to which a dense factorisation fits comfortably into memory."""
SPARSE_LIMIT = 6_000_000
"""Entries up to which a sparse factorisation is tried."""
LOW_DEGREE_ROW = 160
"""Entries a row up to which multigrid is robust: degree 6 in 2D, but 2 in 3D."""
TRIAL = (40, 200)
"""Fewest and most steps that conjugate gradients are allowed before a factorisation."""
FINE = 400
"""Indices along an axis above which overrelaxation needs more steps than multigrid costs."""
FILL = {0: (2.5e-6, 0.0), 2: (3.3e-7, 0.6), 3: (7e-7, 1.2)}
"""Seconds of SuperLU for an entry at 2500 unknowns, and how they grow with their number, by dimension."""
MULTIGRID = 180
"""Steps of conjugate gradients that a solution by multigrid costs."""
QUICK = 0.1
"""Seconds of a factorisation below which it is taken at once: importing PyAMG's sweeps costs more."""
CYCLES = 100
"""Cycles that multigrid is allowed before a factorisation."""


class Method(Protocol):
    """What every method does."""

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solution of the scaled system and the iterations it took."""
        ...


@dataclass(frozen=True)
class Candidate:
    """A method to try, and why."""

    name: str
    method: Method
    reason: str


class MatrixFree(ABC):
    """A symmetric matrix that is known by its products only, and brings the method that suits it.

    Attributes
    ----------
    shape
        Its shape (n, n).
    data
        Numbers that are finite when all that it is made of are.
    """

    shape: tuple[int, int]
    data: Array

    @abstractmethod
    def __matmul__(self, vector: Array) -> Array:
        """``A x`` of a vector (n,)."""

    @abstractmethod
    def diagonal(self) -> Array:
        """Diagonal (n,), or numbers of its size that are positive where it is."""

    @abstractmethod
    def candidate(self) -> Candidate:
        """Method for systems with this matrix."""


METHODS: dict[str, Method] = {
    "dense": DenseCholesky(),
    "pivoted": PivotedCholesky(),
    "superlu": SuperLU(),
    "pardiso": Pardiso(),
    "cg": ConjugateGradients(),
    "ssor": Overrelaxation(),
    "multigrid": GeometricMultigrid(),
    "amg": Multigrid(),
}


def choose(system: ScaledSystem) -> list[Candidate]:
    """Methods for the system, in the order they are to be tried."""
    n = len(system.load)
    if not system.sparse:
        return [Candidate("dense", METHODS["dense"], f"{n} unknowns, densely coupled")]
    if n <= SMALL:
        return [Candidate("dense", METHODS["dense"], f"only {n} unknowns")]
    entries = int(system.original.nnz)
    size = f"{n} unknowns with {entries / n:.0f} entries a row"
    seconds, direct = _factorisation(n, entries, size, system.lattice)
    if direct is not None and seconds < QUICK:
        return [replace(direct, reason=f"{size}: a factorisation is quick")]
    step = 2e-9 * entries + 5e-5
    trial = int(min(max(0.5 * seconds / step, TRIAL[0]), TRIAL[1]))
    reason = f"{size}: conjugate gradients alone would need more than {trial} steps"
    found = [Candidate("ssor", Overrelaxation(trial), f"{size}: cheaper than a factorisation")]
    if system.lattice is not None:
        if hard(system.lattice):
            found = []
            if direct is not None and seconds < MULTIGRID * step:
                found = [replace(direct, reason=f"{size}: cheaper than multigrid")]
                direct = None
            shape = "x".join(map(str, system.lattice.shape))
            reason = f"{size}, {shape} splines of degree {system.lattice.degree}: too many steps otherwise"
        found.append(Candidate("multigrid", GeometricMultigrid(CYCLES), reason))
    elif entries / n <= LOW_DEGREE_ROW:
        found.append(Candidate("amg", Multigrid(CYCLES), reason))
    if direct is not None:
        found.append(direct)
    reason = f"{size}: too many for a factorisation, multigrid does not converge"
    found.append(Candidate("ssor", METHODS["ssor"], reason))
    return found


def hard(lattice: Lattice) -> bool:
    """Whether overrelaxation is a poor preconditioner for splines of this degree or on this grid."""
    return lattice.degree + len(lattice.shape) > 6 or max(lattice.shape) > FINE


def _factorisation(
    n: int, entries: int, size: str, lattice: Lattice | None
) -> tuple[float, Candidate | None]:
    """Seconds of the cheapest factorisation, as measured on one core, and the factorisation if it is affordable.

    SuperLU takes 3.3e-7 s an entry for 2500 unknowns in the plane, 7e-7 in space; the fill grows with the unknowns.
    """
    reason = f"{size}: iterative methods converge too slowly"
    an_entry, growth = FILL.get(0 if lattice is None else len(lattice.shape), FILL[0])
    dense, sparse = n**3 / 45e9, an_entry * (n / 2500) ** growth * entries
    if Pardiso.available() and entries <= SPARSE_LIMIT:
        return 0.2 * sparse, Candidate("pardiso", METHODS["pardiso"], f"{reason}, and pypardiso is installed")
    if n <= DENSE_LIMIT and dense <= sparse:
        return dense, Candidate("dense", METHODS["dense"], reason)
    if entries <= SPARSE_LIMIT:
        return sparse, Candidate("superlu", METHODS["superlu"], reason)
    return sparse, None
