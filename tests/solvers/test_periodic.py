"""Periodic conditions: the splines, the structures across the seam, orders, and what is refused."""

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.errors import DiscretizationError, StructureError
from rfm.geometry import box, disk, rectangle
from rfm.geometry.box import Box
from solvers import pipeline
from solvers.bases.spline import Spline
from solvers.classify import classify
from solvers.equations.elasticity import Elasticity
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.grid import Grid
from solvers.methods import METHODS
from solvers.norms import boundary_errors, error_norms
from solvers.problem import (
    FROM_EXACT,
    Clamped,
    Dirichlet,
    Discretization,
    Neumann,
    Periodic,
    Problem,
    Slip,
)
from solvers.solution import Trial
from solvers.web import SplineSpace
from structures.operator import unknown

CHANNEL = rectangle(min=(0, 0), max=(1, 0.6)).named("channel")
HOLE = disk(center=(0.45, 0.3), radius=0.13).named("hole")
LEFT, RIGHT = CHANNEL.part("channel.left"), CHANNEL.part("channel.right")


def wavy(x, y):
    return sin(2 * np.pi * x) + y * (0.6 - y) * exp(0.4 * sin(2 * np.pi * x) + y)


def turning(x, y):
    return sin(np.pi * x) + y * (0.6 - y) * cos(np.pi * x) * exp(y + cos(2 * np.pi * x))


def problem(domain, exact, factor=1.0, on_hole=Neumann, data=FROM_EXACT, **equation):
    walls = domain.part("channel.bottom") | domain.part("channel.top")
    conditions = [
        Periodic(domain.part("channel.left"), domain.part("channel.right"), factor),
        Dirichlet(walls, data),
        on_hole(domain.part("hole"), FROM_EXACT),
    ]
    return Problem(domain, Poisson(source=None, **equation), tuple(conditions), exact=exact)


def solved(given, degree, grid, method="ritz", **more):
    solution = pipeline.solve(given, Discretization(degree=degree, grid=grid, **more), METHODS[method])
    return solution, error_norms(solution.trial, given.exact, solution.background).l2


def seam_gap(trial, factor, lower=0.0, upper=1.0, order=1):
    y = np.random.default_rng(1).uniform(0.01, 0.59, 200)
    here, there = (trial.at(np.stack([np.full_like(y, x), y], axis=1), order) for x in (lower, upper))
    return np.abs(there - factor * here).max() / np.abs(here).max()


# Splines ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("basis", ["web-spline", "b-spline"])
@pytest.mark.parametrize(("degree", "factor"), [(1, 1.0), (3, -1.0), (4, 1.0)])
def test_random_splines_are_periodic_with_their_derivatives(basis, degree, factor):
    # the hole crosses the seam, so splines are extended across it
    domain = CHANNEL - disk(center=(1, 0.3), radius=0.17) - disk(center=(0, 0.3), radius=0.17)
    grid = Grid.cover(domain.box, 15)
    space = SplineSpace.build(grid, degree, classify(domain, grid), basis, wraps={0: factor})
    psi = space.function(np.random.default_rng(0).normal(size=space.n_dofs))
    n = grid.cells[0]
    assert np.array_equal(psi.coefficients[n:], factor * psi.coefficients[:degree])
    wide = Spline(Grid(grid.lower, grid.spacing, grid.cells), degree, psi.coefficients)
    assert seam_gap(Trial((unknown(2),), (wide,)), factor, order=degree - 1) < 1e-12


def test_periodic_web_splines_hold_what_does_not_depend_on_the_period():
    domain = CHANNEL - HOLE
    grid = Grid.cover(domain.box, 12)
    space = SplineSpace.build(grid, 3, classify(domain, grid), wraps={0: 1.0})
    plain = SplineSpace.build(grid, 3, classify(domain, grid))
    assert space.n_dofs < plain.n_dofs
    full = space.full_coefficients(space.affine(0.3, np.array([0.0, 2.0])))
    expected = plain.full_coefficients(plain.affine(0.3, np.array([0.0, 2.0])))
    assert np.abs(full - expected)[full != 0].max() < 1e-12


def test_periods_need_more_cells_than_the_degree():
    grid = Grid.cover(CHANNEL.box, 3)
    with pytest.raises(DiscretizationError, match="degree 3 need 4 cells or more in a period, got 3 along x"):
        SplineSpace.build(grid, 3, classify(CHANNEL, grid), wraps={0: 1.0})


# Orders -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "degree", "grids", "band"),
    [
        ("ritz", 2, (24, 48), 0.15),
        ("ritz", 3, (24, 48), 0.15),
        ("ritz", 4, (32, 64), 0.15),
        ("galerkin", 3, (24, 48), 0.15),
        ("least-squares", 3, (32, 64), 0.25),
    ],
)
def test_order_with_a_flux_on_the_hole(method, degree, grids, band):
    given = problem(CHANNEL - HOLE, wavy, data=lambda x, y: sin(2 * np.pi * x))
    errors = [solved(given, degree, grid, method)[1] for grid in grids]
    assert abs(np.log2(errors[0] / errors[1]) - (degree + 1)) < band


@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_weight_of_a_hole_goes_over_into_its_image(factor):
    exact = wavy if factor > 0 else turning
    given = problem(CHANNEL - HOLE, exact, factor, on_hole=Dirichlet)
    errors = []
    for grid in (20, 40):
        solution, error = solved(given, 3, grid)
        errors.append(error)
        assert seam_gap(solution.trial, factor) < 1e-12
        assert max(boundary_errors(given, solution.trial, solution.background).values()) < 1e-12
    assert np.log2(errors[0] / errors[1]) > 4 - 0.15


def test_hole_beside_the_seam_leaves_room_on_its_other_side():
    hole = disk(center=(0.9, 0.3), radius=0.08).named("hole")
    given = problem(CHANNEL - hole, wavy, on_hole=Dirichlet)
    solution, error = solved(given, 3, 32)
    assert error < 1e-5
    assert seam_gap(solution.trial, 1.0) < 1e-12


def test_only_fluxes_and_a_period_leave_the_mean_free():
    domain = CHANNEL - HOLE
    walls = domain.part("channel.bottom") | domain.part("channel.top") | domain.part("hole")
    pair = Periodic(domain.part("channel.left"), domain.part("channel.right"))
    given = Problem(domain, Poisson(source=None), (pair, Neumann(walls, FROM_EXACT)), exact=wavy)
    assert solved(given, 3, 24)[1] < 1e-4


def test_periodic_in_space():
    cube = box(min=(0, 0, 0), max=(0.8, 0.8, 1)).named("duct")

    def exact(x, y, z):
        return x + x * (0.8 - x) * y * (0.8 - y) * (cos(2 * np.pi * z) + exp(y))

    walls = cube.part("all") - cube.part("duct.bottom") - cube.part("duct.top")
    pair = Periodic(cube.part("duct.bottom"), cube.part("duct.top"))
    given = Problem(cube, Poisson(source=None), (pair, Dirichlet(walls, lambda x, y, z: x)), exact=exact)
    errors = [solved(given, 2, grid)[1] for grid in (10, 20)]
    assert abs(np.log2(errors[0] / errors[1]) - 3) < 0.15


def test_elastic_and_bent_problems_are_periodic_too():
    def displacement(x, y):
        return y * (0.6 - y) * exp(sin(2 * np.pi * x))

    walls = CHANNEL.part("channel.bottom") | CHANNEL.part("channel.top")
    pair = Periodic(LEFT, RIGHT)
    body = Problem(
        CHANNEL,
        Elasticity("plane_strain", 1.0, 0.3, None),
        (pair, Dirichlet(walls)),
        exact=(displacement, lambda x, y: 0.5 * displacement(x, y)),
    )
    plate = Problem(
        CHANNEL,
        Plate(load=None),
        (pair, Clamped(walls)),
        exact=lambda x, y: displacement(x, y) ** 2,
    )
    assert solved(body, 3, 20)[1] < 1e-4
    assert solved(plate, 4, 20)[1] < 1e-4


# Refusals -----------------------------------------------------------------------------------------


def refused(domain, first, second, *more, factor=1.0, shift=None, error=StructureError, **how):
    pair = Periodic(domain.part(first), domain.part(second), factor, shift)
    rest = domain.part("all") - domain.part(first) - domain.part(second)
    given = Problem(domain, Poisson(1.0), (pair, *(more or (Dirichlet(rest),))))
    with pytest.raises(error) as caught:
        pipeline.solve(given, Discretization(degree=2, grid=10, **how), METHODS["ritz"])
    return str(caught.value)


def test_refusals_of_parts():
    assert "channel.left and channel.top do not face each other" in refused(
        CHANNEL, "channel.left", "channel.top"
    )
    turned = CHANNEL.rotate(0.3)
    assert "channel.left is not; turn the domain" in refused(turned, "channel.left", "channel.right")
    assert "shift must be (1, 0), the way from channel.left to channel.right, got (0.9, 0)" in refused(
        CHANNEL, "channel.left", "channel.right", shift=(0.9, 0.0)
    )
    assert "factor must be 1 or -1, got 2" in refused(CHANNEL, "channel.left", "channel.right", factor=2.0)
    bitten = CHANNEL - disk(center=(1, 0.3), radius=0.1).named("bite")
    assert "(1, 0.383808) not on channel.right" in refused(bitten, "channel.left", "channel.right")
    longer = CHANNEL | rectangle(min=(0.5, 0.6), max=(1.5, 1)).named("more")
    assert "the domain reaches beyond channel.left and channel.right" in refused(
        longer, "channel.left", "channel.right"
    )
    piece = LEFT.restricted(lambda x, y: y - 0.1, "piece")
    given = Problem(CHANNEL, Poisson(1.0), (Periodic(piece, RIGHT), Dirichlet(CHANNEL.part("channel.top"))))
    with pytest.raises(StructureError, match="holds on whole parts: piece is a piece of one"):
        pipeline.solve(given, Discretization(degree=2, grid=10), METHODS["ritz"])


def test_refusals_of_conditions_and_discretisations():
    pair = ("channel.left", "channel.right")
    walls = CHANNEL.part("channel.bottom") | CHANNEL.part("channel.top")
    assert "the essential conditions are not periodic along x: what holds at" in refused(
        CHANNEL, *pair, Dirichlet(walls, lambda x, y: x)
    )
    message = refused(CHANNEL, *pair, error=DiscretizationError, basis="chebyshev")
    assert "periodic splines, which basis: chebyshev does not have: use basis: web-spline" in message
    message = refused(CHANNEL, *pair, Neumann(walls), error=DiscretizationError, conditions="exact")
    assert "use conditions: natural" in message
    message = refused(CHANNEL, *pair, error=DiscretizationError, spacing=0.3)
    assert "spacing must divide the period 1 along x, got 0.3; use 0.3333333333 or `grid`" in message
    message = refused(CHANNEL, *pair, error=DiscretizationError, box=Box((-0.1, 0), (1.1, 0.6)))
    assert "box must end at the periodic parts, x = 0 and 1, got -0.1 and 1.1; leave it out" in message
    given = Problem(CHANNEL, Elasticity(), (Periodic(LEFT, RIGHT), Slip(walls)))
    with pytest.raises(StructureError, match="a slip condition has no periodic structure"):
        pipeline.solve(given, Discretization(degree=2, grid=10), METHODS["ritz"])
