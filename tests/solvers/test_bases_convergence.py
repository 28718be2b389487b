"""How fast each basis converges on closed-form solutions, and that all find the same field."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.errors import DiscretizationError
from rfm.geometry import ball, disk, rectangle
from solvers import ritz
from solvers.equations.poisson import Poisson
from solvers.galerkin import Galerkin
from solvers.least_squares import LeastSquares
from solvers.norms import boundary_errors, error_norms
from solvers.pipeline import solve as solve_by
from solvers.problem import FROM_EXACT, Dirichlet, Discretization, Neumann, Problem, Robin

OUTER = disk(center=(0.5, 0.5), radius=0.4).named("outer")
ANNULUS = OUTER - disk(center=(0.5, 0.5), radius=0.1).named("inner")
LENS = OUTER & rectangle(min=(0.22, 0.26), max=(0.84, 0.82)).named("plate")


def on_the_annulus(x, y):
    s = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return (0.16 - s) * (s - 0.01) * exp(x) * sin(3 * y)


def on_the_lens(x, y):
    corners = (x - 0.22) * (0.84 - x) * (y - 0.26) * (0.82 - y)
    return (0.16 - (x - 0.5) ** 2 - (y - 0.5) ** 2) * corners * exp(x) * sin(3 * y)


def generic(x, y):
    return exp(x) * sin(2 * y) + x * y


def dirichlet(domain, exact):
    return Problem(domain, Poisson(source=None), (Dirichlet(domain.part("all"), 0.0),), exact=exact)


MIXED = Problem(
    ANNULUS,
    Poisson(source=None, conductivity=lambda x, y: 1 + x * y),
    (Dirichlet(ANNULUS.part("inner"), FROM_EXACT), Robin(ANNULUS.part("outer"), 2.0, FROM_EXACT)),
    exact=generic,
)


def error(solution):
    return error_norms(solution.trial, solution.problem.exact, solution.background).l2


def errors(problem, name, degrees, grid=8):
    solve = [ritz.solve(problem, Discretization(degree=p, grid=grid, basis=name)) for p in degrees]
    return np.array([error(solution) for solution in solve])


@pytest.mark.parametrize("name", ["chebyshev", "legendre"])
@pytest.mark.parametrize(
    ("problem", "limit"),
    [(dirichlet(ANNULUS, on_the_annulus), 1e-11), (dirichlet(LENS, on_the_lens), 2e-13)],
    ids=["annulus", "disk-and-rectangle"],
)
def test_polynomials_converge_geometrically(name, problem, limit):
    """A factor of more than 100 for two degrees, to rounding times the root of the condition number."""
    found = errors(problem, name, (4, 6, 8, 10, 12))
    assert (found[:3] / found[1:4] > 100).all(), found
    assert found[3] < limit
    assert found[4] < 10 * limit


@pytest.mark.parametrize("name", ["chebyshev", "legendre"])
def test_a_degree_beyond_rounding_does_no_harm(name):
    """The functions have become dependent; the solver takes as many as there are digits for."""
    problem = dirichlet(ANNULUS, on_the_annulus)
    solution = ritz.solve(problem, Discretization(degree=22, grid=8, basis=name))
    assert solution.linear.method == "pivoted"
    assert error(solution) < 1e-8


def test_the_grid_carries_the_quadrature_only():
    problem = dirichlet(ANNULUS, on_the_annulus)
    found = [errors(problem, "legendre", (8,), grid)[0] for grid in (2, 5, 16)]
    assert np.allclose(found, found[0], rtol=1e-3), found


def test_trigonometric_functions_converge_geometrically():
    """Although the field is not periodic: the period is twice the box."""
    found = errors(dirichlet(ANNULUS, on_the_annulus), "trigonometric", (2, 4, 6, 8))
    assert (found[:-1] / found[1:] > 20).all(), found
    assert found[-1] < 1e-7


@pytest.mark.parametrize(("smoothness", "grids"), [(1, (4, 8, 12)), (2, (4, 8, 12))])
def test_radial_functions_converge_with_their_order(smoothness, grids):
    """At least that of their native space, k + (d + 1)/2."""
    problem = dirichlet(ANNULUS, on_the_annulus)
    found = [errors(problem, "radial", (smoothness,), grid)[0] for grid in grids]
    observed = np.log(found[0] / found[-1]) / np.log(grids[-1] / grids[0])
    assert observed > smoothness + 1.5, (observed, found)
    assert sorted(found, reverse=True) == found


AGREEMENT = {
    "web-spline": (6, 12, 1e-7),
    "b-spline": (3, 16, 1e-5),
    "chebyshev": (10, 6, 1e-9),
    "legendre": (10, 6, 1e-9),
    "trigonometric": (9, 6, 1e-6),
    "radial": (3, 8, 1e-5),
}
"""Degree, grid, and how far from the exact field at points."""


def test_all_bases_find_the_same_field():
    points = np.array([[0.5, 0.75], [0.15, 0.5], [0.7, 0.3], [0.62, 0.52]])
    exact = generic(*points.T)
    for name, (degree, grid, limit) in AGREEMENT.items():
        solution = ritz.solve(MIXED, Discretization(degree=degree, grid=grid, basis=name))
        assert np.abs(solution.u(points) - exact).max() < limit, name
        worst = boundary_errors(MIXED, solution.trial, solution.background)
        assert worst["inner"] < 1e-14, name
        assert worst["outer"] < 1e3 * limit, name


@pytest.mark.parametrize("name", AGREEMENT)
def test_pure_neumann_is_fixed_by_its_mean(name):
    problem = Problem(
        ANNULUS, Poisson(source=None), (Neumann(ANNULUS.part("all"), FROM_EXACT),), exact=generic
    )
    degree, grid, limit = AGREEMENT[name]
    solution = ritz.solve(problem, Discretization(degree=degree, grid=grid, basis=name))
    assert error(solution) < limit


def test_polynomials_in_space():
    sphere = ball(center=(0, 0, 0), radius=1).named("ball")

    def u(x, y, z):
        return (1 - x * x - y * y - z * z) * exp(x) * sin(y + 0.4) * cos(z)

    problem = Problem(sphere, Poisson(source=None), (Dirichlet(sphere.part("all"), 0.0),), exact=u)
    found = errors(problem, "legendre", (2, 4, 6), grid=3)
    assert (found[:-1] / found[1:] > 20).all(), found
    assert found[-1] < 1e-5


def test_least_squares_with_polynomials_loses_no_digits():
    """Their rows have the root of the condition number of an energy."""
    problem = dirichlet(ANNULUS, on_the_annulus)
    solution = solve_by(problem, Discretization(degree=14, grid=6, basis="legendre"), LeastSquares())
    assert solution.linear.method == "qr"
    assert error(solution) < 2e-12


def test_a_form_that_is_not_symmetric():
    problem = Problem(
        ANNULUS,
        Poisson(source=None, advection=(2.0, lambda x, y: x)),
        (Dirichlet(ANNULUS.part("all"), FROM_EXACT),),
        exact=generic,
    )
    solution = solve_by(problem, Discretization(degree=10, grid=6, basis="legendre"), Galerkin())
    assert error(solution) < 1e-9


def test_collars_need_splines():
    with pytest.raises(
        DiscretizationError, match=r"basis: legendre .*use basis: web-spline, or conditions: natural"
    ):
        ritz.solve(MIXED, Discretization(degree=6, grid=8, basis="legendre", conditions="exact"))
