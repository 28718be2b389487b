"""Galerkin's method: it agrees with Ritz's where there is an energy, and serves advection where there is none."""

from __future__ import annotations

import numpy as np
import pytest
from methods_problems import ANNULUS, dirichlet, mixed, observed_orders, on_the_ball, smooth

from rfm.errors import DiscretizationError, NumericsError
from solvers import pipeline
from solvers.equations.poisson import Poisson
from solvers.galerkin import Galerkin
from solvers.problem import FROM_EXACT, Discretization, Neumann, Problem, SolverOptions
from solvers.ritz import Ritz

WIND = (lambda x, y: 5 * y + 1, lambda x, y: -3 * x)


def still(x, y):
    return 0.0 * x


def unknowns(problem, method, **options):
    solution = pipeline.solve(problem, Discretization(degree=3, grid=16), method, SolverOptions(**options))
    return solution.trial.splines[0].coefficients


@pytest.mark.parametrize("problem", [dirichlet(), mixed(conductivity=lambda x, y: 1 + x * y, reaction=0.5)])
def test_it_is_ritz_where_there_is_an_energy(problem):
    ritz, galerkin = unknowns(problem, Ritz()), unknowns(problem, Galerkin())
    assert np.abs(ritz - galerkin).max() <= 1e-13 * np.abs(ritz).max()


def test_the_general_assembly_agrees_with_the_symmetric_one():
    """An advection that is zero, but is not known to be."""
    ritz = unknowns(mixed(), Ritz())
    galerkin = unknowns(mixed(advection=(still, still)), Galerkin())
    assert np.abs(ritz - galerkin).max() <= 1e-11 * np.abs(ritz).max()


@pytest.mark.parametrize(
    ("degree", "grids"), [(1, (64, 128)), (2, (64, 128)), (3, (32, 64)), (4, (48, 64)), (5, (24, 32))]
)
def test_order_with_advection(degree, grids):
    observed, errors = observed_orders(dirichlet(advection=WIND), Galerkin(), degree, grids)
    assert np.abs(observed - (degree + 1)).max() < 0.15, (observed, errors)


def test_order_with_advection_reaction_and_natural_conditions():
    problem = mixed(conductivity=lambda x, y: 1 + x * y, reaction=0.3, advection=WIND)
    observed, errors = observed_orders(problem, Galerkin(), 3, (32, 64))
    assert observed[-1] > 3.85, (observed, errors)
    assert errors[-1] < 1e-8


def test_order_with_advection_on_the_ball():
    wind = (lambda x, y, z: 3 * y, 1.0, lambda x, y, z: -z)
    observed, errors = observed_orders(on_the_ball(advection=wind), Galerkin(), 3, (10, 14))
    assert 3.7 < observed[-1] < 4.6, (observed, errors)


def test_a_smooth_solution_survives_dominating_advection():
    """Peclet number |b| h / 2k of 7 across a cell of the coarser grid."""
    problem = dirichlet(conductivity=0.002, advection=(1.0, 0.5))
    observed, errors = observed_orders(problem, Galerkin(), 3, (32, 64))
    assert observed[-1] > 3.8, (observed, errors)


@pytest.mark.parametrize("linear", ["dense", "superlu", "gmres"])
def test_linear_solvers_agree(linear):
    problem = dirichlet(advection=WIND)
    expected = unknowns(problem, Galerkin())
    found = unknowns(problem, Galerkin(), linear=linear)
    assert np.abs(found - expected).max() < 1e-8 * np.abs(expected).max()


def test_an_energy_is_refused_with_advection():
    with pytest.raises(DiscretizationError, match="there is no energy; choose method: galerkin"):
        pipeline.solve(dirichlet(advection=WIND), Discretization(), Ritz())


def test_a_symmetric_linear_solver_is_refused_with_advection():
    with pytest.raises(DiscretizationError, match="linear solver cg does not suit the method galerkin"):
        pipeline.solve(dirichlet(advection=WIND), Discretization(), Galerkin(), SolverOptions(linear="cg"))


def test_advection_with_fluxes_only_is_refused():
    problem = Problem(
        ANNULUS,
        Poisson(source=None, advection=WIND),
        (Neumann(ANNULUS.part("all"), FROM_EXACT),),
        exact=smooth,
    )
    with pytest.raises(NumericsError, match="fix it somewhere"):
        pipeline.solve(problem, Discretization(grid=16), Galerkin())
