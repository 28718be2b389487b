"""Probes and integrals of a case: numbers that a user asks of the solution."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.app.case import Case
from rfm.app.derived import derived
from rfm.app.schema.results import DOMAIN
from rfm.errors import DataError, RfmError

if TYPE_CHECKING:
    from rfm.app.expressions.expression import ExpressionField
    from rfm.app.schema.results import Integral
    from rfm.calculus.types import Array
    from rfm.geometry.surface import Surface
    from solvers.quadrature.batch import PointBatch, TensorBatch
    from solvers.solution import Piece, Solution


def probes(case: Case, solution: Solution) -> dict[str, dict[str, Any]]:
    """Value and gradient of u, and what derives from them, at the probes of the case.

    Raises
    ------
    CaseError
        A probe lies outside the domain.
    """
    results: dict[str, dict[str, Any]] = {}
    sign = solution.problem.domain.sign
    tolerance = 1e-9 * float(np.max(solution.background.grid.spacing))
    for name, point in case.probes.items():
        if float(np.asarray(sign(*point))) < -tolerance:
            raise case.error(("probes", name), "the point lies outside the domain")
        results[name] = {
            "point": list(point),
            "u": solution.u([point])[0].tolist(),
            "gradient": solution.gradient([point])[0].tolist(),
            **{
                kind: {key: float(values[0]) for key, values in found.items()}
                for kind, found in derived(solution.problem, solution.trial, np.array([point])).items()
            },
        }
    return results


def integrals(case: Case, solution: Solution) -> dict[str, float | list[float]]:
    """Integrals of the case over parts of the boundary or over the domain; of a traction, its resultant.

    Raises
    ------
    CaseError
        A part is unknown, or an integrand is not finite.
    """
    return {name: _integral(case, name, wanted, solution) for name, wanted in case.integrals.items()}


def _integral(case: Case, name: str, wanted: Integral, solution: Solution) -> float | list[float]:
    try:
        if DOMAIN in wanted.on:
            return _over_domain(case, name, wanted, solution)
        parts = [
            _over_part(case, name, part, wanted, solution) for part in _surfaces(case, name, wanted, solution)
        ]
        total: float | list[float] = np.sum(parts, axis=0).tolist()
        return total
    except DataError as error:
        raise case.error(("integrals", name, "of"), str(error)) from error


def _surfaces(case: Case, name: str, wanted: Integral, solution: Solution) -> list[Surface]:
    chosen: dict[Surface, None] = {}
    for part_name in wanted.on:
        try:
            part = solution.problem.domain.part(part_name)
        except RfmError as error:
            raise case.error(("integrals", name, "on"), str(error)) from error
        chosen.update(dict.fromkeys(sorted(part.surfaces, key=lambda s: s.label)))
    return list(chosen)


def _over_domain(case: Case, name: str, wanted: Integral, solution: Solution) -> float:
    from solvers.norms import integrate

    def integrand(piece: Piece, batch: TensorBatch | PointBatch) -> Array:
        if wanted.of == "area":
            return np.ones(1)
        return _expression_values(case, name, wanted, piece, batch)

    return sum(integrate(p.background, p.trial.degree, partial(integrand, p)) for p in solution.pieces)


def _over_part(case: Case, name: str, surface: Surface, wanted: Integral, solution: Solution) -> Array:
    pieces = [p for p in solution.pieces if surface in p.background.rules.boundary]
    total: Array = np.sum(
        [_over_piece(case, name, surface, wanted, p) for p in pieces] or [np.zeros(())], axis=0
    )
    return solution.background.sharing.total(total)


def _over_piece(case: Case, name: str, surface: Surface, wanted: Integral, piece: Piece) -> Array:
    batch, grid = piece.background.rules.boundary[surface], piece.background.grid
    if wanted.of == "area":
        return np.asarray(batch.weights.sum())
    if wanted.of == "flux":
        from solvers.boundary import flux_values, outward

        problem = piece.problem
        jet = piece.trial.jet(batch, problem.equation.flux_order)
        values = flux_values(problem, batch.points(grid), outward(batch), jet)
    else:
        values = _expression_values(case, name, wanted, piece, batch)
    return np.asarray(np.sum(np.where(batch.weights != 0, values, 0.0) * batch.weights, axis=(-2, -1)))


def _expression_values(
    case: Case, name: str, wanted: Integral, piece: Piece, batch: TensorBatch | PointBatch
) -> Array:
    from solvers.data import require_finite

    if isinstance(wanted.of, str):
        raise TypeError(f"{wanted.of!r} is no expression")
    field: ExpressionField = wanted.of.field(case.dimension, ("integrals", name, "of"), case.unknowns)
    coords = batch.points(piece.background.grid)
    values = np.broadcast_to(
        np.asarray(field(*coords, *piece.trial.jet(batch, 0)), float), batch.weights.shape
    )
    require_finite("integrand", field, coords, np.where(batch.weights != 0, values, 0.0))
    return values
