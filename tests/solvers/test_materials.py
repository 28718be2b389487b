"""Inclusions: value jumps for random psi, orders across interfaces, all methods, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, log, sin
from rfm.errors import DiscretizationError, StructureError
from rfm.geometry import ball, box, disk, half_plane, rectangle
from solvers import pipeline
from solvers.equations.elasticity import Elasticity
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.materials import stored_trial
from solvers.measures import measure
from solvers.methods import METHODS
from solvers.norms import all_boundary_errors
from solvers.problem import (
    FROM_EXACT,
    Clamped,
    Dirichlet,
    Discretization,
    Inclusion,
    Neumann,
    Periodic,
    Problem,
    Slip,
)

SQUARE = rectangle(min=(-1, -1), max=(1, 1)).named("square")
DISK = disk(center=(0.05, 0), radius=0.4).named("disk")
OUTER = disk(center=(0, 0), radius=1).named("outer")
HOLE = disk(center=(0, 0), radius=0.3).named("hole")
RING = disk(center=(0, 0), radius=0.6).named("ring")
ANNULUS = OUTER - HOLE
LAYER = half_plane(point=(0.13, 0), normal=(-1, 0)).named("layer")


def matrix_field(x, y):
    return exp(0.5 * x) * sin(1.5 * y + 0.3)


def disk_field(x, y):
    return cos(x + y) + 0.3 * x * y


def generic(**data):
    """Two fields that have nothing to do with each other."""
    inner = Inclusion("disk", DISK, Poisson(None, 10.0), FROM_EXACT, FROM_EXACT, disk_field)
    conditions = (Dirichlet(SQUARE.part("all"), FROM_EXACT),)
    return Problem(SQUARE, Poisson(None, **data), conditions, matrix_field, (inner,))


def uniform(k=10.0):
    """Linear inside, linear and 1/r outside: continuous value and flux."""
    c, squared = (1 - k) / (1 + k), 0.16

    def outside(x, y):
        return (x - 0.05) * (1 + c * squared / ((x - 0.05) ** 2 + y * y))

    inner = Inclusion("disk", DISK, Poisson(0.0, k), exact=lambda x, y: (1 + c) * (x - 0.05))
    return Problem(SQUARE, Poisson(0.0), (Dirichlet(SQUARE.part("all"), FROM_EXACT),), outside, (inner,))


def rings(inside=Dirichlet):
    """log r in both rings, the value jumps by 1/2; the inclusion bears the boundary of the hole."""
    shift = 0.8 * np.log(0.6) + 0.5

    def own(x, y):
        return 0.1 * log(x * x + y * y) + shift

    hole = ANNULUS.part("hole")
    given = Dirichlet(hole, 0.2 * np.log(0.3) + shift) if inside is Dirichlet else Neumann(hole, -1 / 0.3)
    return Problem(
        ANNULUS,
        Poisson(0.0),
        (Dirichlet(ANNULUS.part("outer"), 0.0), given),
        lambda x, y: 0.5 * log(x * x + y * y),
        (Inclusion("ring", RING, Poisson(0.0, 5.0), jump=0.5, exact=own),),
    )


def layers(condition=Dirichlet):
    """The interface meets the boundary."""
    return Problem(
        SQUARE,
        Poisson(None),
        (condition(SQUARE.part("all"), FROM_EXACT),),
        lambda x, y: (x - 0.13) * exp(y) + cos(y),
        (
            Inclusion(
                "layer", LAYER, Poisson(None, 5.0), exact=lambda x, y: 0.2 * (x - 0.13) * exp(y) + cos(y)
            ),
        ),
    )


def solved(problem, degree, grid, method="ritz", **more):
    return pipeline.solve(problem, Discretization(degree=degree, grid=grid, **more), METHODS[method])


def order(problem, degree, grids, method="ritz"):
    errors = [measure(solved(problem, degree, grid, method).pieces).norms.l2 for grid in grids]
    return np.log(errors[0] / errors[1]) / np.log(grids[1] / grids[0])


# Structure ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("problem", "jump"), [(generic(), None), (uniform(), 0.0), (rings(), 0.5), (layers(), 0.0)]
)
def test_value_jumps_as_given_for_random_psi(problem, jump):
    given = Discretization(degree=3, grid=16)
    solution = solved(problem, 3, 16)
    rng = np.random.default_rng(0)
    splines = [replace(s, coefficients=rng.normal(size=s.coefficients.shape)) for s in solution.trial.splines]
    trial = stored_trial(problem, given, solution.background.grid, splines)
    interface = solution.pieces[-1]
    for batch in interface.background.rules.boundary.values():
        points = np.stack([c[batch.weights > 0] for c in batch.points(solution.background.grid)], axis=1)
        inside, outside = (trial.within(s) for s in (trial.inclusions[0].structure, trial.structure))
        gap = inside.values(points) - outside.values(points)
        wanted = jump if jump is not None else disk_field(*points.T) - matrix_field(*points.T)
        assert np.abs(gap - wanted).max() < 1e-10


def test_field_at_points_is_that_of_their_material():
    solution = solved(generic(), 4, 16)
    points = np.random.default_rng(1).uniform(-0.95, 0.95, (400, 2))
    inside = DISK.contains(points)
    wanted = np.where(inside, disk_field(*points.T), matrix_field(*points.T))
    assert np.abs(solution.u(points) - wanted).max() < 1e-5
    slope = np.where(inside, -sin(points.sum(axis=1)) + 0.3 * points[:, 1], 0.5 * matrix_field(*points.T))
    assert np.abs(solution.gradient(points)[:, 0] - slope).max() < 1e-3


# Orders -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("degree", "grids"), [(2, (16, 32)), (3, (12, 24)), (4, (12, 24))])
@pytest.mark.parametrize("problem", [generic(), layers()])
def test_order(problem, degree, grids):
    assert abs(order(problem, degree, grids) - (degree + 1)) < 0.3


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_order_of_a_disk_in_a_uniform_field(degree):
    """Faster than h^(p+1), as long as 1/r is being resolved."""
    assert degree + 1 - 0.3 < order(uniform(), degree, (24, 40)) < degree + 2


@pytest.mark.parametrize("inside", [Dirichlet, Neumann])
def test_inclusion_with_a_boundary_of_its_own(inside):
    solution = solved(rings(inside), 4, 32)
    assert measure(solution.pieces).norms.l2 < 1e-6
    errors = all_boundary_errors(solution.pieces)
    assert errors["outer"] < 1e-14
    assert errors["ring"] < 1e-3


@pytest.mark.parametrize("method", ["galerkin", "least-squares", "collocation"])
def test_methods(method):
    solution = solved(generic(), 3, 12, method)
    assert measure(solution.pieces).norms.l2 < 1e-4


def test_high_accuracy():
    assert measure(solved(layers(), 5, 20).pieces).norms.l2 < 1e-9
    assert measure(solved(generic(), 5, 28).pieces).norms.l2 < 1e-9


def test_only_fluxes():
    assert measure(solved(layers(Neumann), 3, 12).pieces).norms.l2 < 1e-5


def test_several_inclusions_smaller_than_a_few_cells():
    spots = [disk(center=(x, 0.3 * x), radius=0.15).named(name) for name, x in (("a", -0.5), ("b", 0.5))]
    equal = tuple(
        Inclusion(n, s, Poisson(None), exact=matrix_field) for n, s in zip("ab", spots, strict=True)
    )
    plain = Problem(SQUARE, Poisson(None), (Dirichlet(SQUARE.part("all"), FROM_EXACT),), matrix_field)
    found = solved(replace(plain, inclusions=equal), 3, 16)
    assert measure(found.pieces).norms.l2 < 1e-5


def test_stiff_fibre_in_an_elastic_body():
    outside = (lambda x, y: sin(x + y), lambda x, y: x * cos(y))
    inside = (lambda x, y: 0.3 * x * y, lambda x, y: exp(0.5 * x) * y)
    fibre = Inclusion(
        "disk", DISK, Elasticity("plane_strain", 20.0, 0.2, None), FROM_EXACT, FROM_EXACT, inside
    )
    body = Problem(
        SQUARE,
        Elasticity("plane_strain", 1.0, 0.3, None),
        (Dirichlet(SQUARE.part("all"), FROM_EXACT),),
        outside,
        (fibre,),
    )
    assert measure(solved(body, 3, 16).pieces).norms.l2 < 1e-4


def test_ball_in_a_box():
    cube = box(min=(0, 0, 0), max=(1, 1, 1)).named("box")
    core = ball(center=(0.5, 0.5, 0.5), radius=0.27).named("ball")
    inner = Inclusion(
        "ball", core, Poisson(None, 5.0), FROM_EXACT, FROM_EXACT, lambda x, y, z: x * y + cos(z)
    )
    exact = lambda x, y, z: sin(x + y) + z  # noqa: E731
    problem = Problem(cube, Poisson(None), (Dirichlet(cube.part("all"), FROM_EXACT),), exact, (inner,))
    assert measure(solved(problem, 2, 6).pieces).norms.l2 < 1.2e-3


def test_inclusions_beside_a_periodic_seam():
    def outside(x, y):
        return sin(np.pi * x) * (1 - y * y)

    inner = Inclusion("disk", DISK, Poisson(None, 4.0), FROM_EXACT, FROM_EXACT, disk_field)
    pair = Periodic(SQUARE.part("square.left"), SQUARE.part("square.right"))
    walls = SQUARE.part("square.bottom") | SQUARE.part("square.top")
    problem = Problem(SQUARE, Poisson(None), (pair, Dirichlet(walls, 0.0)), outside, (inner,))
    solution = solved(problem, 3, 20)
    assert measure(solution.pieces).norms.l2 < 3e-4
    assert all_boundary_errors(solution.pieces)["square.left"] < 1e-10


# Refusals -----------------------------------------------------------------------------------------


def refused(problem, error=StructureError, **more):
    with pytest.raises(error) as caught:
        solved(problem, 2, 12, **more)
    return str(caught.value)


def test_refusals():
    outside = replace(generic(), inclusions=(Inclusion("far", DISK.move((5, 0)), Poisson(0.0)),))
    assert "the inclusion far has no interface with the matrix" in refused(outside)
    assert "use web-spline" in refused(generic(), DiscretizationError, basis="legendre")
    assert "use conditions: natural" in refused(generic(), DiscretizationError, conditions="exact")
    body = Problem(
        SQUARE,
        Elasticity(),
        (Slip(SQUARE.part("square.left")), Dirichlet(SQUARE.part("square.right"))),
        inclusions=(Inclusion("layer", LAYER, Elasticity()),),
    )
    assert "the inclusion layer reaches square.left, which has a slip condition" in refused(body)
    plate = Problem(
        SQUARE, Plate(1.0), (Clamped(SQUARE.part("all")),), inclusions=(Inclusion("d", DISK, Plate(1.0)),)
    )
    assert "the equation plate has no inclusions" in refused(plate)
    torn = Problem(
        SQUARE,
        Poisson(0.0),
        (Dirichlet(SQUARE.part("all"), 0.0),),
        None,
        (Inclusion("l", LAYER, Poisson(0.0), 1.0),),
    )
    assert "the value cannot jump at the interface of l, which meets the essential condition" in refused(torn)
