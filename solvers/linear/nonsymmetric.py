r"""Linear systems whose matrix is not symmetric (advection).

Rows and columns are equilibrated first, ``R A C y = R b`` with ``x = C y`` (largest entries of about one).  Small or
densely coupled systems are solved by LU factorisation with partial pivoting, larger ones by SuperLU with the column
ordering COLAMD, and those whose factors would not fit by GMRES with an incomplete factorisation (Saad and Schultz,
SIAM J. Sci. Stat. Comput. 7, 1986).  The residual that was reached is computed from the matrix itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.linear import ACCEPTED, LinearSolution
from solvers.linear.choice import SMALL, SPARSE_LIMIT
from solvers.linear.pivoted import PivotedQR
from solvers.linear.system import NotConverged

REFINEMENTS = 2
EPSILON = float(np.finfo(float).eps)
SINGULAR = (
    "the matrix is singular ({why}): the solution is not unique; fix it with a Dirichlet condition, raise "
    "quadrature_points, use basis: web-spline, or lower the degree"
)


@dataclass(frozen=True, eq=False)
class Equilibrated:
    """A system and its row and column scaling."""

    original: Any
    load: Array
    rows: Array
    columns: Array

    @staticmethod
    def of(matrix: Any, load: Array) -> Equilibrated:
        """Check and scale a system.

        Raises
        ------
        NumericsError
            Numbers are not finite, or a row or column is zero.
        """
        entries = matrix if isinstance(matrix, np.ndarray) else matrix.data
        if not (np.isfinite(entries).all() and np.isfinite(load).all()):
            raise NumericsError(
                "the linear system has entries that are not finite: check the data of the problem"
            )
        size = abs(matrix)
        largest = as_vector(size.max(axis=1))
        if not (largest > 0).all():
            raise NumericsError(SINGULAR.format(why=f"row {int(largest.argmin())} is zero"))
        rows = 1.0 / largest
        columns = as_vector(
            (size * rows[:, None] if isinstance(size, np.ndarray) else row_scaled(size, rows)).max(axis=0)
        )
        if not (columns > 0).all():
            raise NumericsError(SINGULAR.format(why=f"column {int(columns.argmin())} is zero"))
        return Equilibrated(matrix, load, rows, 1.0 / columns)

    @property
    def sparse(self) -> bool:
        """Whether the matrix is stored sparse."""
        return not isinstance(self.original, np.ndarray)

    def scaled_array(self) -> Array:
        """Scaled matrix as a new array."""
        array = self.original.toarray() if self.sparse else self.original
        result: Array = array * self.rows[:, None]
        result *= self.columns
        return result

    def scaled_sparse(self) -> Any:
        """Scaled matrix as a new CSC matrix."""
        from scipy.sparse import csr_array

        matrix = row_scaled(csr_array(self.original), self.rows)
        matrix.data *= self.columns[matrix.indices]
        return matrix.tocsc()

    def residual(self, scaled: Array) -> tuple[Array, float]:
        """Residual of a scaled solution, scaled, and the relative one of the original system."""
        difference = self.load - self.original @ (self.columns * scaled)
        return self.rows * difference, float(np.linalg.norm(difference) / np.linalg.norm(self.load))


class GeneralMethod(Protocol):
    """What every method does."""

    def solve(self, system: Equilibrated, tolerance: float) -> tuple[Array, int]:
        """Solution of the scaled system and the iterations it took."""
        ...


@dataclass(frozen=True)
class DenseLU:
    """LU factorisation of the full array (LAPACK getrf)."""

    def solve(self, system: Equilibrated, tolerance: float) -> tuple[Array, int]:
        """Solve; refuses a matrix that is singular to rounding."""
        from scipy.linalg.lapack import dgecon, dgetrf, dgetrs

        array = system.scaled_array()
        norm = float(np.abs(array).sum(axis=0).max())
        factor, pivots, info = dgetrf(array)
        reciprocal = 0.0 if info > 0 else float(dgecon(factor, norm)[0])
        if reciprocal < EPSILON:
            raise NumericsError(SINGULAR.format(why=f"reciprocal condition number {reciprocal:.1e}"))
        return refine(system, lambda b: dgetrs(factor, pivots, b)[0], tolerance)


@dataclass(frozen=True)
class SparseLU:
    """SuperLU with partial pivoting, column ordering COLAMD (Davis et al., ACM TOMS 30, 2004)."""

    def solve(self, system: Equilibrated, tolerance: float) -> tuple[Array, int]:
        """Solve; gives up when the factors do not fit into memory."""
        from scipy.sparse.linalg import splu

        try:
            factors = splu(system.scaled_sparse())
        except RuntimeError as error:
            raise NumericsError(SINGULAR.format(why=str(error))) from error
        except MemoryError as error:
            raise NotConverged(
                "the factors do not fit into memory: choose a coarser grid of a higher degree"
            ) from error
        return refine(system, factors.solve, tolerance)


@dataclass(frozen=True)
class GMRES:
    """GMRES with restarts, preconditioned by an incomplete LU factorisation."""

    restart: int = 80
    limit: int = 20

    def solve(self, system: Equilibrated, tolerance: float) -> tuple[Array, int]:
        """Solve to the relative residual `tolerance` of the scaled system."""
        from scipy.sparse.linalg import LinearOperator, gmres, spilu

        matrix = system.scaled_sparse()
        try:
            factors = spilu(matrix, drop_tol=1e-4, fill_factor=8)
        except (RuntimeError, MemoryError) as error:
            raise NotConverged(
                f"the incomplete factorisation failed ({error}): choose a coarser grid"
            ) from error
        steps: list[float] = []
        solution, failed = gmres(
            matrix.tocsr(),
            system.rows * system.load,
            rtol=max(tolerance, 1e-12),
            restart=self.restart,
            maxiter=self.limit,
            M=LinearOperator(matrix.shape, factors.solve, dtype=float),
            callback=steps.append,
            callback_type="pr_norm",
        )
        if failed:
            raise NotConverged(
                f"GMRES did not reach a relative residual of {tolerance:.1e} in {len(steps)} iterations: choose the "
                "linear solver superlu, a lower degree, or basis: web-spline"
            )
        return solution, len(steps)


METHODS: dict[str, GeneralMethod] = {
    "dense": DenseLU(),
    "pivoted": PivotedQR(),
    "superlu": SparseLU(),
    "gmres": GMRES(),
}


def choose(system: Equilibrated) -> list[tuple[str, str]]:
    """Names of the methods to try in turn, each with the reason."""
    n = len(system.load)
    if not system.sparse or n <= SMALL:
        return [("dense", f"{n} unknowns, not symmetric")]
    size = f"{n} unknowns with {system.original.nnz / n:.0f} entries a row, not symmetric"
    iterative = ("gmres", f"{size}: too many for a factorisation")
    if system.original.nnz > SPARSE_LIMIT:
        return [iterative]
    return [("superlu", size), iterative]


def solve(matrix: Any, load: Array, method: str = "auto", tolerance: float = 1e-12) -> LinearSolution:
    """Solve ``A x = b`` with a square matrix A that need not be symmetric.

    Raises
    ------
    NumericsError
        Unknown method, numbers that are not finite, a singular matrix, no convergence.
    """
    system = Equilibrated.of(matrix, np.asarray(load, dtype=float))
    if method == "auto":
        candidates = choose(system)
    elif method in METHODS:
        candidates = [(method, "chosen by the user")]
    else:
        raise NumericsError(
            f"the linear solver {method} needs a symmetric matrix: choose auto or one of {', '.join(sorted(METHODS))}"
        )
    if not system.load.any():
        return LinearSolution(np.zeros(len(load)), 0.0, 0, "none", "the load is zero")
    for number, (name, reason) in enumerate(candidates, start=1):
        try:
            scaled, iterations = METHODS[name].solve(system, tolerance)
        except NotConverged:
            if number == len(candidates):
                raise
            continue
        remainder, residual = system.residual(scaled)
        backward = np.linalg.norm(remainder) / (
            np.linalg.norm(scaled) + np.linalg.norm(system.rows * system.load)
        )
        if not backward <= max(ACCEPTED, tolerance):
            raise NumericsError(
                f"the linear solver {name} reached only a relative residual of {residual:.1e}: the system is too "
                "ill-conditioned; lower the degree, use basis: web-spline, or raise quadrature_points"
            )
        return LinearSolution(system.columns * scaled, residual, iterations, name, reason)
    raise NumericsError("no linear solver suits the system")


def refine(system: Equilibrated, apply: Callable[[Array], Array], tolerance: float) -> tuple[Array, int]:
    """Solution by a factorisation, with iterative refinement while that helps."""
    x = apply(system.rows * system.load)
    remainder, residual = system.residual(x)
    for step in range(REFINEMENTS):
        if residual <= tolerance or not np.isfinite(residual):
            return x, step
        better = x + apply(remainder)
        remainder, reached = system.residual(better)
        if not reached < 0.5 * residual:
            return x, step
        x, residual = better, reached
    return x, REFINEMENTS


def row_scaled(matrix: Any, factors: Array) -> Any:
    """CSR matrix with scaled rows."""
    from scipy.sparse import csr_array

    scaled = csr_array(matrix, copy=True)
    scaled.data *= np.repeat(factors, np.diff(scaled.indptr))
    return scaled


def as_vector(values: Any) -> Array:
    """Return a column or row, sparse or not, as a vector."""
    dense = values.toarray() if hasattr(values, "toarray") else values
    return np.asarray(dense, dtype=float).reshape(-1)
