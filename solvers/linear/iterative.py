"""Iterative methods: conjugate gradients, plain on the scaled matrix (Jacobi) or with algebraic multigrid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from rfm.calculus.types import Array
from solvers.linear.system import INDEFINITE, NotConverged, ScaledSystem, refusal

STALLED = 400
"""Iterations without a smaller residual after which conjugate gradients give up."""
NOISE = 1e3
"""Residuals, relative to the one that is asked for, at which negative curvature is rounding at the end of the way."""


@dataclass
class Record:
    """Coefficients of conjugate gradients, which are those of Lanczos' tridiagonal matrix.

    Attributes
    ----------
    lengths, ratios
        alpha_k of the steps, and beta_k of the directions (the first is zero).
    """

    lengths: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)

    def condition(self) -> float:
        """Estimate, from below, of the condition number of the preconditioned matrix."""
        from scipy.linalg import eigvalsh_tridiagonal

        alpha, beta = np.array(self.lengths), np.array(self.ratios)
        if not len(alpha):
            return 1.0
        diagonal = 1.0 / alpha
        diagonal[1:] += beta[1:] / alpha[:-1]
        values = eigvalsh_tridiagonal(diagonal, np.sqrt(beta[1:]) / alpha[:-1])
        return float(values[-1] / values[0])


def conjugate_gradients(
    apply: Callable[[Array], Array],
    system: ScaledSystem,
    tolerance: float,
    limit: int,
    precondition: Callable[[Array], Array],
    record: Record | None = None,
) -> tuple[Array, int]:
    """Preconditioned conjugate gradients for the scaled matrix, on the complement of the null space.

    The stopping test is on the residual of the original system, so that it means what is reported.

    Raises
    ------
    NumericsError
        A direction of negative energy was met.
    NotConverged
        The tolerance was not reached.
    """
    unscale, size = 1.0 / system.scale, float(np.linalg.norm(system.load))
    goal = Goal(lambda rest: float(np.linalg.norm(unscale * rest)) / size, tolerance, limit)
    return iterate(apply, system.project(system.scaled_load), goal, precondition, system.project, record)


@dataclass(frozen=True)
class Goal:
    """When to stop.

    Attributes
    ----------
    residual
        Relative residual of the original system, from that of the one that is iterated.
    tolerance
        Where it has to be.
    limit
        Most steps.
    """

    residual: Callable[[Array], float]
    tolerance: float
    limit: int


def iterate(
    apply: Callable[[Array], Array],
    right: Array,
    goal: Goal,
    precondition: Callable[[Array], Array],
    project: Callable[[Array], Array],
    record: Record | None = None,
) -> tuple[Array, int]:
    """Preconditioned conjugate gradients (Hestenes and Stiefel 1952); coefficients are added to `record`.

    Raises
    ------
    NumericsError
        A direction of negative energy was met.
    NotConverged
        The tolerance was not reached.
    """
    x, remainder, direction = np.zeros_like(right), right, np.zeros_like(right)
    old, best, best_step, step = 1.0, np.inf, 0, 0
    for step in range(goal.limit):
        residual = goal.residual(remainder)
        if residual <= goal.tolerance:
            return x, step
        if residual < best:
            best, best_step = residual, step
        if step - best_step > STALLED:
            break
        preconditioned = project(precondition(remainder))
        product = float(remainder @ preconditioned)
        if not product > 0:  # a preconditioner that rounding has made indefinite
            break
        ratio = product / old if step else 0.0
        direction = preconditioned + ratio * direction
        image = apply(direction)
        curvature = float(direction @ image)
        if not curvature > 0:
            if best <= NOISE * goal.tolerance:
                return x, step
            raise refusal(INDEFINITE, f"negative curvature in iteration {step}")
        length = product / curvature
        if record is not None:
            record.lengths.append(length)
            record.ratios.append(ratio)
        x += length * direction
        remainder = project(remainder - length * image)
        old = product
    raise not_converged(best, goal.tolerance, step + 1)


def not_converged(reached: float, tolerance: float, steps: int) -> NotConverged:
    """Error of conjugate gradients that gave up."""
    return NotConverged(
        f"conjugate gradients reached a relative residual of {reached:.1e} only, not "
        f"{tolerance:.1e}, in {steps} iterations: choose the linear solver superlu or dense, a lower degree, "
        "or basis: web-spline"
    )


@dataclass(frozen=True)
class ConjugateGradients:
    """Conjugate gradients with Jacobi's preconditioner (which is the scaling)."""

    limit: int = 10_000

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve to the relative residual `tolerance`."""
        return conjugate_gradients(system.apply, system, tolerance, self.limit, lambda v: v)


@dataclass(frozen=True)
class Multigrid:
    """Conjugate gradients with a V-cycle of smoothed aggregation (Vanek, Mandel, Brezina, Computing 56, 1996)."""

    limit: int = 500

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve to the relative residual `tolerance`."""
        from pyamg import smoothed_aggregation_solver
        from scipy.sparse import csr_matrix

        matrix = csr_matrix(system.scaled_sparse())
        matrix.sort_indices()
        # slowly varying splines have equal coefficients: the near-kernel of the scaled matrix
        hierarchy = smoothed_aggregation_solver(matrix, B=(1.0 / system.scale)[:, None], max_coarse=100)
        cycle = hierarchy.aspreconditioner()
        return conjugate_gradients(lambda v: matrix @ v, system, tolerance, self.limit, cycle.matvec)
