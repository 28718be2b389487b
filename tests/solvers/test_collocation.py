"""Collocation: the orders of least squares from points alone."""

from __future__ import annotations

import numpy as np
import pytest
from methods_problems import ANNULUS, dirichlet, l2_error, mixed, observed_orders, on_the_ball, smooth

from rfm.errors import DiscretizationError, NumericsError
from solvers import pipeline
from solvers.collocation import Collocation, point_batches
from solvers.equations.poisson import Poisson
from solvers.least_squares import LeastSquares
from solvers.problem import FROM_EXACT, Discretization, Neumann, Problem, SolverOptions


@pytest.mark.parametrize(
    ("degree", "grids", "order"), [(2, (32, 64), 2), (3, (40, 64), 4), (4, (24, 48), 5), (5, (24, 32), 6)]
)
def test_order_with_dirichlet_conditions(degree, grids, order):
    observed, errors = observed_orders(dirichlet(smooth, FROM_EXACT), Collocation(), degree, grids)
    assert observed[-1] > order - 0.15, (observed, errors)


def test_order_with_natural_conditions():
    observed, errors = observed_orders(mixed(), Collocation(), 3, (12, 24, 48))
    assert observed.min() > 3.85, (observed, errors)


def test_order_on_the_ball():
    observed, errors = observed_orders(on_the_ball(), Collocation(), 3, (6, 9), quadrature_points=4)
    assert observed[-1] > 3.7, (observed, errors)


def test_it_is_as_accurate_as_least_squares():
    problem = dirichlet(smooth, FROM_EXACT)
    few, all_points = (l2_error(problem, method, 4, 32) for method in (Collocation(), LeastSquares()))
    assert few < 1.5 * all_points


def test_all_points_lie_in_the_domain_and_inner_cells_have_few():
    problem = dirichlet()
    background = pipeline.solve(problem, Discretization(degree=2, grid=12), Collocation()).background
    batches = list(point_batches(background, 2))
    inside = [
        np.asarray(problem.domain.membership(*batch.points(background.grid)))[batch.weights > 0]
        for batch in batches
    ]
    assert min(values.min() for values in inside) > 0
    assert len(inside[0]) == 4 * len(background.rules.inner.cells)


def test_more_points_are_allowed():
    assert l2_error(mixed(), Collocation(points=4), 3, 32) < 1e-6


def test_degree_one_has_no_residual():
    with pytest.raises(DiscretizationError, match="collocation needs derivatives of order 2"):
        pipeline.solve(dirichlet(), Discretization(degree=1), Collocation())


def test_fluxes_only_are_refused():
    problem = Problem(
        ANNULUS, Poisson(source=None), (Neumann(ANNULUS.part("all"), FROM_EXACT),), exact=smooth
    )
    with pytest.raises(NumericsError, match="choose method: ritz"):
        pipeline.solve(problem, Discretization(grid=16), Collocation())


def test_a_square_solver_is_refused():
    with pytest.raises(DiscretizationError, match="choose auto or one of qr"):
        pipeline.solve(dirichlet(), Discretization(grid=16), Collocation(), SolverOptions(linear="cg"))
