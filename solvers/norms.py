r"""Errors of a computed field against the exact solution, by quadrature.

Relative norms over the domain, with e = u - u_exact:
:math:`\|e\|_{L_2}/\|u\|_{L_2}`, the seminorm :math:`|e|_{H^1}/|u|_{H^1}`, and
:math:`\max|e|/\max|u|` over the quadrature points.  The rules are the positive ones of the cut cells and Gauss
rules with two points a direction more than assembly uses in the inner cells, so that points where a Ritz
solution happens to be better than elsewhere do not flatter it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from solvers.background import Background
from solvers.boundary import boundary_batches, outward, residual
from solvers.problem import Problem
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.quadrature.tensor import inner_rule
from solvers.solution import Solution, Trial

CHUNK = 150_000


@dataclass(frozen=True)
class ErrorNorms:
    """Relative errors in L2, in the H1 seminorm and in the maximum norm."""

    l2: float
    h1: float
    maximum: float


def norm_batches(background: Background, degree: int) -> Iterator[TensorBatch | PointBatch]:
    """Rules for norms, in chunks."""
    rule = inner_rule(background.grid, background.rules.inner.cells, degree + 3)
    yield from rule.chunks(CHUNK)
    yield from background.rules.cut.chunks(CHUNK)


def error_norms(trial: Trial, exact: Field, background: Background) -> ErrorNorms:
    """Relative errors of `trial` against `exact`."""
    error, size = np.zeros(2), np.zeros(2)
    worst, largest = 0.0, 0.0
    for batch in norm_batches(background, trial.degree):
        truth = partials(exact, batch.points(background.grid), 1)
        difference = trial.jet(batch, 1) - truth
        error += squares(difference, batch.weights)
        size += squares(truth, batch.weights)
        counted = batch.weights > 0
        worst = max(worst, float(np.abs(difference[0][counted]).max(initial=0.0)))
        largest = max(largest, float(np.abs(truth[0][counted]).max(initial=0.0)))
    relative = np.sqrt(error / np.where(size > 0, size, 1.0))
    return ErrorNorms(float(relative[0]), float(relative[1]), worst / (largest or 1.0))


def squares(jet: Array, weights: Array) -> Array:
    """Integrals of the squared value and of the squared gradient of a jet (n_alpha, n, q)."""
    counted = weights != 0
    w = weights[counted]
    return np.array([jet[0][counted] ** 2 @ w, sum(row[counted] ** 2 @ w for row in jet[1:])])


def integrate(
    background: Background, degree: int, integrand: Callable[[TensorBatch | PointBatch], Array]
) -> float:
    """Integral over the domain of an integrand given at the nodes of a batch, shape (n, q)."""
    total = 0.0
    for batch in norm_batches(background, degree):
        values = np.broadcast_to(integrand(batch), batch.weights.shape)
        total += float(np.sum(np.where(batch.weights != 0, values, 0.0) * batch.weights))
    return total


def with_mean(solution: Solution) -> Solution:
    """Fix the constant of a pure Neumann solution: mean zero, or the mean of the exact solution."""
    problem, trial, background = solution.problem, solution.trial, solution.background

    def excess(batch: TensorBatch | PointBatch) -> Array:
        values: Array = trial.jet(batch, 0)[0]
        if problem.exact is not None:
            values = values - partials(problem.exact, batch.points(background.grid), 0)[0]
        return values

    volume = integrate(background, trial.degree, lambda batch: np.ones(1))
    shift = integrate(background, trial.degree, excess) / volume
    psi = trial.splines[0]  # u = psi here, and the spline with all coefficients 1 is the constant 1
    shifted = replace(psi, coefficients=psi.coefficients - shift)
    return replace(solution, trial=replace(trial, splines=(shifted,)))


def boundary_errors(problem: Problem, trial: Trial, background: Background) -> dict[str, float]:
    """Largest residual of its condition on each boundary part, by the name of the part."""
    errors: dict[str, float] = {}
    for condition, batch in boundary_batches(problem, background.rules.boundary, background.grid):
        counted = batch.weights > 0
        coords = [c[counted][:, None] for c in batch.points(background.grid)]
        if not coords[0].size:
            continue
        jet = trial.at(np.concatenate(coords, axis=1), 1)[:, :, None]
        normals = outward(batch)[counted][:, None, :]
        largest = float(residual(problem, condition, coords, normals, jet).max())
        name = condition.part.name
        errors[name] = max(errors.get(name, 0.0), largest)
    return errors
