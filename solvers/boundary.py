"""Conditions on the boundary: which rule each one sees, natural energies, data and residuals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.surface import Surface
from solvers.data import values
from solvers.equations.density import QuadraticDensity
from solvers.equations.rows import Equality, apply
from solvers.grid import Grid
from solvers.problem import Condition, Periodic, Problem
from solvers.quadrature.batch import PointBatch


def boundary_batches(
    problem: Problem, rules: Mapping[Surface, PointBatch], grid: Grid
) -> Iterator[tuple[Condition, PointBatch]]:
    """Each condition with the boundary rule of each surface it holds on.

    Where a condition holds on a piece of a surface (``Part.where``), the weights off that piece are zero.  Periodic
    conditions relate two points and have their own residual, :func:`periodic_points`.
    """
    for condition in problem.conditions:
        if isinstance(condition, Periodic):
            continue
        for surface in sorted(condition.part.surfaces, key=lambda s: s.label):
            if surface not in rules:
                continue
            batch = rules[surface]
            if condition.part.where is not None:
                holds = values("extent of a part", condition.part.where, batch.points(grid))
                batch = replace(batch, weights=np.where(np.greater(holds, 0), batch.weights, 0.0))
            yield condition, batch


def periodic_points(
    problem: Problem, rules: Mapping[Surface, PointBatch], grid: Grid
) -> Iterator[tuple[Periodic, Array]]:
    """Each periodic condition with the points (n, d) of the rules on its first part."""
    for condition in problem.conditions:
        if not isinstance(condition, Periodic):
            continue
        for surface in sorted(condition.part.surfaces & set(rules), key=lambda s: s.label):
            batch = rules[surface]
            yield condition, np.stack([c[batch.weights > 0] for c in batch.points(grid)], axis=1)


def outward(batch: PointBatch) -> Array:
    """Outward normals of a boundary rule, shape (n, q, d).

    Raises
    ------
    ValueError
        It is a rule for the volume.
    """
    if batch.normals is None:
        raise ValueError("a volume rule has no normals")
    return batch.normals


def flux_values(problem: Problem, coords: Sequence[Array], normals: Array, jet: Array) -> Array:
    """Flux of a field with the given jet of order `flux_order`; of a vector one row for each component."""
    values = [apply(row, jet) for row in problem.equation.flux(coords, normals)]
    return values[0] if len(values) == 1 else np.stack(values)


def natural_density(
    problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array
) -> QuadraticDensity | None:
    """Boundary energy of a condition; None when it is essential and has none."""
    return problem.equation.natural_density(condition, coords, normals, problem.exact)


def condition_rows(
    problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array
) -> list[Equality]:
    """What a condition asks at boundary points: rows in the jet of `flux_order` and their values."""
    return problem.equation.condition_rows(condition, coords, normals, problem.exact)


def residual(
    problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array, jet: Array
) -> Array:
    """How far the field with the given jet (of order `flux_order`) is from satisfying `condition`."""
    rows = condition_rows(problem, condition, coords, normals)
    worst: Array = np.max([np.abs(apply(row, jet) - right) for row, right in rows], axis=0)
    return worst
