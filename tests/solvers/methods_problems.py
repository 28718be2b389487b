"""Closed-form problems that the tests of the methods share."""

from __future__ import annotations

import numpy as np

from rfm.calculus.functions import cos, exp, sin
from rfm.geometry import ball, disk
from solvers import pipeline
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms
from solvers.problem import FROM_EXACT, Dirichlet, Discretization, Neumann, Problem, Robin

OUTER = disk(center=(0.5, 0.5), radius=0.4).named("outer")
INNER = disk(center=(0.5, 0.5), radius=0.1).named("inner")
ANNULUS = OUTER - INNER
BALL = ball(center=(0, 0, 0), radius=1).named("ball")


def vanishing(x, y):
    """Zero on both circles; not a multiple of the weight by a polynomial."""
    s = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return (0.16 - s) * (s - 0.01) * exp(x) * sin(3 * y)


def smooth(x, y):
    """Zero nowhere in particular."""
    return exp(x) * sin(3 * y)


def vanishing_3d(x, y, z):
    """Zero on the unit sphere."""
    return (1 - x * x - y * y - z * z) * exp(x) * sin(y + 0.4) * cos(z)


def dirichlet(exact=vanishing, value=0.0, **data):
    return Problem(
        ANNULUS, Poisson(source=None, **data), (Dirichlet(ANNULUS.part("all"), value),), exact=exact
    )


def mixed(**data):
    """Dirichlet inside, flux on the left half and Robin on the right half outside."""
    outer = ANNULUS.part("outer")
    conditions = (
        Dirichlet(ANNULUS.part("inner"), FROM_EXACT),
        Neumann(outer.restricted(lambda x, y: 0.5 - x, "left"), FROM_EXACT),
        Robin(outer.restricted(lambda x, y: x - 0.5, "right"), 2.0, FROM_EXACT),
    )
    return Problem(ANNULUS, Poisson(source=None, **data), conditions, exact=smooth)


def on_the_ball(**data):
    return Problem(
        BALL, Poisson(source=None, **data), (Dirichlet(BALL.part("all"), 0.0),), exact=vanishing_3d
    )


def l2_error(problem, method, degree, grid, options=None, **more):
    solution = pipeline.solve(problem, Discretization(degree=degree, grid=grid, **more), method, options)
    return error_norms(solution.trial, problem.exact, solution.background).l2


def observed_orders(problem, method, degree, grids, **more):
    errors = [l2_error(problem, method, degree, grid, **more) for grid in grids]
    return -np.diff(np.log(errors)) / np.diff(np.log(grids)), errors
