"""Kirchhoff's plate on closed forms: order min(p + 1, 2 (p - 1)) in L2, p - 1 in the energy norm, every edge."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.errors import DiscretizationError, RfmError, StructureError
from rfm.geometry import ball, disk, ellipse, rectangle
from solvers import ritz
from solvers.boundary import condition_rows
from solvers.equations.plate import Plate, curvature
from solvers.equations.rows import apply
from solvers.exact import exact_jet
from solvers.measures import measure
from solvers.norms import boundary_errors
from solvers.problem import (
    FROM_EXACT,
    Clamped,
    Dirichlet,
    Discretization,
    Free,
    Problem,
    SimplySupported,
)

DISK = disk(center=(0, 0), radius=1).named("disk")
HOLE = disk(center=(0, 0), radius=0.4).named("hole")
RING = DISK - HOLE
SQUARE = rectangle(min=(0, 0), max=(1, 1)).named("square")


def generic(x, y):
    return exp(x) * sin(2 * y + 0.3) + x * x * y


def clamped_deflection(x, y):
    """Vanishes with its slope on the unit circle, no multiple of a squared weight by a polynomial."""
    return (1 - x * x - y * y) ** 2 * exp(x) * sin(2 * y + 0.3)


def solve(problem, degree, grid, **more):
    return ritz.solve(problem, Discretization(degree=degree, grid=grid, **more))


def errors(problem, degree, grid, **more):
    solution = solve(problem, degree, grid, **more)
    found = measure(solution.pieces)
    return np.array([found.norms.l2, found.energy_norm])


def orders(problem, degree, grids, **more):
    rows = np.log([errors(problem, degree, grid, **more) for grid in grids])
    return -np.diff(rows, axis=0) / np.diff(np.log(grids))[:, None]


@pytest.mark.parametrize(("degree", "grids"), [(2, (24, 48)), (3, (24, 48)), (4, (16, 32))])
def test_order_of_the_clamped_disk(degree, grids):
    problem = Problem(DISK, Plate(load=None), (Clamped(DISK.part("all")),), exact=clamped_deflection)
    l2, energy = orders(problem, degree, grids)[-1]
    expected = min(degree + 1, 2 * (degree - 1))
    assert expected - 0.2 < l2 < expected + 0.6
    assert abs(energy - (degree - 1)) < 0.3


@pytest.mark.parametrize("stiffness", [1.0, lambda x, y: 1 + x / 4 + y * y / 8])
def test_free_edge_with_its_moment_and_shear_force(stiffness):
    conditions = (
        Clamped(RING.part("disk"), FROM_EXACT, FROM_EXACT),
        Free(RING.part("hole"), FROM_EXACT, FROM_EXACT),
    )
    problem = Problem(RING, Plate(stiffness, 0.25, None), conditions, exact=generic)
    l2, energy = orders(problem, 3, (16, 32))[-1]
    assert l2 > 3.2
    assert energy > 1.8


def test_moments_and_forces_as_numbers_do_the_same_work():
    """w = x^2 + y^2: M = -2 (1 + nu), V = 0 on any circle; and an edge force from w = r^4."""
    nu = 0.3

    def w(x, y):
        s = x * x + y * y
        return s + s * s / 8

    # w'' + nu w'/r at r = 0.4, and the slope of the Laplacian 4 + 2 r^2; n points towards the centre
    r = 0.4
    moment = -((2 + 1.5 * r**2) + nu * (2 * r + r**3 / 2) / r)
    shear = 4 * r
    conditions = (Clamped(RING.part("disk"), FROM_EXACT, FROM_EXACT), Free(RING.part("hole"), moment, shear))
    problem = Problem(RING, Plate(1.0, nu, None), conditions, exact=w)
    assert errors(problem, 5, 16)[0] < 1e-7


def test_supported_disk_under_uniform_load():
    """On a curved edge the moment has a term of the slope; a polynomial deflection of degree 4 is found to rounding."""
    nu = 0.3

    def w(x, y):
        s = x * x + y * y
        return (1 - s) * ((5 + nu) / (1 + nu) - s) / 64

    problem = Problem(DISK, Plate(1.0, nu, 1.0), (SimplySupported(DISK.part("all")),), exact=w)
    solution = solve(problem, 4, 12, weight="product")
    assert measure(solution.pieces).norms.l2 < 1e-12
    assert boundary_errors(problem, solution.trial, solution.background)["all"] < 1e-10


def test_sides_of_a_square_with_different_conditions():
    conditions = (
        SimplySupported(SQUARE.part("square.left"), FROM_EXACT, FROM_EXACT),
        Clamped(SQUARE.part("square.right"), FROM_EXACT, FROM_EXACT),
        Free(SQUARE.part("square.top") | SQUARE.part("square.bottom"), FROM_EXACT, FROM_EXACT),
    )
    problem = Problem(SQUARE, Plate(lambda x, y: 1 + x * y, 0.2, None), conditions, exact=generic)
    l2, energy = orders(problem, 3, (8, 16))[-1]
    assert l2 > 3.7
    assert energy > 1.8


def test_a_free_plate_is_fixed_by_its_rigid_motions():
    problem = Problem(
        SQUARE, Plate(load=None), (Free(SQUARE.part("all"), FROM_EXACT, FROM_EXACT),), exact=generic
    )
    assert errors(problem, 5, 8)[0] < 1e-7


def test_navier():
    def load(x, y):
        return sin(np.pi * x) * sin(np.pi * y)

    def w(x, y):
        return load(x, y) / (4 * np.pi**4)

    problem = Problem(SQUARE, Plate(load=load), (SimplySupported(SQUARE.part("all")),), exact=w)
    assert errors(problem, 4, 12)[0] < 1e-7


def test_explicit_values_and_slopes_are_taken_exactly():
    """Value and slope as formulas on two circles: joined by Taylor polynomials."""

    def slope(x, y):
        dx = exp(x) * sin(2 * y + 0.3) + 2 * x * y
        dy = 2 * exp(x) * cos(2 * y + 0.3) + x * x
        return x * dx + y * dy

    conditions = (
        Clamped(RING.part("disk"), generic, slope),
        SimplySupported(RING.part("hole"), FROM_EXACT, FROM_EXACT),
    )
    problem = Problem(RING, Plate(load=None), conditions, exact=generic)
    solution = solve(problem, 3, 16)
    worst = boundary_errors(problem, solution.trial, solution.background)
    assert worst["disk"] < 1e-13
    assert measure(solution.pieces).norms.l2 < 1e-7


def test_the_strong_residual_of_its_own_solution_vanishes():
    coords = list(np.random.default_rng(2).uniform(0.1, 0.9, (2, 20)))
    equation = Plate(lambda x, y: 1 + x * y * y, 0.2, None)
    ((row, load),) = equation.residual(coords, generic)
    np.testing.assert_allclose(apply(row, exact_jet(generic, coords, 4)), load, rtol=1e-12)
    ((row, _),) = Plate(2.0, 0.2, 0.0).residual(coords, None)
    w = exact_jet(generic, coords, 4)
    np.testing.assert_allclose(apply(row, w), 2 * (w[10] + 2 * w[12] + w[14]), rtol=1e-12)


def test_shear_force_of_a_twisted_edge():
    """w = x y has no curvature-free edge force on a straight side, M = 0 there; on a circle w = x y = r^2 sin(2t)/2."""
    t = np.linspace(0.1, 6, 7)
    coords = [np.cos(t), np.sin(t)]
    normals = np.stack(coords, axis=1)
    condition = Free(DISK.part("all"))
    problem = Problem(DISK, Plate(1.0, 0.3, 0.0), (condition,), exact=lambda x, y: x * y)
    rows = condition_rows(problem, condition, coords, normals)
    jet = exact_jet(problem.exact, coords, 3)
    # M = -(w_rr + nu (w_r/r + w_tt/r^2)), V = -(1-nu) d/dt (w_rt - w_t) on r = 1 (the Laplacian vanishes)
    np.testing.assert_allclose(apply(rows[0][0], jet), -0.7 * np.sin(2 * t), atol=1e-13)
    np.testing.assert_allclose(apply(rows[1][0], jet), 0.7 * 2 * np.sin(2 * t), atol=1e-13)


def test_curvature():
    t = np.linspace(0.1, 6, 9)
    normals = np.stack([np.cos(t), np.sin(t)], axis=1)
    np.testing.assert_allclose(curvature(RING.part("disk"), list(normals.T), normals), 1.0, rtol=1e-12)
    np.testing.assert_allclose(
        curvature(RING.part("hole"), list(0.4 * normals.T), -normals), -2.5, rtol=1e-12
    )
    shape = ellipse(center=(0, 0), semi_axes=(2, 1)).named("e")
    tip = curvature(
        shape.part("all"), [np.array([2.0]), np.array([0.0])], np.array([[1.0, 0.0], [0.0, 1.0]])[:1]
    )
    np.testing.assert_allclose(tip, 2.0, rtol=1e-12)


def test_degree_one_is_refused():
    problem = Problem(DISK, Plate(load=1.0), (Clamped(DISK.part("all")),))
    with pytest.raises(DiscretizationError, match="degree 2 or more"):
        solve(problem, 1, 8)


def test_a_missing_condition_is_refused():
    problem = Problem(RING, Plate(load=1.0), (Clamped(RING.part("disk")),))
    with pytest.raises(StructureError, match=r"hole has no condition.*fourth order"):
        solve(problem, 3, 8)


def test_a_condition_of_second_order_equations_is_refused():
    problem = Problem(DISK, Plate(load=1.0), (Dirichlet(DISK.part("all")),))
    with pytest.raises(StructureError, match=r"needs two conditions.*Clamped, SimplySupported, Free"):
        solve(problem, 3, 8)


def test_clamped_and_free_on_one_edge_are_refused():
    conditions = (Clamped(DISK.part("all")), Free(DISK.part("disk")))
    with pytest.raises(StructureError, match=r"carries both Clamped .* and Free"):
        solve(Problem(DISK, Plate(load=1.0), conditions), 3, 8)


def test_a_plate_in_space_is_refused():
    sphere = ball(center=(0, 0, 0), radius=1).named("ball")
    with pytest.raises(RfmError, match="use elasticity"):
        solve(Problem(sphere, Plate(load=1.0), (Clamped(sphere.part("all")),)), 3, 4)
