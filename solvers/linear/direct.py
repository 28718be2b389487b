"""Direct methods: dense Cholesky, SuperLU in symmetric mode, PARDISO."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.linear.system import INDEFINITE, SINGULAR, NotConverged, ScaledSystem, refusal
from solvers.threads import threads_for

REFINEMENTS = 2
EPSILON = float(np.finfo(float).eps)


def refine(system: ScaledSystem, apply: Callable[[Array], Array], tolerance: float) -> tuple[Array, int]:
    """Solution by a factorisation, with iterative refinement while that helps."""
    x = apply(system.scaled_load)
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


@dataclass(frozen=True)
class DenseCholesky:
    """Cholesky factorisation of the full array (LAPACK potrf)."""

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve; refuses a matrix that is singular to rounding or indefinite."""
        from scipy.linalg.lapack import dlange, dpocon, dpotrf, dpotrs

        array = system.scaled_array()
        pins = system.pins()
        array[pins, pins] += 1.0
        norm = float(dlange("1", array.T))
        lowest = f"of {len(array)} unknowns"
        with threads_for(len(array)):
            factor, info = dpotrf(array.T, lower=1, overwrite_a=1, clean=0)
        system.kept["factor"] = int(factor.nbytes)
        if info > 0:
            pivot = self._pivot(system, info)
            problem = SINGULAR if pivot > -1e3 * EPSILON * norm else INDEFINITE
            raise refusal(problem, f"pivot {info} {lowest} is {pivot:.1e} of its diagonal entry")
        condition, _ = dpocon(factor, norm, uplo="L")
        if condition < EPSILON:
            raise NumericsError(SINGULAR.format(why=f"reciprocal condition number {condition:.1e}"))
        return refine(system, lambda b: dpotrs(factor, b, lower=1)[0], tolerance)

    @staticmethod
    def _pivot(system: ScaledSystem, size: int) -> float:
        """Last pivot of the leading submatrix on which the factorisation failed."""
        leading = system.scaled_array()[:size, :size]
        column = leading[:-1, -1]
        solved = np.linalg.lstsq(leading[:-1, :-1], column, rcond=None)[0] if size > 1 else column
        return float(leading[-1, -1] - column @ solved)


@dataclass(frozen=True)
class SuperLU:
    """Sparse LU factorisation without pivoting, minimum degree ordering of ``A + A^T`` (Li, ACM TOMS 31, 2005)."""

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve; refuses a matrix that is singular to rounding or indefinite."""
        from scipy.sparse import csc_array
        from scipy.sparse.linalg import splu

        matrix = pinned(system)
        # the matrix is symmetric: its CSR arrays are the CSC arrays
        columns = csc_array((matrix.data, matrix.indices, matrix.indptr), shape=matrix.shape)
        try:
            factors = splu(
                columns, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise NumericsError(SINGULAR.format(why=str(error))) from error
        except MemoryError as error:
            raise NotConverged(
                "the factors do not fit into memory: choose the linear solver amg or cg, or a coarser grid of a "
                "higher degree"
            ) from error
        system.kept["factor"] = 12 * int(factors.nnz)
        check_pivots(factors.U.diagonal())
        return refine(system, factors.solve, tolerance)


@dataclass(frozen=True)
class Pardiso:
    """Sparse Cholesky factorisation of Intel's PARDISO, when the package pypardiso is installed."""

    @staticmethod
    def available() -> bool:
        """Whether pypardiso can be imported."""
        from importlib.util import find_spec

        return find_spec("pypardiso") is not None

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve; refuses a matrix that is not positive definite."""
        if not self.available():
            raise NumericsError(
                "the linear solver pardiso needs the package pypardiso: install it or choose auto"
            )
        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError
        from scipy.sparse import csr_matrix, triu

        upper = csr_matrix(triu(pinned(system), format="csr"))
        solver = PyPardisoSolver(mtype=2)
        try:
            solver.factorize(upper)
            return refine(system, lambda b: np.asarray(solver.solve(upper, b)).reshape(-1), tolerance)
        except PyPardisoError as error:
            why = f"{str(error).split('.')[0]}; a singular matrix, as of flux conditions only, says the same"
            raise refusal(INDEFINITE, why) from error
        finally:
            solver.free_memory(everything=True)


def pinned(system: ScaledSystem) -> Any:
    """Scaled CSR matrix made definite where there is a null space."""
    from scipy.sparse import coo_array

    matrix = system.scaled_sparse()
    pins = system.pins()
    if len(pins):
        matrix = (matrix + coo_array((np.ones(len(pins)), (pins, pins)), shape=matrix.shape)).tocsr()
    return matrix


def check_pivots(pivots: Array) -> None:
    """Refuse pivots of a unit-diagonal matrix that are negative or vanish to rounding.

    Raises
    ------
    NumericsError
        A pivot is too small.
    """
    smallest = float(pivots.min())
    if smallest > 50 * EPSILON:
        return
    problem = SINGULAR if smallest > -1e3 * EPSILON else INDEFINITE
    raise refusal(problem, f"smallest pivot {smallest:.1e} of the scaled matrix")
