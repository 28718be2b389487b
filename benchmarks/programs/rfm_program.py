"""rfm: Ritz's method with WEB-splines on a uniform grid, called as by a user of the packages.

High degree on few cells is tried as well as low degree on many.  Boundary data are extended by a formula that is not
the solution: `data` of the problem, or what rfm builds from the values of the solution on the boundary.
"""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping
from functools import partial, reduce
from importlib.metadata import version
from types import SimpleNamespace
from typing import Any

import pyamg  # noqa: F401  rfm imports these on demand, and imports are not timed
import scipy.sparse.linalg  # noqa: F401
import threadpoolctl  # noqa: F401

import solvers.assembly
import solvers.corners.setting
import solvers.linear.bordered
import solvers.linear.condition
import solvers.pipeline
import solvers.quadrature.domain  # noqa: F401
import structures.dirichlet
import structures.fading
import structures.manufactured  # noqa: F401
from benchmarks.problems import POISSON, YOUNG, Ball, Block, Bore, Polygon, Problem, Solid
from benchmarks.record import Answer, Configuration, Laps
from rfm.calculus import functions
from rfm.geometry import Shape, ball, cylinder, disk, polygon, rectangle
from solvers import problem as posed
from solvers import ritz
from solvers.equations.elasticity import Elasticity
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms

MATHS = SimpleNamespace(
    sin=functions.sin, cos=functions.cos, exp=functions.exp, cosh=functions.cosh, arctan2=functions.atan2
)

SHAPES: Mapping[type, Callable[[Any], Shape]] = {
    Ball: lambda one: (disk if len(one.center) == 2 else ball)(center=one.center, radius=one.radius),
    Block: lambda one: rectangle(min=one.low, max=one.high),
    Bore: lambda one: cylinder(center=(0, 0, 0), axis=(0, 0, 1), radius=one.radius),
    Polygon: lambda one: polygon(one.vertices),
}

CELLS = {
    "poisson": {
        2: (3, 4, 5, 6, 7, 8, 10, 12, 16, 24, 32, 48, 64, 96, 128),
        3: (4, 5, 6, 7, 8, 9, 10, 12, 14, 16, 20, 24, 32),
    },
    "elasticity": {2: (3, 4, 5, 6, 7, 8, 10, 12, 16, 24, 32, 48, 64)},
    "plate": {2: (3, 4, 5, 6, 7, 8, 10, 12, 16, 24, 32, 48, 64)},
}  # fmt: skip
"""Cells along the longest side of the box, by equation and dimension."""

DEGREES = {2: (5, 6, 7, 8, 4, 3, 2), 3: (4, 5, 6, 3, 2)}
"""The order is that in which they are tried while the budget lasts."""


def series(problem: Problem) -> Mapping[str, list[Configuration]]:
    """Uniform refinement at every degree."""
    cells = CELLS[problem.equation][problem.dimension]
    lowest = 3 if problem.equation == "plate" else 2
    return {
        f"p={degree}": [{"degree": degree, "cells": n} for n in cells]
        for degree in DEGREES[problem.dimension]
        if degree >= lowest
    }


def shape(solid: Solid) -> Shape:
    """A solid as a shape."""
    return SHAPES[type(solid)](solid)


def _poisson(problem: Problem, domain: Shape, outer: Shape, holes: list[Shape]) -> posed.Problem:
    datum: Any = posed.FROM_EXACT if not problem.extended else 0.0
    if problem.data is not None and problem.extended:
        datum = partial(problem.data, MATHS)
    source = partial(problem.source, MATHS) if problem.source else 0.0
    condition = posed.Dirichlet(domain.part("all"), datum)
    return posed.Problem(domain, Poisson(source=source), (condition,), partial(problem.exact, MATHS))


def _elasticity(problem: Problem, domain: Shape, outer: Shape, holes: list[Shape]) -> posed.Problem:
    exact = tuple(lambda x, y, i=i: problem.exact(MATHS, x, y)[i] for i in range(2))
    conditions = (
        posed.Dirichlet(outer.part("left"), (0.0, None)),
        posed.Dirichlet(outer.part("bottom"), (None, 0.0)),
        posed.Traction(outer.part("right"), posed.FROM_EXACT),
        posed.Traction(outer.part("top"), posed.FROM_EXACT),
        *(posed.Traction(hole.part("all"), (0.0, 0.0)) for hole in holes),
    )
    equation = Elasticity(model="plane_stress", young_modulus=YOUNG, poisson_ratio=POISSON)
    return posed.Problem(domain, equation, conditions, exact)


def _plate(problem: Problem, domain: Shape, outer: Shape, holes: list[Shape]) -> posed.Problem:
    assert problem.source is not None
    equation = Plate(load=partial(problem.source, MATHS))
    clamped = (posed.Clamped(domain.part("all")),)
    return posed.Problem(domain, equation, clamped, partial(problem.exact, MATHS))


EQUATIONS = {"poisson": _poisson, "elasticity": _elasticity, "plate": _plate}


def pose(problem: Problem) -> posed.Problem:
    """The problem as rfm states it, shapes built anew: they are part of the time."""
    outer, holes = shape(problem.outer), [shape(hole) for hole in problem.holes]
    domain = reduce(lambda a, b: a - b, holes, outer)
    return EQUATIONS[problem.equation](problem, domain, outer, holes)


def solve(problem: Problem, configuration: Configuration, laps: Laps) -> Answer:
    """Build the shape and solve once."""
    stated = pose(problem)
    laps.lap("geometry")
    discretization = posed.Discretization(degree=configuration["degree"], grid=configuration["cells"])
    solution = ritz.solve(stated, discretization)
    laps.split(solution.seconds)
    assert stated.exact is not None
    exact = stated.exact
    return Answer(solution.dofs, lambda: error_norms(solution.trial, exact, solution.background).l2)


def versions() -> Mapping[str, str]:
    """Versions of what ran."""
    return {
        "python": platform.python_version(),
        **{name: version(name) for name in ("rfm", "numpy", "scipy")},
    }
