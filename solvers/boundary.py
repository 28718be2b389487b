"""Conditions on the boundary: which rule each one sees, natural energies, data and residuals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from rfm.geometry.surface import Surface
from solvers.data import values
from solvers.equations.density import QuadraticDensity
from solvers.grid import Grid
from solvers.problem import FROM_EXACT, Condition, Dirichlet, FromExact, Neumann, Problem, Robin
from solvers.quadrature.batch import PointBatch


def boundary_batches(
    problem: Problem, rules: Mapping[Surface, PointBatch], grid: Grid
) -> Iterator[tuple[Condition, PointBatch]]:
    """Each condition with the boundary rule of each surface it holds on.

    Where a condition holds on a piece of a surface (``Part.where``), the weights off that piece are zero.
    """
    for condition in problem.conditions:
        for surface in sorted(condition.part.surfaces, key=lambda s: s.label):
            if surface not in rules:
                continue
            batch = rules[surface]
            if condition.part.where is not None:
                holds = values("extent of a part", condition.part.where, batch.points(grid))
                batch = replace(batch, weights=np.where(np.greater(holds, 0), batch.weights, 0.0))
            yield condition, batch


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


def exact_flux(problem: Problem, coords: Sequence[Array], normals: Array) -> Array:
    """Conormal flux of the exact solution."""
    gradient = partials(require_exact(problem), coords, 1)[1:]
    return problem.equation.conormal_flux(coords, gradient, normals)


def exact_values(problem: Problem, coords: Sequence[Array]) -> Array:
    """Values of the exact solution."""
    result: Array = partials(require_exact(problem), coords, 0)[0]
    return result


def require_exact(problem: Problem) -> Field:
    """Return the exact solution of `problem`.

    Raises
    ------
    ValueError
        Data are taken from an exact solution that the problem does not have.
    """
    if problem.exact is None:
        raise ValueError("boundary data 'from exact' need an exact solution")
    return problem.exact


def datum(name: str, value: Field | float | FromExact, coords: Sequence[Array]) -> Array | float:
    """Values of a boundary datum that is not taken from the exact solution."""
    if isinstance(value, FromExact):
        raise TypeError(f"the {name} is taken from the exact solution")
    return values(name, value, coords)


def right_hand_side(
    problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array
) -> Array | float:
    """The datum g of a condition at boundary points, with `from exact` resolved."""
    match condition:
        case Dirichlet(value=value):
            if value is FROM_EXACT:
                return exact_values(problem, coords)
            return datum("Dirichlet value", value, coords)
        case Neumann(flux=flux):
            return exact_flux(problem, coords, normals) if flux is FROM_EXACT else datum("flux", flux, coords)
        case Robin(coefficient=coefficient, value=value):
            if value is FROM_EXACT:
                h = datum("Robin coefficient", coefficient, coords)
                return exact_flux(problem, coords, normals) + h * exact_values(problem, coords)
            return datum("Robin value", value, coords)


def natural_density(
    problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array
) -> QuadraticDensity:
    """Boundary energy ``1/2 h u^2 - g u`` of a Neumann (h = 0) or Robin condition."""
    g = right_hand_side(problem, condition, coords, normals)
    hessian: dict[tuple[int, int], Array | float] = {}
    if isinstance(condition, Robin):
        hessian[0, 0] = datum("Robin coefficient", condition.coefficient, coords)
    return QuadraticDensity(hessian, {0: g})


def residual(
    problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array, jet: Array
) -> Array:
    """How far the field with the jet (u, grad u) is from satisfying `condition` at boundary points."""
    g = right_hand_side(problem, condition, coords, normals)
    if isinstance(condition, Dirichlet):
        left = jet[0]
    else:
        left = problem.equation.conormal_flux(coords, jet[1:], normals)
        if isinstance(condition, Robin):
            left = left + datum("Robin coefficient", condition.coefficient, coords) * jet[0]
    difference: Array = np.abs(left - g)
    return difference
