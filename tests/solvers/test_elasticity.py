"""Elasticity on closed forms: orders p + 1 in L2 and p in energy, patch tests, rigid motions, every condition."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.errors import NumericsError, RfmError, StructureError
from rfm.geometry import box, disk, polygon, rectangle
from solvers import ritz
from solvers.boundary import condition_rows
from solvers.equations.elasticity import MODELS, Elasticity
from solvers.equations.rows import apply
from solvers.exact import exact_jet
from solvers.measures import measure
from solvers.norms import boundary_errors
from solvers.problem import (
    FROM_EXACT,
    Dirichlet,
    Discretization,
    Neumann,
    Pressure,
    Problem,
    Slip,
    Traction,
)

DISK = disk(center=(0, 0), radius=1).named("disk")
HOLE = disk(center=(0, 0), radius=0.4).named("hole")
RING = DISK - HOLE
SQUARE = rectangle(min=(0, 0), max=(1, 1)).named("square")


def generic_x(x, y):
    return exp(x) * sin(y + 0.3)


def generic_y(x, y):
    return cos(x - y) + x * y


GENERIC = (generic_x, generic_y)


def solve(problem, degree, grid, **more):
    return ritz.solve(problem, Discretization(degree=degree, grid=grid, **more))


def errors(problem, degree, grid, **more):
    solution = solve(problem, degree, grid, **more)
    found = measure(solution.pieces)
    return np.array([found.norms.l2, found.energy_norm])


def orders(problem, degree, grids, **more):
    rows = np.log([errors(problem, degree, grid, **more) for grid in grids])
    return -np.diff(rows, axis=0) / np.diff(np.log(grids))[:, None]


@pytest.mark.parametrize(("degree", "grids"), [(1, (32, 64)), (2, (32, 48)), (3, (24, 40)), (4, (24, 36))])
def test_order_with_displacements_and_tractions(degree, grids):
    conditions = (Dirichlet(RING.part("disk"), FROM_EXACT), Traction(RING.part("hole"), FROM_EXACT))
    problem = Problem(RING, Elasticity(body_force=None), conditions, exact=GENERIC)
    l2, energy = orders(problem, degree, grids)[-1]
    assert degree + 1 - 0.25 < l2 < degree + 1.6
    assert degree - 0.2 < energy < degree + 1.1


@pytest.mark.parametrize("model", ["plane_stress", "plane_strain"])
def test_moduli_may_vary(model):
    def young(x, y):
        return 1 + x * y

    def ratio(x, y):
        return 0.2 + 0.1 * x

    equation = Elasticity(model, young, ratio, body_force=None)
    conditions = (
        Dirichlet(SQUARE.part("square.left"), FROM_EXACT),
        Traction(_rest("square.left"), FROM_EXACT),
    )
    problem = Problem(SQUARE, equation, conditions, exact=GENERIC)
    assert errors(problem, 4, 8)[0] < 1e-6


def _rest(*names):
    part = SQUARE.part("all")
    for name in names:
        part = part - SQUARE.part(name)
    return part


def test_divergence_of_the_stress_is_the_traction_through_the_boundary():
    """The strong residual and the traction rows belong together: Gauss' theorem on the square."""
    equation = Elasticity("plane_stress", lambda x, y: 1 + x * y, lambda x, y: 0.3 - 0.1 * y, body_force=None)
    problem = Problem(SQUARE, equation, (Traction(SQUARE.part("all"), FROM_EXACT),), exact=GENERIC)
    background = solve(problem, 3, 4).background
    force, push = np.zeros(2), np.zeros(2)
    for batch in background.rules.inner.chunks(10**6), background.rules.cut.chunks(10**6):
        for piece in batch:
            f = equation.force(piece.points(background.grid), GENERIC)
            force += [float(np.sum(component * piece.weights)) for component in f]
    for batch in background.rules.boundary.values():
        coords = batch.points(background.grid)
        rows = equation.flux(coords, batch.normals)
        jet = exact_jet(GENERIC, coords, 1)
        push += [float(np.sum(apply(row, jet) * batch.weights)) for row in rows]
    np.testing.assert_allclose(force, -push, atol=1e-6)


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_patch_test(degree):
    """A linear displacement under its own tractions is found to rounding on a body that no grid line follows."""
    body = polygon(vertices=[(0.1, 0), (1, 0.2), (0.9, 0.8), (0.45, 1), (0, 0.7)]).named("body")
    linear = (lambda x, y: 0.3 + 0.1 * x + 0.2 * y, lambda x, y: 0.05 * y - 0.3 * x)
    problem = Problem(body, Elasticity(), (Traction(body.part("all"), FROM_EXACT),), exact=linear)
    assert errors(problem, degree, 10).max() < 1e-11


def test_rollers_leave_a_component_free():
    exact = (lambda x, y: sin(x) + 0 * y, lambda x, y: y * cos(2 * y) + 0 * x)
    conditions = (
        Dirichlet(SQUARE.part("square.left"), (0.0, None)),
        Dirichlet(SQUARE.part("square.bottom"), (None, FROM_EXACT)),
        Traction(_rest("square.left", "square.bottom"), FROM_EXACT),
    )
    problem = Problem(SQUARE, Elasticity(body_force=None), conditions, exact=exact)
    solution = solve(problem, 4, 8)
    assert measure(solution.pieces).norms.l2 < 1e-6
    y = np.linspace(0, 1, 7)
    assert np.abs(solution.u(np.stack([0 * y, y], axis=1))[:, 0]).max() < 1e-15
    worst = boundary_errors(problem, solution.trial, solution.background)
    assert 1e-9 < worst["square.left"] < 1e-5  # no shear, by the functional


def test_rollers_leave_a_rigid_motion_free():
    """Held across on two parallel sides, the body may still move along them."""
    exact = (lambda x, y: 0 * x, lambda x, y: y + 0 * x)
    conditions = (
        Dirichlet(SQUARE.part("square.left") | SQUARE.part("square.right"), (0.0, None)),
        Traction(_rest("square.left", "square.right"), FROM_EXACT),
    )
    problem = Problem(SQUARE, Elasticity(), conditions, exact=exact)
    assert errors(problem, 2, 6).max() < 1e-11
    loaded = Problem(SQUARE, Elasticity(body_force=(0.0, 1.0)), conditions)
    with pytest.raises(NumericsError, match="translation along y free"):
        solve(Problem(SQUARE, loaded.equation, conditions[:1]), 2, 6)


def test_pressure_in_a_thick_cylinder():
    """Lame: nothing holds the body but symmetry."""
    factor = (1 + 0.3) / 10 * 0.16 / (1 - 0.16)

    def radial(component):
        def u(x, y):
            return factor * (x, y)[component] * (1 - 0.6 + 1 / (x * x + y * y))

        return u

    equation = Elasticity("plane_strain", 10.0, 0.3)
    conditions = (Pressure(RING.part("hole"), 1.0), Traction(RING.part("disk"), (0.0, 0.0)))
    problem = Problem(RING, equation, conditions, exact=(radial(0), radial(1)))
    solution = solve(problem, 5, 24)
    assert measure(solution.pieces).norms.l2 < 1e-5
    hoop = (1 + 0.16) / (1 - 0.16) * 0.16 / 0.16
    stress = equation.derived([np.array([0.4]), np.array([0.0])], solution.trial.at([[0.4, 0.0]], 1))[
        "stress"
    ]
    assert abs(stress["yy"][0] - hoop) < 0.02
    assert abs(stress["zz"][0] - 0.3 * (stress["xx"][0] + stress["yy"][0])) < 1e-12


@pytest.mark.parametrize(("degree", "grids"), [(2, (24, 40)), (3, (24, 40))])
def test_slip_on_a_curved_wall_keeps_the_order(degree, grids):
    """u = (1 - r^2) f + (a rotation varying from point to point): tangential on the circle, generic inside."""

    def u(x, y):
        return (1 - x * x - y * y) * exp(x) * (1 + y) - y * exp(y) * (1 + x)

    def v(x, y):
        return (1 - x * x - y * y) * cos(y - x) + x * exp(y) * (1 + x)

    conditions = (Slip(RING.part("disk"), FROM_EXACT), Dirichlet(RING.part("hole"), FROM_EXACT))
    problem = Problem(RING, Elasticity(body_force=None), conditions, exact=(u, v))
    solution = solve(problem, degree, grids[0])
    points = np.array([[np.cos(t), np.sin(t)] for t in np.linspace(0, 6, 50)])
    assert np.abs(np.einsum("nc,nc->n", solution.u(points), points)).max() < 1e-13
    l2, energy = orders(problem, degree, grids)[-1]
    assert l2 > degree + 1 - 0.3
    assert energy > degree - 0.3


def test_slip_alone_does_not_hold_a_disk():
    problem = Problem(DISK, Elasticity(body_force=(1.0, 0.0)), (Slip(DISK.part("all")),))
    with pytest.raises(NumericsError, match="rotation in the xy plane free"):
        solve(problem, 2, 8)


def test_order_in_space():
    block = box(min=(0, 0, 0), max=(1, 1, 1)).named("block")
    exact = (
        lambda x, y, z: exp(x) * sin(y) * cos(z),
        lambda x, y, z: sin(x * y + z),
        lambda x, y, z: x * y * z + cos(x),
    )
    left = block.part("block.left")
    conditions = (Dirichlet(left, FROM_EXACT), Traction(block.part("all") - left, FROM_EXACT))
    equation = Elasticity("three_dimensional", 1.0, 0.3, body_force=None)
    l2, energy = orders(Problem(block, equation, conditions, exact=exact), 2, (3, 6))[-1]
    assert l2 > 2.7
    assert energy > 1.75


def test_a_rotated_block_is_a_rigid_motion():
    block = box(min=(0, 0, 0), max=(1, 1, 1)).named("block")
    exact = (lambda x, y, z: 0.2 * y - z + 1, lambda x, y, z: 0.5 * z - 0.2 * x, lambda x, y, z: x - 0.5 * y)
    problem = Problem(
        block,
        Elasticity("three_dimensional", body_force=None),
        (Traction(block.part("all"), FROM_EXACT),),
        exact=exact,
    )
    assert errors(problem, 1, 3)[0] < 1e-11


@pytest.mark.parametrize("model", MODELS)
def test_the_strong_residual_of_its_own_solution_vanishes(model):
    dimension = MODELS[model].dimension
    exact = tuple(_wave(c) for c in range(dimension))
    coords = list(np.random.default_rng(1).uniform(0.1, 0.9, (dimension, 20)))
    equation = Elasticity(model, lambda *x: 1 + x[0] * x[1], lambda *x: 0.2 + 0.1 * x[0], body_force=None)
    jet = exact_jet(exact, coords, 2)
    for row, force in equation.residual(coords, exact):
        np.testing.assert_allclose(apply(row, jet), force, rtol=1e-12)


def _wave(c):
    return lambda *x: sin(x[0] + (c + 1) * x[1]) * exp(x[-1] / (c + 1))


def test_condition_rows_hold_for_the_exact_solution():
    coords = [np.array([0.6, 0.0]), np.array([0.8, 1.0])]
    normals = np.stack(coords, axis=1)
    for condition in (
        Dirichlet(RING.part("disk"), FROM_EXACT),
        Traction(RING.part("disk"), FROM_EXACT),
    ):
        problem = Problem(RING, Elasticity(body_force=None), (condition,), exact=GENERIC)
        jet = exact_jet(GENERIC, coords, 1)
        for row, right in condition_rows(problem, condition, coords, normals):
            np.testing.assert_allclose(apply(row, jet), right, rtol=1e-13)


def test_unbalanced_loads_are_refused():
    problem = Problem(RING, Elasticity(body_force=(0.0, 1.0)), (Traction(RING.part("all"), (0.0, 0.0)),))
    with pytest.raises(NumericsError, match=r"translation along y free.*resultant is 2\.63"):
        solve(problem, 2, 12)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"model": "plain_stress"}, "choose one of plane_stress"),
        ({"poisson_ratio": 0.5}, "poisson_ratio must be"),
        ({"young_modulus": -1.0}, "young_modulus must be positive"),
    ],
)
def test_wrong_moduli_are_refused(wrong, message):
    with pytest.raises(RfmError, match=message):
        Elasticity(**wrong)


def test_conditions_of_other_equations_are_refused():
    problem = Problem(RING, Elasticity(), (Neumann(RING.part("all"), 0.0),))
    with pytest.raises(StructureError, match="has no condition Neumann"):
        solve(problem, 2, 8)


def test_a_plane_model_is_refused_in_space():
    block = box(min=(0, 0, 0), max=(1, 1, 1)).named("block")
    problem = Problem(block, Elasticity(), (Dirichlet(block.part("all"), (0.0, 0.0, 0.0)),))
    with pytest.raises(RfmError, match="choose three_dimensional"):
        solve(problem, 2, 4)
