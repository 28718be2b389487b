r"""Systems with a few unknowns at the end that may depend on the others.

Splines and singular functions make

.. math:: \begin{pmatrix} A & C \\ C^T & D \end{pmatrix} \begin{pmatrix} x \\ z \end{pmatrix}
          = \begin{pmatrix} b \\ d \end{pmatrix}, \qquad (D - C^T A^{-1} C)\, z = d - C^T A^{-1} b .

On a fine grid splines represent the smoother ones of the few functions nearly to rounding.  Their Schur complement is
what is left of them; it is factorised with pivoting, and functions of which nothing is left get the coefficient zero.
A is that of the splines alone and as well conditioned as ever.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.linear import LinearSolution
from solvers.linear import solve as solve_linear
from solvers.linear.condition import DENSE, factorise
from solvers.linear.system import INDEFINITE, ScaledSystem, refusal
from solvers.problem import SolverOptions

DEPENDENT = 1e-13
"""A function is dropped when less than this part of its energy is left."""
REFINEMENTS = 2


def solve_bordered(matrix: Any, load: Array, border: int, options: SolverOptions) -> LinearSolution:
    """Solve a system whose last `border` unknowns may depend on the others.

    Parameters
    ----------
    matrix, load
        Symmetric array or sparse matrix (n, n), and the right-hand side (n,).
    border
        Number of unknowns at the end.
    options
        Linear solver for the first unknowns, and tolerance.

    Raises
    ------
    NumericsError
        The first block is not positive definite, or could not be solved.
    """
    first = len(load) - border
    block, coupling = matrix[:first, :first], _dense(matrix[:first, first:])
    corner = _dense(matrix[first:, first:])
    apply, how = _inverse(block, load[:first], options)
    responses = apply(coupling)
    energies = np.diag(corner)  # not positive where a function was not resolved by the rules: it is left out
    scale = np.where(energies > 0.0, 1.0 / np.sqrt(np.where(energies > 0.0, energies, 1.0)), 0.0)
    small = _pivoted((corner - coupling.T @ responses) * scale * scale[:, None])

    def solved(right: Array) -> Array:
        own = apply(right[:first, None])[:, 0]
        z = scale * small(scale * (right[first:] - coupling.T @ own))
        return np.concatenate([own - responses @ z, z])

    x, steps = solved(load), 0
    size = float(np.linalg.norm(load)) or 1.0
    remainder = load - matrix @ x
    while steps < REFINEMENTS and np.linalg.norm(remainder) > options.tolerance * size:
        better = x + solved(remainder)
        left = load - matrix @ better
        if not np.linalg.norm(left) < 0.5 * np.linalg.norm(remainder):
            break
        x, remainder, steps = better, left, steps + 1
    reason = f"{first} unknowns of splines, and {border} of corners through their Schur complement"
    return LinearSolution(x, float(np.linalg.norm(remainder)) / size, steps, how, reason)


def _dense(block: Any) -> Array:
    array: Array = block if isinstance(block, np.ndarray) else block.toarray()
    return array


def _inverse(block: Any, load: Array, options: SolverOptions) -> tuple[Callable[[Array], Array], str]:
    """Solver with the first block for several right-hand sides (n, k), and its name."""
    if options.linear in ("auto", "dense") and len(load) <= DENSE:
        return _cholesky(ScaledSystem.of(block, load)), "dense"
    if options.linear == "auto":
        system = ScaledSystem.of(block, load)
        factors = factorise(system)
        if factors is not None:
            if not np.isfinite(factors.condition):
                raise refusal(INDEFINITE, "the factorisation of the splines fails")
            column = system.scale[:, None]
            return lambda right: column * factors.apply(column * right), factors.method

    def each(right: Array) -> Array:
        found = [solve_linear(block, b, options.linear, options.tolerance).x for b in right.T]
        return np.stack(found, axis=1)

    return each, options.linear if options.linear != "auto" else "cg"


def _cholesky(system: ScaledSystem) -> Callable[[Array], Array]:
    """Solver with a factorisation as a dense matrix, without the condition number, which costs as much again."""
    from scipy.linalg.lapack import dpotrf, dpotrs

    factor, info = dpotrf(system.scaled_array().T, lower=1, clean=0, overwrite_a=1)
    if info:
        raise refusal(INDEFINITE, f"pivot {info} of {len(system.load)} of the splines")
    column = system.scale[:, None]
    return lambda right: column * dpotrs(factor, column * right, lower=1)[0]


def _pivoted(matrix: Array) -> Callable[[Array], Array]:
    """Solver with a small positive semidefinite matrix; unknowns that depend on the others are zero."""
    from scipy.linalg.lapack import dpotrs, dpstrf

    factor, pivots, rank, _ = dpstrf(matrix, lower=1, tol=DEPENDENT)
    chosen = pivots[:rank] - 1
    triangle = np.asfortranarray(factor[:rank, :rank])

    def apply(right: Array) -> Array:
        x = np.zeros(len(right))
        if rank:
            x[chosen] = dpotrs(triangle, right[chosen], lower=1)[0]
        return x

    return apply
