"""Orders of the Ritz method on closed-form solutions: p + 1 in L2, p in H1.

u = (product of the primitives' polynomials) * (a generic function), or explicit data plus such a product, so
that neither the extension of the data nor the weight hands the solver the answer.
"""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, cosh, exp, sin
from rfm.errors import NumericsError
from rfm.geometry import ball, disk, rectangle
from solvers import ritz
from solvers.equations.poisson import Poisson
from solvers.norms import boundary_errors, error_norms
from solvers.problem import (
    FROM_EXACT,
    Dirichlet,
    Discretization,
    Neumann,
    Problem,
    Robin,
    SolverOptions,
)

OUTER = disk(center=(0.5, 0.5), radius=0.4).named("outer")
INNER = disk(center=(0.5, 0.5), radius=0.1).named("inner")
ANNULUS = OUTER - INNER


def annulus_solution(x, y):
    """Vanishes on both circles; not a multiple of the weight by a polynomial."""
    s = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return (0.16 - s) * (s - 0.01) * exp(x) * sin(3 * y)


def solve(problem, degree, grid, **more):
    return ritz.solve(problem, Discretization(degree=degree, grid=grid, **more))


def errors_of(problem, degree, grids, **more):
    rows = []
    for grid in grids:
        solution = solve(problem, degree, grid, **more)
        norms = error_norms(solution.trial, problem.exact, solution.background)
        rows.append((max(solution.background.grid.spacing), norms.l2, norms.h1))
    return np.array(rows)


def orders(rows):
    steps = np.diff(np.log(rows), axis=0)
    return steps[:, 1:] / steps[:, :1]


ASYMPTOTIC = {1: (64, 128, 256), 2: (64, 96, 144), 3: (32, 64, 128), 4: (48, 64, 96), 5: (24, 32, 48)}
"""Grids fine enough for the order to show, coarse enough to stay above rounding."""


@pytest.mark.parametrize("degree", ASYMPTOTIC)
def test_order_on_the_annulus(degree):
    problem = Problem(
        ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), 0.0),), exact=annulus_solution
    )
    observed = orders(errors_of(problem, degree, ASYMPTOTIC[degree]))
    assert np.abs(observed[:, 0] - (degree + 1)).max() < 0.15, observed
    assert np.abs(observed[:, 1] - degree).max() < 0.15, observed


@pytest.mark.parametrize(("degree", "grid", "limit"), [(3, 64, 1e-8), (5, 64, 1e-12)])
def test_accuracy_on_the_annulus(degree, grid, limit):
    problem = Problem(
        ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), 0.0),), exact=annulus_solution
    )
    solution = solve(problem, degree, grid)
    assert error_norms(solution.trial, annulus_solution, solution.background).l2 < limit


@pytest.mark.parametrize(("degree", "limit"), [(3, 2e-7), (5, 2e-9)])
def test_an_r_function_serves_as_weight(degree, limit):
    def u(x, y):
        s = (x - 0.5) ** 2 + (y - 0.5) ** 2
        return sin((0.16 - s) * (0.01 - s))

    problem = Problem(ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), 0.0),), exact=u)
    solution = solve(problem, degree, 64, weight="r0")
    assert error_norms(solution.trial, u, solution.background).l2 < limit


def test_high_degree_needs_few_unknowns():
    problem = Problem(
        ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), 0.0),), exact=annulus_solution
    )
    solution = ritz.solve(problem, Discretization(degree=6, spacing=0.1))
    assert solution.dofs <= 160
    assert error_norms(solution.trial, annulus_solution, solution.background).l2 < 5e-9


@pytest.mark.parametrize("degree", [6, 7, 8])
def test_high_degrees_are_sound(degree):
    problem = Problem(
        ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), 0.0),), exact=annulus_solution
    )
    observed = errors_of(problem, degree, (8, 12))[:, 1]
    assert observed[1] < 10 * 1.5 ** -(degree + 1) * observed[0]
    assert observed[1] < 2e-9


@pytest.mark.parametrize(("degree", "limit"), [(3, 1e-6), (5, 1e-9)])
def test_plate_with_three_holes(degree, limit):
    plate = rectangle(min=(-1, -1), max=(1, 1)).named("plate")
    for i, (x, y, r) in enumerate([(-0.4, -0.3, 0.2), (0.45, 0.35, 0.25), (0.3, -0.5, 0.15)]):
        plate = plate - disk(center=(x, y), radius=r).named(f"hole{i}")

    def u(x, y):
        return exp(x) * sin(y) + 0.3 * cos(2 * x) * cosh(y)

    problem = Problem(plate, Poisson(source=None), (Dirichlet(plate.part("all"), FROM_EXACT),), exact=u)
    solution = solve(problem, degree, 64)
    assert error_norms(solution.trial, u, solution.background).l2 < limit


def test_convex_corners_keep_the_order():
    lens = OUTER & rectangle(min=(0.22, 0.26), max=(0.84, 0.82)).named("plate")

    def u(x, y):
        corners = (x - 0.22) * (0.84 - x) * (y - 0.26) * (0.82 - y)
        return (0.16 - (x - 0.5) ** 2 - (y - 0.5) ** 2) * corners * exp(x) * sin(3 * y)

    problem = Problem(lens, Poisson(source=None), (Dirichlet(lens.part("all"), 0.0),), exact=u)
    rows = errors_of(problem, 4, (32, 64))
    assert rows[-1, 1] < 1e-10
    assert orders(rows)[-1, 0] > 4.85


def test_natural_conditions_converge():
    """Dirichlet inside, flux and Robin outside: the residual of the natural conditions goes down like h^p."""

    def u(x, y):
        return exp(x) * sin(2 * y) + x * y

    outer, inner = ANNULUS.part("outer"), ANNULUS.part("inner")
    left, right = (
        outer.restricted(lambda x, y: 0.5 - x, "left"),
        outer.restricted(lambda x, y: x - 0.5, "right"),
    )
    conditions = (
        Dirichlet(inner, FROM_EXACT),
        Neumann(left, FROM_EXACT),
        Robin(right, 2.0, FROM_EXACT),
    )
    problem = Problem(ANNULUS, Poisson(source=None, conductivity=lambda x, y: 1 + x * y), conditions, exact=u)
    residuals, errors = [], []
    for grid in (16, 32, 64):
        solution = solve(problem, 3, grid)
        worst = boundary_errors(problem, solution.trial, solution.background)
        assert worst["inner"] < 1e-14
        residuals.append(max(worst["left"], worst["right"]))
        errors.append(error_norms(solution.trial, u, solution.background).l2)
    print(errors, residuals)
    assert np.log2(errors[1] / errors[2]) > 3.7
    assert np.log2(residuals[0] / residuals[2]) / 2 > 2.5


def test_pure_neumann_is_fixed_by_its_mean():
    def u(x, y):
        return cos(2 * x) * exp(y)

    problem = Problem(ANNULUS, Poisson(source=None), (Neumann(ANNULUS.part("all"), FROM_EXACT),), exact=u)
    solution = solve(problem, 4, 24)
    assert error_norms(solution.trial, u, solution.background).l2 < 1e-6


def test_incompatible_fluxes_are_refused():
    problem = Problem(ANNULUS, Poisson(source=1.0), (Neumann(ANNULUS.part("all"), 0.0),))
    with pytest.raises(NumericsError, match=r"their sum is 0\.471239"):
        solve(problem, 2, 16)


def test_order_on_the_ball():
    sphere = ball(center=(0, 0, 0), radius=1).named("ball")

    def u(x, y, z):
        return (1 - x * x - y * y - z * z) * exp(x) * sin(y + 0.4) * cos(z)

    problem = Problem(sphere, Poisson(source=None), (Dirichlet(sphere.part("all"), 0.0),), exact=u)
    rows = errors_of(problem, 3, (12, 16, 24))
    assert rows[-1, 1] < 1e-5
    assert abs(orders(rows)[-1, 0] - 4) < 0.2, orders(rows)


@pytest.mark.parametrize("method", ["dense", "cg"])
def test_slivers_do_not_matter(method):
    """The right side of a square passes a grid line by 1e-1 to 1e-12 of a cell."""

    def u(x, y):
        return x * (right - x) * y * (1 - y) * exp(x) * sin(3 * y + 1)

    errors, iterations = [], []
    for exponent in range(1, 13):
        h = 1 / 16
        right = 1 + h * 10.0**-exponent
        domain = rectangle(min=(0, 0), max=(right, 1)).named("square")
        problem = Problem(domain, Poisson(source=None), (Dirichlet(domain.part("all"), 0.0),), exact=u)
        solution = ritz.solve(
            problem, Discretization(degree=3, spacing=h), SolverOptions(linear=method, tolerance=1e-10)
        )
        errors.append(error_norms(solution.trial, u, solution.background).l2)
        iterations.append(max(solution.linear.iterations, 1))
    assert max(errors) < 3 * min(errors), errors
    assert max(iterations) < 3 * min(iterations), iterations
