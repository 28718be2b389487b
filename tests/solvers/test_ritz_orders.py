"""Orders of the Ritz method on closed-form solutions: p + 1 in L2, p in H1.

u = (product of the primitives' polynomials) * (a generic function), or explicit data plus such a product, so
that neither the extension of the data nor the weight hands the solver the answer.
"""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.geometry.primitives import ball, disk, rectangle
from solvers import ritz
from solvers.equations.poisson import Poisson
from solvers.norms import boundary_errors, error_norms
from solvers.problem import FROM_EXACT, Dirichlet, Discretization, Neumann, Problem, Robin

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


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_order_on_the_annulus(degree):
    problem = Problem(
        ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), 0.0),), exact=annulus_solution
    )
    grids = {1: (48, 96, 192), 2: (24, 48, 96), 3: (24, 48, 96), 4: (20, 40, 80), 5: (16, 32, 64)}[degree]
    observed = orders(errors_of(problem, degree, grids))
    print(degree, observed)
    assert abs(observed[-1, 0] - (degree + 1)) < 0.15
    assert abs(observed[-1, 1] - degree) < 0.15


def test_high_degree_needs_few_unknowns():
    problem = Problem(
        ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), 0.0),), exact=annulus_solution
    )
    solution = solve(problem, 6, 10)
    assert solution.dofs <= 250
    assert error_norms(solution.trial, annulus_solution, solution.background).l2 < 5e-9
