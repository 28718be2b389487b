"""What a field is worth: its energy, which the Ritz method makes as small as it can, and its errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from solvers.boundary import boundary_batches, natural_density, outward
from solvers.equations.density import QuadraticDensity
from solvers.exact import exact_jet
from solvers.norms import ErrorNorms, ErrorSums, norm_batches
from solvers.solution import Piece


@dataclass(frozen=True)
class Measures:
    """Error norms and relative error in the energy norm (None without an exact solution), and energy of a field."""

    norms: ErrorNorms | None
    energy_norm: float | None
    energy: float


def measure(pieces: Sequence[Piece]) -> Measures:
    """Error norms and energy of a solution, of its domain and its natural conditions.

    Raises
    ------
    ValueError
        There is no piece.
    """
    if not pieces:
        raise ValueError("a solution has a piece")
    first = pieces[0].problem
    sums = ErrorSums(first.equation.components(first.domain.dimension))
    sharing = pieces[0].background.sharing
    energies = sharing.total(np.sum([_add(piece, sums) for piece in pieces], axis=0))
    total, lost, size = (float(energy) for energy in energies)
    if first.exact is None:
        return Measures(None, None, total)
    return Measures(sums.norms(sharing), float(np.sqrt(abs(lost) / (abs(size) or 1.0))), total)


def _add(piece: Piece, sums: ErrorSums) -> tuple[float, float, float]:
    """Add the errors of a piece; return its energy, and those of the error and of the exact solution."""
    problem, trial, background = piece.problem, piece.trial, piece.background
    equation, exact = problem.equation, problem.exact
    components = equation.components(background.grid.dimension)
    total = lost = size = 0.0
    order = max(1, equation.order)
    for batch in norm_batches(background, trial.degree):
        coords = batch.points(background.grid)
        jet = trial.jet(batch, order)
        density = equation.density(coords, exact)
        total += integral(density_values(density, jet), batch.weights)
        if exact is not None:
            truth = exact_jet(exact, coords, order)
            difference = jet - truth
            elastic = QuadraticDensity(density.hessian, {})
            lost += integral(density_values(elastic, difference), batch.weights)
            size += integral(density_values(elastic, truth), batch.weights)
            first = first_order(len(jet), components, background.grid.dimension)
            sums.add(difference[first], truth[first], batch.weights)
    for condition, batch in boundary_batches(problem, background.rules.boundary, background.grid):
        natural = natural_density(problem, condition, batch.points(background.grid), outward(batch))
        if natural is not None and natural.symmetric:  # an oblique derivative has no energy
            total += integral(density_values(natural, trial.jet(batch, order - 1)), batch.weights)
    return total, lost, size


def integral(values: Array, weights: Array) -> float:
    """Sum of values times weights, over the nodes that count."""
    return float(np.sum(np.where(weights != 0, values, 0.0) * weights))


def first_order(rows: int, components: int, dimension: int) -> slice | list[int]:
    """Positions of the jets of order 1 in those of a higher order."""
    width = rows // components
    if components == 1:
        return slice(dimension + 1)
    return [c * width + k for c in range(components) for k in range(dimension + 1)]


def density_values(density: QuadraticDensity, jet: Array) -> Array:
    """``1/2 v.H v - l.v`` at points, for the jet v of shape (n_beta, ...)."""
    value = np.zeros(jet.shape[1:])
    for (row, column), entry in density.hessian.items():
        value += (0.5 if row == column else 1.0) * entry * jet[row] * jet[column]
    for row, entry in density.linear.items():
        value -= entry * jet[row]
    return value
