"""Energy of a field: the number that the Ritz method makes as small as it can."""

from __future__ import annotations

import numpy as np

from rfm.calculus.types import Array
from solvers.background import Background
from solvers.boundary import boundary_batches, natural_density, outward
from solvers.equations.density import QuadraticDensity
from solvers.norms import norm_batches
from solvers.problem import Dirichlet, Problem
from solvers.solution import Trial


def energy(problem: Problem, trial: Trial, background: Background) -> float:
    """Energy of the domain and of the natural boundary conditions."""
    total = 0.0
    for batch in norm_batches(background, trial.degree):
        density = problem.equation.density(batch.points(background.grid), problem.exact)
        total += float(
            np.sum(density_values(density, trial.jet(batch, problem.equation.order)) * batch.weights)
        )
    for condition, batch in boundary_batches(problem, background.rules.boundary, background.grid):
        if not isinstance(condition, Dirichlet):
            density = natural_density(problem, condition, batch.points(background.grid), outward(batch))
            total += float(np.sum(density_values(density, trial.jet(batch, 0)) * batch.weights))
    return total


def density_values(density: QuadraticDensity, jet: Array) -> Array:
    """``1/2 v.H v - l.v`` at points, for the jet v of shape (n_beta, ...)."""
    value = np.zeros(jet.shape[1:])
    for (row, column), entry in density.hessian.items():
        value += (0.5 if row == column else 1.0) * entry * jet[row] * jet[column]
    for row, entry in density.linear.items():
        value -= entry * jet[row]
    return value
