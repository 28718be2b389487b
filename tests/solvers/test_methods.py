"""The registry of methods, what they refuse, and the published table of what combines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from methods_problems import ANNULUS, OUTER, dirichlet, l2_error, mixed, smooth

from rfm.calculus.functions import cos, exp, sin
from rfm.errors import DiscretizationError
from solvers import combinations, pipeline
from solvers.equations.elasticity import Elasticity
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.methods import METHODS
from solvers.problem import (
    FROM_EXACT,
    Clamped,
    Dirichlet,
    Discretization,
    Neumann,
    Problem,
    SimplySupported,
    SolverOptions,
    Traction,
)

PAGE = Path(__file__).parents[2] / "docs" / "combinations.md"


def displacement_x(x, y):
    return exp(x) * sin(2 * y)


def displacement_y(x, y):
    return cos(x + y) * y


BODY = Problem(
    ANNULUS,
    Elasticity(body_force=None),
    (
        Dirichlet(ANNULUS.part("inner"), (FROM_EXACT, FROM_EXACT)),
        Traction(ANNULUS.part("outer"), FROM_EXACT),
    ),
    exact=(displacement_x, displacement_y),
)
PLATE = Problem(
    OUTER, Plate(load=None), (SimplySupported(OUTER.part("all"), FROM_EXACT, FROM_EXACT),), exact=smooth
)


def test_names_are_those_of_the_methods_and_of_the_schema():
    from rfm.app.schema import discretization

    assert all(method.name == name for name, method in METHODS.items())
    assert tuple(METHODS) == discretization.METHODS


def test_the_published_table_is_current():
    assert PAGE.read_text(encoding="utf-8") == combinations.markdown(), (
        "run: python docs/render_combinations.py"
    )


@pytest.mark.parametrize("name", METHODS)
def test_vectors_by_every_method(name):
    observed = np.log2(l2_error(BODY, METHODS[name], 4, 16) / l2_error(BODY, METHODS[name], 4, 32))
    assert observed > 4.7


@pytest.mark.parametrize(
    ("name", "order"), [("ritz", 6), ("galerkin", 6), ("least-squares", 4), ("collocation", 4)]
)
def test_fourth_order_by_every_method(name, order):
    """min(p + 1, 2 (p + 1) - s) and min(p + 1, 2 (p + 1) - 2 s) with p = 5, s = 4."""
    errors = [l2_error(PLATE, METHODS[name], 5, grid) for grid in (12, 24)]
    assert np.log2(errors[0] / errors[1]) > order - 0.3, errors


@pytest.mark.parametrize("equation", combinations.EQUATIONS)
@pytest.mark.parametrize("name", METHODS)
def test_what_the_table_refuses_is_refused_and_what_it_promises_is_solved(name, equation):
    data = combinations.EQUATIONS[equation]
    method, domain = METHODS[name], combinations.DOMAIN
    condition = Clamped if equation == "plate" else Dirichlet
    problem = Problem(domain, data, (condition(domain.part("all")),))
    cell = dict(
        zip(METHODS, next(row for row in combinations.equation_rows() if row[0] == equation)[1:], strict=True)
    )[name]
    if not cell.isdigit():
        with pytest.raises(DiscretizationError, match="choose method: "):
            pipeline.solve(problem, Discretization(degree=3, grid=8), method)
        return
    degree = int(cell)
    solution = pipeline.solve(problem, Discretization(degree=degree, grid=8), method)
    assert np.isfinite(solution.trial.splines[0].coefficients).all()
    if degree > 1:
        with pytest.raises(DiscretizationError, match=f"use degree {degree} or more"):
            pipeline.solve(problem, Discretization(degree=degree - 1, grid=8), method)


@pytest.mark.parametrize("name", ["ritz", "least-squares", "galerkin"])
def test_all_conditions_exact_by_every_method(name):
    conditions = (Dirichlet(ANNULUS.part("inner"), FROM_EXACT), Neumann(ANNULUS.part("outer"), FROM_EXACT))
    problem = Problem(ANNULUS, Poisson(source=None), conditions, exact=smooth)
    errors = [l2_error(problem, METHODS[name], 4, grid, conditions="exact") for grid in (16, 32)]
    assert np.log2(errors[0] / errors[1]) > 4.5, errors


def test_exact_conditions_ask_for_one_degree_more():
    with pytest.raises(DiscretizationError, match="of order 3 of the spline: use degree 3 or more"):
        pipeline.solve(mixed(), Discretization(degree=2, conditions="exact"), METHODS["least-squares"])


def test_a_basis_without_the_derivatives_is_refused():
    with pytest.raises(DiscretizationError, match="use degree 2 or more of basis: radial, got 1"):
        pipeline.solve(dirichlet(), Discretization(degree=1, basis="radial"), METHODS["least-squares"])
    clamped = Problem(OUTER, Plate(), (Clamped(OUTER.part("all")),))
    with pytest.raises(DiscretizationError, match="none of any degree: use basis: web-spline"):
        pipeline.solve(clamped, Discretization(degree=3, basis="radial"), METHODS["least-squares"])


def test_a_linear_solver_of_another_method_is_refused():
    with pytest.raises(DiscretizationError, match="linear solver qr does not suit the method ritz"):
        pipeline.solve(dirichlet(), Discretization(), METHODS["ritz"], SolverOptions(linear="qr"))
