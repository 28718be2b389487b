"""Exact mode for edges of plates, slip and rollers: residuals to rounding, errors like those of the natural mode."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.geometry import ball, disk, rectangle
from solvers import pipeline, ritz
from solvers.equations.elasticity import Elasticity
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.equations.rows import apply
from solvers.essential import essential_structure
from solvers.flux_collars import collared, collars_of
from solvers.flux_conditions import derivatives
from solvers.methods import METHODS
from solvers.norms import boundary_errors, error_norms
from solvers.problem import (
    FROM_EXACT,
    Clamped,
    Dirichlet,
    Discretization,
    Free,
    Oblique,
    Problem,
    Robin,
    SimplySupported,
    Slip,
    Traction,
)
from structures.catalogue.entry import jets_of, random_fields, random_points
from structures.catalogue.traces import boundary_frame

DISK = disk(center=(0.5, 0.5), radius=0.4).named("d")
RING = disk(center=(0, 0), radius=1).named("outer") - disk(center=(0, 0), radius=0.4).named("inner")
BOX = rectangle(min=(0, 0), max=(1.2, 1)).named("r")
SHELL = ball(center=(0, 0, 0), radius=1.0).named("outer") - ball(center=(0, 0, 0), radius=0.4).named("inner")
QUARTER = rectangle(min=(0, 0), max=(2, 2)).named("q") - disk(center=(0, 0), radius=0.5).named("hole")


def wave(x, y):
    return exp(0.7 * x) * sin(2 * y + 0.3 * x + 0.4) + 0.3 * x * y * y


def other(x, y):
    return exp(-0.4 * x) * cos(1.5 * y - 0.6 * x + 0.4)


def sliding(x, y):
    return (1 - x * x - y * y) * wave(x, y) - y * (0.5 + other(x, y))


def sliding_too(x, y):
    return (1 - x * x - y * y) * other(x, y) + x * (0.5 + other(x, y))


PLANE_STRESS = Elasticity("plane_stress", 1.0, 0.3, None)
SUPPORTED = Problem(
    DISK, Plate(load=None), (SimplySupported(DISK.part("all"), FROM_EXACT, FROM_EXACT),), wave
)
SUPPORTED_BOX = Problem(
    BOX, Plate(load=None), (SimplySupported(BOX.part("all"), FROM_EXACT, FROM_EXACT),), wave
)
FREE = Problem(
    RING,
    Plate(load=None),
    (
        Clamped(RING.part("inner"), FROM_EXACT, FROM_EXACT),
        Free(RING.part("outer"), FROM_EXACT, FROM_EXACT),
    ),
    wave,
)
SLIP = Problem(
    RING,
    PLANE_STRESS,
    (Dirichlet(RING.part("inner"), FROM_EXACT), Slip(RING.part("outer"), FROM_EXACT)),
    (sliding, sliding_too),
)
SYMMETRIC = (
    lambda x, y: sin(1.4 * x) * exp(0.3 * y * y),
    lambda x, y: sin(1.2 * y) * cos(1.3 * x) * exp(0.2 * x * x),
)
ROLLERS = Problem(
    QUARTER,
    PLANE_STRESS,
    (
        Dirichlet(QUARTER.part("q.left"), (0.0, None)),
        Dirichlet(QUARTER.part("q.bottom"), (None, 0.0)),
        Traction(QUARTER.part("q.right") | QUARTER.part("q.top"), FROM_EXACT),
        Traction(QUARTER.part("hole"), FROM_EXACT),
    ),
    SYMMETRIC,
)


def solve(problem, degree, grid, conditions="exact"):
    return ritz.solve(problem, Discretization(degree=degree, grid=grid, conditions=conditions))


def error(solution):
    return error_norms(solution.trial, solution.problem.exact, solution.background).l2


def residual(solution):
    return max(boundary_errors(solution.problem, solution.trial, solution.background).values())


@pytest.mark.parametrize(
    ("problem", "degree", "grids"),
    [
        (SUPPORTED, 3, (12, 18)),
        (SUPPORTED, 4, (16,)),
        (SUPPORTED_BOX, 3, (8,)),
        (SLIP, 2, (12, 18)),
        (ROLLERS, 3, (12,)),
        pytest.param(SUPPORTED, 4, (16, 24), marks=pytest.mark.slow),
        pytest.param(SUPPORTED, 5, (16, 24), marks=pytest.mark.slow),
        pytest.param(SUPPORTED_BOX, 3, (8, 16), marks=pytest.mark.slow),
        pytest.param(SLIP, 3, (12, 24), marks=pytest.mark.slow),
        pytest.param(ROLLERS, 4, (12, 18), marks=pytest.mark.slow),
    ],
)
def test_as_accurate_as_the_natural_mode(problem, degree, grids):
    solutions = [solve(problem, degree, grid) for grid in grids]
    assert max(residual(s) for s in solutions) < 1e-10
    errors = [error(s) for s in solutions]
    for grid, e in zip(grids, errors, strict=True):
        assert e < 2 * error(solve(problem, degree, grid, "natural"))
    if len(grids) > 1:
        order = np.log(errors[0] / errors[1]) / np.log(grids[1] / grids[0])
        assert order > degree + 1 - 0.3


@pytest.mark.parametrize(
    ("degree", "grid", "ratio"),
    [
        (5, 12, 2.0),
        pytest.param(5, 24, 2.0, marks=pytest.mark.slow),
        pytest.param(6, 24, 1.0, marks=pytest.mark.slow),
    ],
)
def test_free_edge(degree, grid, ratio):
    solution = solve(FREE, degree, grid)
    assert residual(solution) < 1e-10
    assert error(solution) < ratio * error(solve(FREE, degree, grid, "natural"))


def test_varying_stiffness_of_a_free_edge():
    """The structure's shear force has the gradient of the stiffness in it, as the equation's has."""
    plate = Plate(stiffness=lambda x, y: 1 + 0.4 * x - 0.2 * y * x, load=None)
    problem = Problem(RING, plate, FREE.conditions, wave)
    assert residual(solve(problem, 5, 8)) < 1e-10


def in_space(kind):
    """A shell with a condition on the outer sphere, data of a generic field."""
    outer = SHELL.part("outer")
    field = (
        lambda x, y, z: exp(x) * sin(y - z),
        lambda x, y, z: cos(x + y * z),
        lambda x, y, z: x * y + sin(z),
    )
    body, poisson = Elasticity("three_dimensional", 1.0, 0.3, None), Poisson(source=None)
    held = Dirichlet(SHELL.part("inner"), FROM_EXACT)
    if kind == "oblique":
        along = (1.0, lambda x, y, z: 2 * y + z, lambda x, y, z: 3 * z)
        condition = Oblique(outer.restricted(lambda x, y, z: x), along, 0.5, FROM_EXACT)
        rest = Robin(outer.restricted(lambda x, y, z: -x), 2.0, FROM_EXACT)
        return Problem(SHELL, poisson, (held, condition, rest), field[0])
    conditions = {
        "slip": Slip(outer, FROM_EXACT),
        "traction": Traction(outer, FROM_EXACT),
        "roller": Dirichlet(outer, (None, FROM_EXACT, None)),
    }
    return Problem(SHELL, body, (held, conditions[kind]), field)


@pytest.mark.parametrize(
    "problem",
    [
        SUPPORTED,
        SUPPORTED_BOX,
        FREE,
        SLIP,
        ROLLERS,
        *map(in_space, ("oblique", "slip", "traction", "roller")),
    ],
    ids=[
        "supported",
        "supported box",
        "free",
        "slip",
        "rollers",
        "oblique 3D",
        "slip 3D",
        "traction 3D",
        "roller 3D",
    ],
)
def test_every_condition_holds_for_random_psi(problem):
    """At 1000 random points of every part, measured by the rows of the equation."""
    rng = np.random.default_rng(1)
    structure = collared(essential_structure(problem, "auto"), collars_of(problem, 0.1))
    psi, equation = random_fields(structure, rng), problem.equation
    for condition in problem.conditions:
        points = random_points(problem.domain, condition.part, rng, 1000)
        normals = boundary_frame(problem.domain, condition.part, points)[0].T
        jets = jets_of(structure, psi, points, equation.flux_order)
        rows = equation.condition_rows(condition, tuple(points), normals, problem.exact)
        scale = np.maximum(1.0, np.abs(jets).max(axis=(0, 1)))
        for row, right in rows:
            assert np.abs((apply(row, np.concatenate(jets)) - right) / scale).max() < 1e-10


def test_derivatives_that_a_structure_takes():
    assert [derivatives(p) for p in (SUPPORTED, FREE, SLIP, ROLLERS)] == [1, 3, 1, 1]
    held = Problem(RING, PLANE_STRESS, (Dirichlet(RING.part("all"), 0.0),))
    assert derivatives(held) == 0


@pytest.mark.parametrize("method", ["least-squares", "collocation"])
def test_rollers_are_free_of_traction_by_strong_residuals_too(method):
    box = Problem(
        BOX,
        PLANE_STRESS,
        (
            Dirichlet(BOX.part("r.left"), (0.0, None)),
            Dirichlet(BOX.part("r.bottom"), (None, 0.0)),
            Traction(BOX.part("r.right") | BOX.part("r.top"), FROM_EXACT),
        ),
        SYMMETRIC,
    )
    solution = pipeline.solve(box, Discretization(degree=3, grid=12), METHODS[method])
    assert error(solution) < 1e-5
