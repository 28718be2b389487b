"""Exact mode: every condition holds to rounding, at the order and nearly the error of the natural mode."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.errors import DiscretizationError
from rfm.geometry import ball, box, disk, half_space, rectangle
from solvers import ritz
from solvers.background import prepare
from solvers.collar import collar_space
from solvers.corner_rules import corner_rule, graded
from solvers.equations.elasticity import Elasticity
from solvers.equations.energy import Energy
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.flux_collars import LENGTHS, ROOM, collars_of
from solvers.grid import Grid
from solvers.modes import mode_of
from solvers.norms import boundary_errors, error_norms
from solvers.problem import (
    FROM_EXACT,
    Dirichlet,
    Discretization,
    Free,
    Neumann,
    Pressure,
    Problem,
    Robin,
    Traction,
)
from solvers.stopwatch import Stopwatch

ANNULUS = disk(center=(0.5, 0.5), radius=0.4).named("outer") - disk(center=(0.5, 0.5), radius=0.1).named(
    "inner"
)
PLATE = rectangle(min=(0, 0), max=(1.2, 1)).named("r")

MIXED = Problem(
    ANNULUS,
    Poisson(source=None),
    (
        Dirichlet(ANNULUS.part("inner"), lambda x, y: 1 + 0.5 * x - y),
        Neumann(ANNULUS.part("outer"), FROM_EXACT),
    ),
    exact=lambda x, y: 1 + 0.5 * x - y + 4 * ((x - 0.5) ** 2 + (y - 0.5) ** 2 - 0.01) * exp(x) * sin(3 * y),
)
FOUR = Problem(
    PLATE,
    Poisson(source=None, conductivity=lambda x, y: 1 + 0.3 * x * y),
    (
        Dirichlet(PLATE.part("r.left"), lambda x, y: cos(2 * y + 0.4)),
        Neumann(PLATE.part("r.bottom"), FROM_EXACT),
        Robin(PLATE.part("r.right"), lambda x, y: 2 + y, FROM_EXACT),
        Neumann(PLATE.part("r.top"), FROM_EXACT),
    ),
    exact=lambda x, y: exp(0.5 * x) * cos(2 * y + 0.4) + x * y * y,
)


def shell(radius):
    """Value inside at the given radius, exchange outside at radius 1."""
    body = ball(center=(0, 0, 0), radius=1.0).named("outer") - ball(center=(0, 0, 0), radius=radius).named(
        "inner"
    )

    def exact(x, y, z):
        return 1 + x * z + (x * x + y * y + z * z - radius**2) * exp(0.5 * x) * sin(y + 0.4) * cos(z)

    held = Dirichlet(body.part("inner"), lambda x, y, z: 1 + x * z)
    return Problem(body, Poisson(source=None), (held, Robin(body.part("outer"), 2.0, FROM_EXACT)), exact)


THREE_D = shell(0.4)


BLOCK = box(min=(0, 0, 0), max=(1.2, 1, 0.8)).named("b")
EDGES = Problem(
    BLOCK,
    Poisson(source=None, conductivity=lambda x, y, z: 1 + 0.3 * x * y),
    (
        Dirichlet(BLOCK.part("b.bottom"), lambda x, y, z: exp(0.5 * x) * cos(2 * y + 0.4)),
        Neumann(BLOCK.part("b.left") | BLOCK.part("b.front") | BLOCK.part("b.right"), FROM_EXACT),
        Robin(BLOCK.part("b.back") | BLOCK.part("b.top"), 2.0, FROM_EXACT),
    ),
    exact=lambda x, y, z: exp(0.5 * x) * cos(2 * y + 0.4) * (1 + 0.5 * z * z) + x * y * z,
)

DOME = ball(center=(0, 0, 0), radius=1.0).named("ball") & half_space(point=(0, 0, 0), normal=(0, 0, 1)).named(
    "flat"
)
ROUND = Problem(
    DOME,
    Poisson(source=None),
    (
        Dirichlet(DOME.part("flat"), lambda x, y, z: exp(0.5 * x) * cos(2 * y + 0.4)),
        Neumann(DOME.part("ball"), FROM_EXACT),
    ),
    exact=EDGES.exact,
)


def solve(problem, degree, grid, conditions="exact", **more):
    return ritz.solve(problem, Discretization(degree=degree, grid=grid, conditions=conditions, **more))


def error(solution):
    return error_norms(solution.trial, solution.problem.exact, solution.background).l2


def residual(solution):
    return max(boundary_errors(solution.problem, solution.trial, solution.background).values())


@pytest.mark.parametrize(
    ("problem", "degree", "grids"),
    [
        (MIXED, 2, (32, 48)),
        (MIXED, 3, (24, 36)),
        (MIXED, 4, (24, 36)),
        (FOUR, 2, (24, 36)),
        (FOUR, 3, (24, 36)),
    ],
)
def test_as_accurate_as_the_natural_mode(problem, degree, grids):
    solutions = [solve(problem, degree, grid) for grid in grids]
    assert max(residual(s) for s in solutions) < 1e-12
    errors = [error(s) for s in solutions]
    for grid, e in zip(grids, errors, strict=True):
        assert e < 2 * error(solve(problem, degree, grid, "natural"))
    order = np.log(errors[0] / errors[1]) / np.log(grids[1] / grids[0])
    assert order > degree + 1 - 0.3


def test_degree_five():
    solution = solve(MIXED, 5, 24)
    assert error(solution) < 2 * error(solve(MIXED, 5, 24, "natural"))
    assert residual(solution) < 1e-12


def test_shell():
    solution = solve(THREE_D, 2, 6)
    assert residual(solution) < 1e-11
    assert error(solution) < 2 * error(solve(THREE_D, 2, 6, "natural"))


@pytest.mark.slow
@pytest.mark.parametrize(("degree", "grids"), [(2, (16, 24)), (3, (12, 16))])
def test_order_on_the_shell(degree, grids):
    """The collar has its full width from N = 15 on."""
    problem = shell(0.25)
    solutions = [solve(problem, degree, grid) for grid in grids]
    assert max(residual(s) for s in solutions) < 1e-11
    errors = [error(s) for s in solutions]
    for grid, e in zip(grids, errors, strict=True):
        assert e < 2 * error(solve(problem, degree, grid, "natural"))
    assert np.log(errors[0] / errors[1]) / np.log(grids[1] / grids[0]) > degree + 1 - 0.3


@pytest.mark.parametrize(
    ("problem", "grid"), [(ROUND, 6), pytest.param(EDGES, 8, marks=pytest.mark.slow)], ids=["dome", "box"]
)
def test_edges_where_conditions_meet(problem, grid):
    solution = solve(problem, 2, grid)
    assert residual(solution) < 1e-11
    assert error(solution) < 2 * error(solve(problem, 2, grid, "natural"))


def test_pieces_of_one_circle():
    """Exchange on the right half, flux on the left: the windows meet in the middle of a smooth arc."""
    problem = Problem(
        ANNULUS,
        Poisson(source=None),
        (
            Dirichlet(ANNULUS.part("inner"), FROM_EXACT),
            Robin(ANNULUS.part("outer").restricted(lambda x, y: x - 0.5), 2.0, FROM_EXACT),
            Neumann(ANNULUS.part("outer").restricted(lambda x, y: 0.5 - x), FROM_EXACT),
        ),
        exact=MIXED.exact,
    )
    solution = solve(problem, 3, 24)
    assert residual(solution) < 1e-10
    assert error(solution) < 2 * error(solve(problem, 3, 24, "natural"))


def test_given_flux_and_pure_neumann():
    problem = Problem(
        ANNULUS,
        Poisson(source=None),
        (Neumann(ANNULUS.part("all"), FROM_EXACT),),
        exact=MIXED.exact,
    )
    solution = solve(problem, 3, 24)
    assert residual(solution) < 1e-11
    assert error(solution) < 2 * error(solve(problem, 3, 24, "natural"))
    given = Problem(
        PLATE,
        Poisson(source=-2.0),
        (
            Dirichlet(PLATE.part("r.left"), 0.0),
            Neumann(PLATE.part("r.right"), lambda x, y: 2.4 + 0 * y),
            Neumann(PLATE.part("r.bottom") | PLATE.part("r.top"), 0.0),
        ),
        exact=lambda x, y: x * x,
    )
    solution = solve(given, 2, 8)
    assert residual(solution) < 1e-12
    assert error(solution) < 5e-6  # w chi psi_m is no polynomial


@pytest.mark.parametrize("load", ["traction", "pressure"])
def test_elasticity(load):
    displacement = (
        lambda x, y: sin(1.3 * x + 0.4 * y) + 0.2 * x * y,
        lambda x, y: cos(0.7 * x - 1.1 * y) * exp(0.3 * y),
    )
    held = Dirichlet(ANNULUS.part("inner"), FROM_EXACT)
    if load == "traction":
        problem = Problem(
            ANNULUS,
            Elasticity("plane_strain", 2.0, 0.3, None),
            (held, Traction(ANNULUS.part("outer"), FROM_EXACT)),
            exact=displacement,
        )
        solution = solve(problem, 3, 12)
        assert error(solution) < 2 * error(solve(problem, 3, 12, "natural"))
    else:
        problem = Problem(
            ANNULUS,
            Elasticity("plane_stress", 2.0, 0.3),
            (Dirichlet(ANNULUS.part("inner"), 0.0), Pressure(ANNULUS.part("outer"), lambda x, y: 1 + x)),
        )
        solution = solve(problem, 3, 12)
    assert residual(solution) < 1e-11


def test_condition_number_is_reported():
    solution = solve(MIXED, 3, 16)
    assert 1e2 < solution.linear.condition < 1e8
    assert solve(MIXED, 3, 16, "natural").linear.condition is None
    assert solution.dofs > solution.background.space.n_dofs


def test_only_essential_conditions_change_nothing():
    problem = Problem(
        ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), FROM_EXACT),), MIXED.exact
    )
    exact, natural = (solve(problem, 3, 12, mode) for mode in ("exact", "natural"))
    assert np.array_equal(exact.linear.x, natural.linear.x)


def test_collars_fit_between_the_parts():
    (wide,), (narrow,) = collars_of(MIXED, 0.02), collars_of(MIXED, 0.2)
    assert wide.length == pytest.approx(LENGTHS[1] * 0.02)
    assert wide.others == ()
    assert narrow.length == pytest.approx(0.1875 / ROOM)  # w = 0.1875 on the inner circle
    assert len(narrow.others) == 1
    bottom = collars_of(FOUR, 0.02)[0]
    assert bottom.length == pytest.approx(LENGTHS[1] * 0.02)
    assert len(bottom.meeting) == 2


def test_collar_space_is_a_strip_of_the_space():
    background = prepare(ANNULUS, Discretization(degree=3, grid=32), Stopwatch())
    (collar,) = collars_of(MIXED, 0.025)
    space = collar_space(background, "web-spline", 2, collar.site.w, 0.05)
    assert 0 < space.n_dofs < background.space.n_dofs / 2
    assert not len(space.free.exposed)


def test_corner_rule_integrates_what_has_no_limit():
    """x^2 / (x^2 + y^2) over the unit square is 1/2 by symmetry."""
    square = rectangle(min=(0, 0), max=(1, 1)).named("s")
    grid = Grid(np.zeros(2), np.ones(2), np.ones(2, dtype=int))
    pair = (lambda x, y: x, lambda x, y: y)
    rule = corner_rule(square, grid, np.zeros((1, 2), dtype=int), [pair], 12).padded()
    x, y = rule.points(grid)
    counted = rule.weights > 0
    value = (rule.weights[counted] * x[counted] ** 2 / (x[counted] ** 2 + y[counted] ** 2)).sum()
    assert value == pytest.approx(0.5, abs=1e-10)
    assert rule.weights.sum() == pytest.approx(1.0, abs=1e-13)


def test_rule_along_edges():
    """x^2 / (x^2 + y^2) over the unit cube; few boxes along an edge of the grid, more along one across it."""
    cube = box(min=(0, 0, 0), max=(1, 1, 1)).named("c")
    grid = Grid(np.zeros(3), np.full(3, 0.5), np.full(3, 2))
    cells = np.argwhere(np.ones(grid.shape, dtype=bool))
    straight = [(lambda x, y, z: x, lambda x, y, z: y)]
    rule = corner_rule(cube, grid, cells, straight, 9).padded()
    x, y, _ = rule.points(grid)
    counted = rule.weights > 0
    value = (rule.weights[counted] * x[counted] ** 2 / (x[counted] ** 2 + y[counted] ** 2)).sum()
    assert value == pytest.approx(0.5, abs=1e-7)
    assert rule.weights.sum() == pytest.approx(1.0, abs=1e-13)
    boxes = graded(grid, cells, straight, 5)
    assert len(boxes.row) == 2 * (3 * 5 + 1) + 6
    assert np.prod(boxes.width, axis=1).sum() == pytest.approx(8)
    oblique = [(lambda x, y, z: x + y - 1, lambda x, y, z: z)]
    assert len(boxes.row) < len(graded(grid, cells, oblique, 5).row) < 4000


def test_refusals_name_the_remedy():
    with pytest.raises(DiscretizationError, match="degree 2 or more"):
        solve(MIXED, 1, 16)
    with pytest.raises(DiscretizationError, match="natural, exact"):
        mode_of(Discretization(conditions="strong"))
    plate = Problem(PLATE, Plate(), (Free(PLATE.part("all")),))
    with pytest.raises(DiscretizationError, match=r"order 5 of the spline: use degree 5 or more .* got 4"):
        solve(plate, 4, 8)
    user = Problem(PLATE, Energy(lambda x, y, u: 0.5 * (u.x**2 + u.y**2)), (Neumann(PLATE.part("all")),))
    with pytest.raises(
        DiscretizationError, match=r"no structure for Neumann with the equation energy .all.: .* natural"
    ):
        solve(user, 3, 8)
