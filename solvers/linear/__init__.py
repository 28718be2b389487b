r"""Linear systems with a symmetric positive definite matrix.

Every system is first scaled to a unit diagonal, ``D^-1/2 A D^-1/2 y = D^-1/2 b``: among all diagonal scalings that is
optimal up to a factor (van der Sluis, Numer. Math. 14, 1969), it makes conjugate gradients those with Jacobi's
preconditioner, and it lets one tolerance say when a matrix is singular. The residual that was reached is
always computed from the matrix itself, and returned.

A matrix with a known null space (all conditions are on the flux) is solved on its complement: the load is projected,
and of all solutions the one orthogonal to the null space is returned.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.linear.choice import METHODS, Candidate, MatrixFree, choose
from solvers.linear.system import NotConverged, ScaledSystem, nbytes

if TYPE_CHECKING:
    from solvers.linear.lattice import Lattice

__all__ = ["METHODS", "LinearSolution", "solve"]

WRONG = 1e-2
"""A solution with a larger residual, relative to the load, is refused whatever its backward error."""
ACCEPTED = 1e-8
"""A solution with a larger backward error is refused."""


@dataclass(frozen=True, eq=False)
class LinearSolution:
    """Solution of a linear system, and how it was found.

    Attributes
    ----------
    x
        The solution.
    residual
        ``|b - A x| / |b|``, of the projected load if there is a null space.
    iterations
        Iterations, or steps of iterative refinement after a direct method.
    method
        Name of the method.
    reason
        Why this method.
    condition
        Estimate of the condition number of the matrix scaled to a unit diagonal, where it was asked for.
    nbytes
        Bytes of the matrix and of the factor or the preconditioner, where they were counted.
    """

    x: Array
    residual: float
    iterations: int
    method: str
    reason: str
    condition: float | None = None
    nbytes: int | None = None


def solve(
    matrix: Any,
    load: ArrayLike,
    method: str = "auto",
    tolerance: float = 1e-12,
    null_space: ArrayLike | None = None,
    lattice: Lattice | None = None,
) -> LinearSolution:
    """Solve ``A x = b``.

    Parameters
    ----------
    matrix
        Symmetric positive (semi)definite array or sparse matrix, shape (n, n), or one known by its products.
    load
        Right-hand side (n,).
    method
        ``auto`` or one of :data:`METHODS`.
    tolerance
        Relative residual at which iterative methods stop and direct ones need no refinement.
    null_space
        Vectors (n,) or (n, k) that span the null space, when the matrix has one.
    lattice
        Where the unknowns sit, if they are coefficients of splines on a grid; multigrid needs it.

    Raises
    ------
    NumericsError
        Unknown method, numbers that are not finite, a matrix that is singular or indefinite, no convergence.
    """
    system = ScaledSystem.of(matrix, np.asarray(load, dtype=float), null_space, lattice)
    if isinstance(matrix, MatrixFree):
        candidates = [matrix.candidate()]
    elif method == "auto":
        candidates = choose(system)
    elif method in METHODS:
        candidates = [Candidate(method, METHODS[method], "chosen by the user")]
    else:
        raise NumericsError(
            f"unknown linear solver {method!r}: choose auto or one of {', '.join(sorted(METHODS))}"
        )
    if not system.load.any():
        return LinearSolution(np.zeros(len(system.load)), 0.0, 0, "none", "the load is zero")
    for number, candidate in enumerate(candidates, start=1):
        try:
            scaled, iterations = candidate.method.solve(system, tolerance)
        except NotConverged:
            system.kept.clear()
            if number == len(candidates):
                raise
            continue
        return _accept(system, scaled, iterations, candidate, tolerance)
    raise NumericsError("no linear solver suits the system")


def _accept(
    system: ScaledSystem, scaled: Array, iterations: int, candidate: Candidate, tolerance: float
) -> LinearSolution:
    """Solution of the original system, refused when it does not solve a nearby one."""
    x, residual = system.unscale(scaled)
    # a huge solution may solve a nearby system and still leave a residual as large as the load
    if not (system.backward_error(scaled) <= max(ACCEPTED, tolerance) and residual <= WRONG):
        raise NumericsError(
            f"the linear solver {candidate.name} reached only a relative residual of {residual:.1e}: the system is "
            "too ill-conditioned; lower the degree, use basis: web-spline, or raise quadrature_points"
        )
    size = nbytes(system.original) + sum(system.kept.values())
    return LinearSolution(x, residual, iterations, candidate.name, candidate.reason, nbytes=size)
