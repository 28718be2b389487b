"""Least squares: orders on closed forms, insensitivity to quadrature, weights, and the choice of the linear solver."""

from __future__ import annotations

import numpy as np
import pytest
from methods_problems import ANNULUS, dirichlet, l2_error, mixed, observed_orders, on_the_ball, smooth

from rfm.errors import DiscretizationError, NumericsError
from solvers import pipeline, systems
from solvers.equations.poisson import Poisson
from solvers.least_squares import LeastSquares
from solvers.norms import boundary_errors, error_norms
from solvers.problem import FROM_EXACT, Discretization, Neumann, Problem, SolverOptions
from solvers.ritz import Ritz


@pytest.mark.parametrize(("degree", "grids", "order"), [(2, (48, 96), 2), (3, (32, 64), 4), (5, (24, 36), 6)])
def test_order_with_dirichlet_conditions(degree, grids, order):
    """min(p + 1, 2 p - 2): the error of p = 2 is bound by that of the second derivatives, squared."""
    observed, errors = observed_orders(dirichlet(smooth, FROM_EXACT), LeastSquares(), degree, grids)
    assert np.abs(observed - order).max() < 0.3, (observed, errors)


def test_order_with_natural_conditions():
    problem = mixed(conductivity=lambda x, y: 1 + x * y, reaction=0.5)
    observed, errors = observed_orders(problem, LeastSquares(), 3, (32, 64))
    assert observed[-1] > 3.85, (observed, errors)
    assert errors[-1] < 5e-8


def test_order_on_the_ball():
    observed, errors = observed_orders(on_the_ball(), LeastSquares(), 3, (10, 14))
    assert observed[-1] > 3.7, (observed, errors)


def test_advection_needs_nothing_special():
    wind = (lambda x, y: 5 * y + 1, lambda x, y: -3 * x)
    observed, errors = observed_orders(mixed(advection=wind), LeastSquares(), 3, (32, 64))
    assert observed[-1] > 3.85, (observed, errors)


@pytest.mark.parametrize(("points", "gain"), [(2, 100), (3, 10), (4, 2)])
def test_it_is_more_accurate_than_ritz_where_cut_cells_are_integrated_roughly(points, gain):
    """The residual of the exact solution vanishes at every point, so that the rule hardly matters.

    With p + 1 = 4 points in the pieces of cut cells the errors for p = 3, N = 32 are those of the literature on the
    method (least squares 3 times more accurate); with p + 3 points both agree.
    """
    rough = {"quadrature_points": points, "moment_fitting": False, "spacing": 1 / 32}
    problem = dirichlet(smooth, FROM_EXACT)
    least = error_with_good_norms(problem, LeastSquares(), 3, **rough)
    ritz = error_with_good_norms(problem, Ritz(), 3, **rough)
    assert least < ritz / gain
    assert least < 6e-9


def test_it_agrees_with_ritz_where_cut_cells_are_integrated_well():
    problem = dirichlet(smooth, FROM_EXACT)
    least, ritz = (l2_error(problem, method, 4, 48) for method in (LeastSquares(), Ritz()))
    assert 0.5 < least / ritz < 2


def error_with_good_norms(problem, method, degree, **rough):
    """Error of a solution by a rule that does not share the weakness of the one it was computed with."""
    solution = pipeline.solve(problem, Discretization(degree=degree, **rough), method)
    good = pipeline.solve(problem, Discretization(degree=degree, spacing=rough["spacing"]), Ritz()).background
    return error_norms(solution.trial, problem.exact, good).l2


@pytest.mark.parametrize("problem", [dirichlet(), mixed(conductivity=lambda x, y: 1 + x * y)])
def test_qr_and_normal_equations_agree(problem):
    discretization = Discretization(degree=3, grid=24)
    found = [
        pipeline.solve(problem, discretization, LeastSquares(), SolverOptions(linear=linear))
        for linear in ("qr", "dense")
    ]
    first, second = (solution.trial.splines[0].coefficients for solution in found)
    # the normal equations are made with moment-fitted rules, the rows with those they were fitted to
    assert np.abs(first - second).max() < 1e-4 * np.abs(first).max()
    errors = [error_norms(s.trial, problem.exact, s.background).l2 for s in found]
    assert abs(errors[0] - errors[1]) < 0.02 * errors[0]


def test_well_conditioned_normal_equations_are_kept(monkeypatch):
    problem, discretization = dirichlet(), Discretization(degree=3, grid=16)
    kept = pipeline.solve(problem, discretization, LeastSquares()).linear
    assert (kept.method, kept.reason.endswith(": well conditioned")) == ("dense", True)
    monkeypatch.setattr(systems, "WELL_CONDITIONED", 10.0)
    turned = pipeline.solve(problem, discretization, LeastSquares()).linear
    assert turned.method == "qr"
    assert "too much for their factorisation" in turned.reason
    monkeypatch.setattr(systems, "QR_WORK", 10.0)
    assert "too large for QR" in pipeline.solve(problem, discretization, LeastSquares()).linear.reason


def test_rows_keep_the_digits_of_a_frame_that_normal_equations_lose():
    """Polynomials on a disk with a hole: an energy keeps half of the digits, rows keep all."""
    problem, discretization = dirichlet(), Discretization(degree=14, grid=8, basis="chebyshev")
    rows, energy = (pipeline.solve(problem, discretization, method) for method in (LeastSquares(), Ritz()))
    errors = [error_norms(s.trial, problem.exact, s.background).l2 for s in (rows, energy)]
    assert rows.linear.method == "qr"
    assert errors[0] < 1e-13
    assert errors[1] < 1e-8


def test_boundary_weight_moves_the_error_to_the_inside():
    problem, discretization = mixed(), Discretization(degree=3, grid=24)
    light, heavy = (
        pipeline.solve(problem, discretization, LeastSquares(boundary_weight=weight))
        for weight in (0.01, 100.0)
    )
    left = [boundary_errors(problem, s.trial, s.background)["left"] for s in (light, heavy)]
    assert left[1] < 0.5 * left[0]


def test_weight_of_the_only_equation_changes_nothing_but_the_boundary():
    problem, discretization = mixed(), Discretization(degree=3, grid=16)
    scaled = pipeline.solve(problem, discretization, LeastSquares(weights=(7.0,), boundary_weight=7.0))
    plain = pipeline.solve(problem, discretization, LeastSquares())
    first, second = (s.trial.splines[0].coefficients for s in (scaled, plain))
    assert np.abs(first - second).max() < 1e-9 * np.abs(first).max()


def test_fluxes_only_fix_the_mean():
    problem = Problem(
        ANNULUS, Poisson(source=None), (Neumann(ANNULUS.part("all"), FROM_EXACT),), exact=smooth
    )
    assert l2_error(problem, LeastSquares(), 4, 24) < 1e-6


def test_incompatible_fluxes_are_refused():
    problem = Problem(ANNULUS, Poisson(source=1.0), (Neumann(ANNULUS.part("all"), 0.0),))
    with pytest.raises(NumericsError, match=r"their sum is 0\.471239"):
        pipeline.solve(problem, Discretization(degree=3, grid=16), LeastSquares())


def test_degree_one_has_no_residual():
    with pytest.raises(DiscretizationError, match="derivatives of order 2 of u: use degree 2 or more"):
        pipeline.solve(dirichlet(), Discretization(degree=1), LeastSquares())
