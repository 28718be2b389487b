"""Oblique derivatives: weak form, strong residuals, exact structure, and directions that cannot be."""

from __future__ import annotations

import re

import numpy as np
import pytest

from rfm.calculus.functions import exp, sin
from rfm.errors import DiscretizationError, NumericsError, StructureError
from rfm.geometry import ball, disk, rectangle
from solvers import pipeline
from solvers.equations.poisson import Poisson
from solvers.methods import METHODS
from solvers.norms import boundary_errors, error_norms
from solvers.problem import FROM_EXACT, Dirichlet, Discretization, Neumann, Oblique, Problem, Robin

ANNULUS = disk(center=(0.5, 0.5), radius=0.4).named("outer") - disk(center=(0.5, 0.5), radius=0.1).named(
    "inner"
)
BOX = rectangle(min=(0, 0), max=(1.2, 1)).named("r")
TURNED = (lambda x, y: (x - 0.5) - 0.6 * (y - 0.5), lambda x, y: (y - 0.5) + 0.6 * (x - 0.5))


def exact(x, y):
    return 1 + 0.5 * x - y + 4 * ((x - 0.5) ** 2 + (y - 0.5) ** 2 - 0.01) * exp(x) * sin(3 * y)


def on_the_annulus(direction=TURNED, coefficient=0.5, conductivity=lambda x, y: 1 + 0.3 * x * y):
    return Problem(
        ANNULUS,
        Poisson(source=None, conductivity=conductivity),
        (
            Dirichlet(ANNULUS.part("inner"), lambda x, y: 1 + 0.5 * x - y),
            Oblique(ANNULUS.part("outer"), direction, coefficient, FROM_EXACT),
        ),
        exact,
    )


def solve(problem, degree, grid, method="galerkin", conditions="natural"):
    return pipeline.solve(
        problem, Discretization(degree=degree, grid=grid, conditions=conditions), METHODS[method]
    )


def error(solution):
    return error_norms(solution.trial, solution.problem.exact, solution.background).l2


def residual(solution):
    return max(boundary_errors(solution.problem, solution.trial, solution.background).values())


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_galerkin_has_full_order(degree):
    grids = (16, 32)
    errors = [error(solve(on_the_annulus(), degree, grid)) for grid in grids]
    order = np.log(errors[0] / errors[1]) / np.log(grids[1] / grids[0])
    assert degree + 1 - 0.3 < order < degree + 1 + 0.8


@pytest.mark.parametrize("method", ["least-squares", "collocation"])
def test_strong_residuals_have_full_order(method):
    errors = [error(solve(on_the_annulus(), 4, grid, method)) for grid in (12, 24)]
    assert np.log2(errors[0] / errors[1]) > 4.7


def test_as_good_as_the_same_condition_written_as_a_flux():
    """Along the normal an oblique derivative is Robin's condition."""
    along = Problem(
        ANNULUS,
        Poisson(source=None),
        (
            Dirichlet(ANNULUS.part("inner"), FROM_EXACT),
            Oblique(
                ANNULUS.part("outer"),
                (lambda x, y: 5 * (x - 0.5), lambda x, y: 5 * (y - 0.5)),
                0.7,
                FROM_EXACT,
            ),
        ),
        exact,
    )
    robin = Problem(
        along.domain,
        along.equation,
        (along.conditions[0], Robin(ANNULUS.part("outer"), 0.35, FROM_EXACT)),
        exact,
    )
    one, two = (solve(problem, 3, 16) for problem in (along, robin))
    assert np.abs(one.linear.x - two.linear.x).max() < 1e-9 * np.abs(two.linear.x).max()


@pytest.mark.parametrize("method", ["galerkin", "least-squares", "collocation"])
def test_exact(method):
    natural, by_structure = (solve(on_the_annulus(), 3, 32, method, mode) for mode in ("natural", "exact"))
    assert residual(by_structure) < 1e-11
    assert error(by_structure) < 2.5 * error(natural)


def test_in_space_beside_a_flux():
    solid = ball(center=(0, 0, 0), radius=1.0).named("b")
    upper = solid.part("all").restricted(lambda x, y, z: z)
    lower = solid.part("all").restricted(lambda x, y, z: -z)
    problem = Problem(
        solid,
        Poisson(source=None, reaction=1.0),
        (
            Oblique(
                upper,
                (lambda x, y, z: x - 0.4 * y, lambda x, y, z: y + 0.4 * x, lambda x, y, z: z),
                1.0,
                FROM_EXACT,
            ),
            Neumann(lower, FROM_EXACT),
        ),
        lambda x, y, z: exp(0.5 * x) * sin(y + 0.5 * z),
    )
    errors = [error(solve(problem, 2, grid)) for grid in (4, 8)]
    assert np.log2(errors[0] / errors[1]) > 2.5


def test_no_energy_no_ritz():
    with pytest.raises(
        DiscretizationError, match="oblique derivative there is no energy; choose method: galerkin"
    ):
        solve(on_the_annulus(), 3, 8, "ritz")
    only = Problem(ANNULUS, Poisson(), (Oblique(ANNULUS.part("all"), TURNED, 0.0, 1.0),))
    for method in ("galerkin", "least-squares"):
        with pytest.raises(NumericsError, match="oblique derivatives and fluxes alone leave a constant free"):
            solve(only, 2, 8, method)


@pytest.mark.parametrize(
    ("domain", "direction", "message"),
    [
        (ANNULUS, (1.0, 0.0), r"outer is tangential near \(0\.\d+, 0\.\d+\): turn it, or prescribe a value"),
        (ANNULUS, (lambda x, y: -(y - 0.5), lambda x, y: x - 0.5), "is tangential near"),
        (ANNULUS, (1.0, 0.0, 2.0), re.escape("has 3 components, the domain 2 dimensions: give one for each")),
        (ANNULUS, (0.0, 0.0), r"is zero near \("),
        (BOX, (0.0, 1.0), r"r\.right is tangential near \(1\.2, "),
    ],
)
def test_directions_that_cannot_be(domain, direction, message):
    part = domain.part("outer" if domain is ANNULUS else "r.right")
    problem = Problem(domain, Poisson(), (Oblique(part, direction),))
    with pytest.raises(StructureError, match=message):
        solve(problem, 2, 8)


def test_signs_may_differ_from_surface_to_surface():
    """Outward on one circle, inward on the other is no contradiction."""
    problem = Problem(
        ANNULUS,
        Poisson(source=None, reaction=1.0),
        (Oblique(ANNULUS.part("all"), (lambda x, y: x - 0.5, lambda x, y: y - 0.5), 0.0, FROM_EXACT),),
        exact,
    )
    assert error(solve(problem, 3, 16)) < 1e-5
