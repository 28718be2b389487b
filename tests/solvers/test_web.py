"""WEB-splines: which indices are inner, polynomials are reproduced, a grid that is too coarse is refused."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rfm.errors import DiscretizationError
from solvers.quadrature.batch import TensorBatch
from solvers.splines import tables
from solvers.web import SplineSpace, evaluate
from tests.solvers.synthetic import States, as_points, ball_states, full_states, gauss_batch, unit_grid


def relevant(space):
    mask = np.zeros(space.shape, dtype=bool)
    mask.ravel()[np.concatenate([space.free.dofs, space.free.outer])] = True
    return mask


def monomial_coefficients(degree, power, count):
    """B-spline coefficients of t^power, t in cells, on a line of `count` cells."""
    t = (np.arange(count * (degree + 1)) + 0.5) / (degree + 1)
    cells = t.astype(int)
    matrix = np.zeros((len(t), count + degree))
    matrix[np.arange(len(t))[:, None], cells[:, None] + np.arange(degree + 1)] = tables(degree, t - cells)[0]
    return np.linalg.lstsq(matrix, (t / count) ** power, rcond=None)[0]


def assert_reproduces_polynomials(space):
    """Extending the inner coefficients of a polynomial gives its outer ones."""
    lines = [
        [monomial_coefficients(space.degree, k, int(n)) for k in range(space.degree + 1)]
        for n in space.grid.cells
    ]
    where = relevant(space)
    for powers in itertools.product(range(space.degree + 1), repeat=len(lines)):
        exact = np.ones(())
        for line, power in zip(lines, powers, strict=True):
            exact = np.multiply.outer(exact, line[power])
        extended = space.full_coefficients(exact.ravel()[space.free.dofs])
        growth = np.abs(space.free.coefficients).sum(axis=1).max()
        np.testing.assert_allclose(extended[where], exact[where], atol=1e-11 * growth)


@pytest.mark.parametrize("degree", range(1, 6))
def test_polynomials_are_reproduced_in_2d(degree):
    grid = unit_grid(3 * degree + 6, 3 * degree + 5)
    assert_reproduces_polynomials(SplineSpace.build(grid, degree, ball_states(grid)))


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_polynomials_are_reproduced_in_3d(degree):
    grid = unit_grid(2 * degree + 6, 2 * degree + 5, 2 * degree + 6)
    assert_reproduces_polynomials(SplineSpace.build(grid, degree, ball_states(grid)))


@pytest.mark.parametrize(("degree", "dimension"), [(4, 3), (5, 3), (6, 2), (7, 2), (8, 2)])
def test_random_polynomials_of_high_degree_are_reproduced(degree, dimension):
    grid = unit_grid(*[2 * degree + 4] * dimension)
    space = SplineSpace.build(grid, degree, ball_states(grid))
    rng = np.random.default_rng(degree)
    exact = np.ones(())
    for n in grid.cells:  # a product of polynomials of degree p, one a direction
        line = sum(rng.uniform(-1, 1) * monomial_coefficients(degree, k, int(n)) for k in range(degree + 1))
        exact = np.multiply.outer(exact, line)
    where = relevant(space)
    extended = space.full_coefficients(exact.ravel()[space.free.dofs])
    growth = np.abs(space.free.coefficients).sum(axis=1).max()
    np.testing.assert_allclose(
        extended[where], exact[where], atol=1e-10 * growth * np.abs(exact[where]).max()
    )


def test_inner_and_outer_indices_by_their_definition():
    grid, degree = unit_grid(9, 8), 2
    state = ball_states(grid).state
    space = SplineSpace.build(grid, degree, States(state))
    inner, outer = set(space.free.dofs), set(space.free.outer)
    for number, index in enumerate(np.ndindex(space.shape)):
        support = state[tuple(slice(max(0, i - degree), i + 1) for i in index)]
        assert (number in inner) == bool((support == 1).any())
        assert (number in outer) == bool((support >= 0).any() and not (support == 1).any())


def test_extension_rows():
    grid, degree = unit_grid(10, 10), 3
    space = SplineSpace.build(grid, degree, ball_states(grid))
    free = space.free
    np.testing.assert_allclose(free.coefficients.sum(axis=1), 1.0, rtol=1e-12)
    # the sources are the full array of (p+1)^d indices above their first one
    sources = np.stack(np.unravel_index(free.dofs[free.sources], space.shape), axis=-1)
    local = np.moveaxis(np.indices((degree + 1,) * 2), 0, -1).reshape(-1, 2)
    assert (sources == sources[:, :1] + local).all()
    coefficients = np.random.default_rng(0).standard_normal(space.n_dofs)
    full = (space.extension.T @ coefficients).reshape(space.shape)
    np.testing.assert_allclose(space.full_coefficients(coefficients), full, rtol=1e-12, atol=1e-12)


def test_no_array_has_smaller_coefficients_than_the_nearest():
    grid, degree = unit_grid(8, 7), 2
    space = SplineSpace.build(grid, degree, ball_states(grid))
    inner = np.zeros(space.shape, dtype=bool)
    inner.ravel()[space.free.dofs] = True
    corners = [
        np.array(c)
        for c in np.ndindex(*(n - degree for n in space.shape))
        if inner[tuple(slice(k, k + degree + 1) for k in c)].all()
    ]
    nodes = np.arange(degree + 1)
    basis = [np.prod([Polynomial([-k, 1]) / (i - k) for k in nodes if k != i]) for i in nodes]

    def growth(shift):
        return np.prod([sum(abs(b(s)) for b in basis) for s in shift])

    for j, e in zip(space.free.outer, space.free.coefficients, strict=True):
        where = np.array(np.unravel_index(j, space.shape))
        best = min(growth(where - corner) for corner in corners)
        np.testing.assert_allclose(np.abs(e).sum(), best, rtol=1e-10)


def test_a_full_box_needs_no_extension():
    grid = unit_grid(4, 5)
    web = SplineSpace.build(grid, 3, full_states(grid))
    assert web.n_dofs == np.prod(web.shape)
    assert not len(web.free.outer)


def test_plain_splines_have_an_unknown_for_each_relevant_index():
    grid = unit_grid(9, 9)
    web, plain = (SplineSpace.build(grid, 2, ball_states(grid), basis=b) for b in ("web-spline", "b-spline"))
    assert plain.n_dofs == len(web.free.dofs) + len(web.free.outer)


def test_outer_indices_out_of_reach_stay_free():
    degree = 2
    state = np.full((14, 5), -1, dtype=np.int8)
    state[1:4, 1:4] = 1
    state[4:13, 2] = 0  # a needle without an inner cell
    space = SplineSpace.build(unit_grid(14, 5), degree, States(state))
    exposed = np.stack(np.unravel_index(space.free.exposed, space.shape), axis=-1)
    # inner indices reach 5 in the first direction, extended ones two farther
    assert exposed[:, 0].min() == 3 + degree + 2 + 1
    assert set(space.free.exposed) < set(space.free.dofs)
    assert not set(space.free.dofs) & set(space.free.outer)
    assert_reproduces_polynomials(space)
    # the cells whose splines include exposed ones
    delicate = np.zeros_like(state, dtype=bool)
    for i, j in exposed:
        delicate[max(0, i - degree) : i + 1, max(0, j - degree) : j + 1] = True
    np.testing.assert_array_equal(space.delicate_cells, delicate)


def test_which_cells_are_delicate():
    grid = unit_grid(12, 12)
    states = ball_states(grid)
    assert not SplineSpace.build(grid, 3, states).delicate_cells.any()
    plain = SplineSpace.build(grid, 3, states, basis="b-spline")
    assert plain.delicate_cells[states.state == 0].all()


def test_cut_cells_without_points_carry_no_splines():
    grid = unit_grid(9, 9)
    states = ball_states(grid)
    cut = np.argwhere(states.state == 0)
    fewer = SplineSpace.build(grid, 2, states, cut_cells=cut[: len(cut) // 2])
    every = SplineSpace.build(grid, 2, states, cut_cells=cut)
    assert len(fewer.free.outer) < len(every.free.outer) == len(SplineSpace.build(grid, 2, states).free.outer)


def test_a_grid_without_an_inner_cell_is_refused_with_a_grid_that_does():
    def classify(cells):
        return ball_states(unit_grid(cells, cells), radius=0.2)

    with pytest.raises(DiscretizationError) as caught:
        SplineSpace.build(unit_grid(3, 3), 5, classify(3), finer=classify)
    message = str(caught.value)
    assert "6x6" in message
    assert "basis: b-spline" in message
    remedy = int(re.search(r"use grid: (\d+)", message)[1])
    SplineSpace.build(unit_grid(remedy, remedy), 5, classify(remedy))
    with pytest.raises(DiscretizationError, match="use a finer grid"):
        SplineSpace.build(unit_grid(3, 3), 5, classify(3))
    assert SplineSpace.build(unit_grid(3, 3), 5, classify(3), basis="b-spline").n_dofs


def test_one_inner_cell_is_enough():
    state = np.full((7, 7), -1, dtype=np.int8)
    state[2:4, 2:5] = 0
    state[3, 3] = 1
    space = SplineSpace.build(unit_grid(7, 7), 3, States(state))
    assert space.n_dofs == 16
    assert_reproduces_polynomials(space)


def test_an_unknown_basis_is_refused():
    grid = unit_grid(4, 4)
    with pytest.raises(DiscretizationError, match="b-spline, web-spline"):
        SplineSpace.build(grid, 2, full_states(grid), basis="p-spline")


@pytest.mark.parametrize("dimension", [2, 3])
def test_evaluation_agrees_between_batches_and_with_finite_differences(dimension):
    grid, degree = unit_grid(*[5] * dimension), 3
    coefficients = np.random.default_rng(1).standard_normal(tuple(grid.cells + degree))
    cells = np.argwhere(np.ones(tuple(grid.cells), dtype=bool))[::7]
    batch = gauss_batch(grid, cells, 4)
    on_tensor = evaluate(coefficients, grid, degree, batch, 2)
    on_points = evaluate(coefficients, grid, degree, as_points(batch), 2)
    np.testing.assert_allclose(on_points, on_tensor, atol=1e-12 * np.abs(on_tensor).max())

    step = 1e-5
    for axis in range(dimension):
        moved = as_points(batch)
        unit = np.zeros(dimension)
        unit[axis] = step / grid.spacing[axis]
        ahead, behind = (
            evaluate(coefficients, grid, degree, type(moved)(cells, moved.nodes + s * unit, moved.weights))[0]
            for s in (1, -1)
        )
        difference = (ahead - behind) / (2 * step)
        np.testing.assert_allclose(on_tensor[1 + axis], difference, atol=1e-6 * np.abs(difference).max())


def test_evaluation_of_a_polynomial():
    grid, degree = unit_grid(6, 7), 4
    x, y = (monomial_coefficients(degree, 3, 6), monomial_coefficients(degree, 2, 7))
    cells = np.argwhere(np.ones((6, 7), dtype=bool))
    batch = TensorBatch(cells, np.array([0.2, 0.7]), np.ones((42, 4)))
    a, b = (c * s for c, s in zip(batch.points(grid), 1 / (grid.spacing * grid.cells), strict=True))
    found = evaluate(np.multiply.outer(x, y), grid, degree, batch, 1)
    np.testing.assert_allclose(found[0], a**3 * b**2, atol=1e-13)
    sides = grid.spacing * grid.cells
    np.testing.assert_allclose(found[1], 3 * a**2 * b**2 / sides[0], atol=1e-11)
    np.testing.assert_allclose(found[2], 2 * a**3 * b / sides[1], atol=1e-11)
