r"""Errors of a computed field against the exact solution, by quadrature.

Relative norms over the domain, with e = u - u_exact:
:math:`\|e\|_{L_2}/\|u\|_{L_2}`, the seminorm :math:`|e|_{H^1}/|u|_{H^1}`, and
:math:`\max|e|/\max|u|` over the quadrature points.  The rules are the positive ones of the cut cells and Gauss
rules with one point a direction more than assembly uses in the inner cells, so that points where a Ritz
solution happens to be better than elsewhere do not flatter it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from solvers.background import Background
from solvers.boundary import boundary_batches, outward, periodic_points, residual
from solvers.exact import Exact, components_of, exact_jet
from solvers.periodicity import periods_of
from solvers.problem import Problem
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.quadrature.tensor import inner_rule
from solvers.sharing import WHOLE, Sharing
from solvers.solution import Piece, Trial

CHUNK = 150_000


@dataclass(frozen=True)
class ErrorNorms:
    """Relative errors in L2, in the H1 seminorm and in the maximum norm."""

    l2: float
    h1: float
    maximum: float


def norm_batches(background: Background, degree: int) -> Iterator[TensorBatch | PointBatch]:
    """Rules for norms, in chunks."""
    rule = inner_rule(background.grid, background.rules.inner.cells, degree + 2)
    yield from rule.chunks(CHUNK)
    yield from background.rules.cut.chunks(CHUNK)


class ErrorSums:
    """Adds up the integrals that error norms are made of, batch by batch.

    Parameters
    ----------
    components
        Number of components of the field; its norms are those of all of them.
    """

    def __init__(self, components: int = 1) -> None:
        self._components = components
        self._error, self._size = np.zeros(2), np.zeros(2)
        self._worst = self._largest = 0.0

    def add(self, difference: Array, truth: Array, weights: Array) -> None:
        """Add a batch: jets of order 1 of the error and of the exact solution, and weights (n, q)."""
        self._error += squares(difference, weights, self._components)
        self._size += squares(truth, weights, self._components)
        self._worst = max(self._worst, largest(length(difference, self._components), weights))
        self._largest = max(self._largest, largest(length(truth, self._components), weights))

    def norms(self, sharing: Sharing = WHOLE) -> ErrorNorms:
        """The relative norms of what was added by all processes."""
        error, size = sharing.total(np.stack([self._error, self._size]))
        relative = np.sqrt(error / np.where(size > 0, size, 1.0))
        maxima = sharing.largest({"worst": self._worst, "largest": self._largest})
        return ErrorNorms(
            float(relative[0]), float(relative[1]), maxima["worst"] / (maxima["largest"] or 1.0)
        )


def error_norms(trial: Trial, exact: Exact, background: Background) -> ErrorNorms:
    """Relative errors of `trial` against `exact`."""
    sums = ErrorSums(len(components_of(exact)))
    for batch in norm_batches(background, trial.degree):
        truth = exact_jet(exact, batch.points(background.grid), 1)
        sums.add(trial.jet(batch, 1) - truth, truth, batch.weights)
    return sums.norms(background.sharing)


def squares(jet: Array, weights: Array, components: int = 1) -> Array:
    """Integrals of the squared values and of the squared gradients of a jet (n_components * n_alpha, n, q)."""
    if not weights.all():  # padding of ragged rules, where a formula need not be finite
        jet = np.where(weights != 0, jet, 0.0)
    first = jet.reshape(components, -1, *weights.shape)
    integrals = np.einsum("canq,canq,nq->a", first, first, weights)
    return np.array([integrals[0], integrals[1:].sum()])


def length(jet: Array, components: int) -> Array:
    """Lengths of the values of a jet of a vector; of a scalar, its values."""
    if components == 1:
        values: Array = jet[0]
    else:
        values = np.linalg.norm(jet[:: len(jet) // components], axis=0)
    return values


def largest(values: Array, weights: Array) -> float:
    """Largest modulus at nodes that count."""
    return float(np.abs(values if weights.all() else values[weights != 0]).max(initial=0.0))


def integrate(
    background: Background, degree: int, integrand: Callable[[TensorBatch | PointBatch], Array]
) -> float:
    """Integral over the domain of an integrand given at the nodes of a batch, shape (n, q)."""
    total = 0.0
    for batch in norm_batches(background, degree):
        values = np.broadcast_to(integrand(batch), batch.weights.shape)
        total += float(np.sum(np.where(batch.weights != 0, values, 0.0) * batch.weights))
    return float(background.sharing.total(total))


def boundary_errors(problem: Problem, trial: Trial, background: Background) -> dict[str, float]:
    """Largest residual of its condition on each boundary part, by the name of the part.

    Of a periodic condition, the largest difference of u and of its derivatives up to those of the flux.
    """
    errors: dict[str, float] = {}
    for condition, batch in boundary_batches(problem, background.rules.boundary, background.grid):
        counted = batch.weights > 0
        coords = [c[counted][:, None] for c in batch.points(background.grid)]
        if not coords[0].size:
            continue
        jet = trial.at(np.concatenate(coords, axis=1), problem.equation.flux_order)[:, :, None]
        normals = outward(batch)[counted][:, None, :]
        largest = float(residual(problem, condition, coords, normals, jet).max())
        name = condition.part.name
        errors[name] = max(errors.get(name, 0.0), largest)
    for periodic, points in periodic_points(problem, background.rules.boundary, background.grid):
        period = next(p for p in periods_of(problem) if periodic.part.name in p.names)
        here, there = (trial.at(p, problem.equation.flux_order) for p in (points, period.moved(points)))
        gap = float(np.abs(there - period.factor * here).max(initial=0.0))
        errors[periodic.part.name] = max(errors.get(periodic.part.name, 0.0), gap)
    return background.sharing.largest(errors)


def all_boundary_errors(pieces: Sequence[Piece]) -> dict[str, float]:
    """Largest residuals on the boundary of a solution and on its interfaces, by the name of the part."""
    errors: dict[str, float] = {}
    for piece in pieces:
        for name, value in boundary_errors(piece.problem, piece.trial, piece.background).items():
            errors[name] = max(errors.get(name, 0.0), value)
    return errors
