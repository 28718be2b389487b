"""Multigrid on the two-scale relation: exact prolongation, iterations that neither the grid nor the degree raises."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

from rfm.errors import NumericsError
from rfm.geometry import ball, cylinder, disk
from solvers import pipeline
from solvers.assembly import Assembler
from solvers.equations.elasticity import Elasticity
from solvers.equations.poisson import Poisson
from solvers.evaluation import evaluate
from solvers.grid import Grid
from solvers.linear import solve
from solvers.linear.choice import choose
from solvers.linear.coarse_stencil import coarse_stencil, mask
from solvers.linear.lattice import lattice_of
from solvers.linear.multigrid import hierarchy
from solvers.linear.schwarz import Schwarz, tiled
from solvers.linear.system import ScaledSystem
from solvers.problem import Dirichlet, Discretization, Problem, Slip, SolverOptions
from solvers.quadrature.batch import PointBatch
from solvers.ritz import Ritz
from solvers.web import SplineSpace
from tests.solvers.methods_problems import dirichlet, mixed, on_the_ball
from tests.solvers.synthetic import ball_states, full_states, gauss_batch, to_array, unit_grid
from tests.solvers.test_linear import neumann_assembler

MULTIGRID = SolverOptions(linear="multigrid", tolerance=1e-11)


def iterations(problem, degree, grid, options=MULTIGRID, **more):
    found = pipeline.solve(problem, Discretization(degree=degree, grid=grid, **more), Ritz(), options)
    assert found.linear.method == "multigrid"
    assert found.linear.residual < 1e-10
    return found.linear.iterations


def lattice_on(space, assembler=None):
    """Lattice of one component; without an assembler its matrix is zero."""
    return lattice_of([space], {(0, 0): (assembler or Assembler(space)).stencil})


def space_of(states, degree, *cells):
    grid = unit_grid(*cells)
    return SplineSpace.build(grid, degree, states(grid))


@given(
    degree=st.integers(1, 6),
    cells=st.lists(st.integers(9, 14), min_size=1, max_size=2),
    seed=st.integers(0, 99),
)
@settings(deadline=None, max_examples=25)
def test_a_coarse_spline_on_the_whole_box_is_a_fine_one(degree, cells, seed):
    cells = [2 * (n // 2) for n in cells]
    space = space_of(full_states, degree, *cells)
    lattice = lattice_on(space)
    coarse, prolongation = lattice.coarser()
    grid = Grid(space.grid.lower, 2 * space.grid.spacing, space.grid.cells // 2)
    half = SplineSpace.build(grid, degree, full_states(grid))
    assert coarse.size == half.n_dofs
    unknowns = np.random.default_rng(seed).standard_normal(half.n_dofs)
    points = np.random.default_rng(seed).uniform(0, 1, (50, len(cells))) * space.grid.upper
    np.testing.assert_allclose(
        values(space, prolongation @ unknowns, points), values(half, unknowns, points), atol=1e-12
    )


def values(space, unknowns, points):
    cells, unit = space.grid.locate(points)
    batch = PointBatch(cells, unit[:, None, :], np.ones((len(points), 1)))
    return evaluate(space.full_coefficients(unknowns), space.grid, space.degree, batch)[0]


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
@pytest.mark.parametrize("cells", [(24, 24), (25, 23), (20, 19, 20)])
def test_polynomials_are_carried_over_to_the_boundary(degree, cells):
    """Affine functions as unknowns of both lattices: their values at the middles of the supports."""
    space = space_of(ball_states, degree, *cells)
    lattice = lattice_on(space)
    coarse, prolongation = lattice.coarser()
    index = np.unravel_index(coarse.free.dofs, coarse.shape)
    middles = [
        space.grid.lower[a] + 2 * h * (i + (1 - degree) / 2)
        for a, (h, i) in enumerate(zip(space.grid.spacing, index, strict=True))
    ]
    slope = np.arange(1.0, len(cells) + 1)
    affine = 0.3 + sum(s * m for s, m in zip(slope, middles, strict=True))
    np.testing.assert_allclose(prolongation @ affine, space.affine(0.3, slope), atol=1e-9)
    assert coarse.size < lattice.size / 2


@pytest.mark.parametrize("degree", [2, 3])
def test_iterations_do_not_depend_on_the_grid(degree):
    counts = [iterations(dirichlet(), degree, grid) for grid in (16, 32, 64)]
    assert max(counts) <= 10
    assert counts[2] <= 1.3 * counts[1]


@pytest.mark.parametrize("degree", [2, 3, 4, 5, 6])
def test_iterations_hardly_depend_on_the_degree(degree):
    """Jacobi's preconditioner needs 43, 55, 123, 301 and over 800."""
    assert iterations(dirichlet(), degree, 32) <= 10


@pytest.mark.parametrize(("degree", "grid", "most"), [(2, 10, 8), (2, 20, 8), (3, 10, 15), (4, 9, 15)])
def test_iterations_in_space(degree, grid, most):
    assert iterations(on_the_ball(), degree, grid) <= most


@pytest.mark.parametrize(
    ("degree", "basis", "digits"), [(2, "web-spline", 8), (4, "web-spline", 8), (2, "b-spline", 6)]
)
def test_the_solution_is_that_of_a_factorisation(degree, basis, digits):
    """To fewer digits where the boundary cuts off slivers, whose coefficients hardly count."""
    discretization = Discretization(degree=degree, grid=20, basis=basis)
    found, direct = (
        pipeline.solve(dirichlet(), discretization, Ritz(), SolverOptions(linear=name)).linear
        for name in ("multigrid", "dense")
    )
    np.testing.assert_allclose(found.x, direct.x, rtol=0, atol=10.0**-digits * np.abs(direct.x).max())
    assert found.iterations <= 20


@pytest.mark.parametrize("degree", [2, 3])
def test_flux_conditions_only(degree):
    """The matrix has a null space on every level."""
    assembler = neumann_assembler(24, degree)
    matrix, load = assembler.finish()
    lattice = lattice_on(assembler.space, assembler)
    found = solve(matrix, load, "multigrid", 1e-11, np.ones(len(load)), lattice)
    np.testing.assert_allclose(to_array(matrix) @ found.x, load, atol=1e-9 * np.abs(load).max())
    np.testing.assert_allclose(found.x.sum(), 0.0, atol=1e-10 * np.abs(found.x).sum())
    assert found.iterations <= 20


@pytest.mark.parametrize("degree", [2, 3])
def test_elastic_bodies(degree):
    """Each component has a lattice of its own."""
    body = disk(center=(0.5, 0.5), radius=0.4).named("disk")
    problem = Problem(body, Elasticity(body_force=(1.0, 2.0)), (Dirichlet(body.part("all"), 0.0),))
    counts = [iterations(problem, degree, grid) for grid in (16, 32)]
    assert max(counts) <= 20


def test_flux_on_a_part_of_the_boundary():
    """Next to that part the weight does not vanish."""
    assert iterations(mixed(), 3, 28) <= 14


def test_a_hole_of_few_cells():
    """Coarse grids see little of it; with smoothing by the diagonal it took 169 cycles."""
    body = ball(center=(0, 0, 0), radius=1.0).named("ball") - cylinder(
        center=(0, 0, 0), axis=(0, 0, 1), radius=0.3
    ).named("bore")
    problem = Problem(body, Poisson(source=1.0), (Dirichlet(body.part("all"), 0.0),))
    assert iterations(problem, 2, 8) <= 9


def test_elastic_bodies_in_space_with_a_smooth_socket():
    """In space, too, tiles of low degree hold all components."""
    body = ball(center=(0, 0, 0), radius=1.0).named("ball") - ball(center=(0, 0, 0), radius=0.4).named("hole")
    conditions = (Slip(body.part("ball")), Dirichlet(body.part("hole"), 0.0))
    problem = Problem(body, Elasticity(model="three_dimensional", body_force=(1.0, 2.0, 0.0)), conditions)
    assert iterations(problem, 2, 10) <= 15


@pytest.mark.slow
@pytest.mark.parametrize(
    ("degree", "grid", "most"), [(2, 40, 8), (3, 24, 14), (4, 16, 14), (5, 12, 16), (6, 10, 20)]
)
def test_iterations_in_space_up_to_degree_6(degree, grid, most):
    assert iterations(on_the_ball(), degree, grid) <= most


@pytest.mark.parametrize("degree", [2, 4])
def test_components_coupled_by_a_condition(degree):
    """Without friction only the normal component is held: tiles of one component may need over 50 cycles."""
    body = disk(center=(0, 0), radius=1.0).named("disk") - disk(center=(0, 0), radius=0.4).named("hole")
    conditions = (Slip(body.part("disk")), Dirichlet(body.part("hole"), 0.0))
    problem = Problem(body, Elasticity(body_force=(1.0, 2.0)), conditions)
    assert iterations(problem, degree, 24) <= 20


@pytest.mark.parametrize(("kind", "digits"), [(np.float64, 11), (np.float32, 4)])
def test_sweeps_solve_on_one_tile_after_the_other(kind, digits):
    space = space_of(ball_states, 3, 12, 12)
    matrix, load, lattice = system_of(space)
    scale = matrix.diagonal() ** -0.5
    scaled = scale[:, None] * to_array(matrix) * scale
    tiles = tiled(lattice, 5, 3)
    schwarz = Schwarz.of(matrix, scale, tiles, kind)
    assert np.bincount(tiles[tiles >= 0], minlength=space.n_dofs).min() >= 1
    expected, rhs = np.zeros(len(load)), (scale * load).astype(kind)
    found = expected.astype(kind)
    for backwards in (False, True):
        for tile in tiles[::-1] if backwards else tiles:
            k = tile[tile >= 0]
            expected[k] += np.linalg.solve(scaled[np.ix_(k, k)], (rhs - scaled @ expected)[k])
        schwarz.sweep(found, rhs, backwards)
        np.testing.assert_allclose(found, expected, rtol=0, atol=10.0**-digits * np.abs(expected).max())


@pytest.mark.parametrize("degree", [2, 3])
def test_a_cycle_is_symmetric_and_positive(degree):
    space = space_of(ball_states, degree, 28, 28)
    matrix, load, lattice = system_of(space)
    cycle = hierarchy(ScaledSystem.of(matrix, load, lattice=lattice), lattice)
    assert len(cycle.levels) == 1
    applied = np.stack([cycle(e) for e in np.eye(space.n_dofs)])
    np.testing.assert_allclose(applied, applied.T, atol=1e-4 * np.abs(applied).max())
    assert np.linalg.eigvalsh(applied + applied.T).min() > 0


def system_of(space):
    """Mass and stiffness of the inner cells, as a sparse matrix with a load, and the lattice."""
    assembler = Assembler(space)
    batch = gauss_batch(space.grid, np.argwhere(ball_states(space.grid).state == 1), space.degree + 1)
    w = batch.weights
    assembler.add(batch, {(0, 0): w, (1, 1): w, (2, 2): w}, {0: w})
    matrix, load = assembler.finish()
    sparse = csr_array(matrix)
    sparse.sort_indices()
    return sparse, load, lattice_on(space, assembler)


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("cells", [(12,), (8, 10), (6, 6, 7)])
@pytest.mark.parametrize("alphas", [{(0, 0), (1, 1)}, {(0, 1)}])
def test_coarse_stencils_are_energies_of_coarse_splines(degree, cells, alphas):
    """``T^T A T`` with all B-splines; the antisymmetric part of a form that is not symmetric too."""
    grid = unit_grid(*cells)
    space = SplineSpace.build(grid, degree, full_states(grid))
    assembler = Assembler(space, symmetric=len(alphas) > 1)
    batch = gauss_batch(grid, np.argwhere(full_states(grid).state == 1), degree + 1)
    weight = batch.weights * (1 + np.sin(7 * sum(batch.points(grid))))
    assembler.add(batch, dict.fromkeys(alphas, weight), {})
    fine, coarse = assembler.stencil, coarse_stencil(assembler.stencil)
    assert all(c >= (n - degree + 1) // 2 + degree for c, n in zip(coarse.shape, fine.shape, strict=True))
    scale = np.ones((1, 1))
    for n, c in zip(fine.shape, coarse.shape, strict=True):
        one = np.zeros((n, c))
        for i in range(c):
            for a, m in enumerate(mask(degree)):
                if 0 <= 2 * i - degree + a < n:
                    one[2 * i - degree + a, i] = m
        scale = np.kron(scale, one)
    every, half = np.arange(fine.size), np.arange(coarse.size)
    expected = scale.T @ fine.dense(every, every) @ scale
    np.testing.assert_allclose(coarse.dense(half, half), expected, atol=1e-13 * np.abs(expected).max())


def test_levels_have_unit_diagonals_and_end_small():
    space = space_of(ball_states, 2, 50, 50)
    matrix, load, lattice = system_of(space)
    found = hierarchy(ScaledSystem.of(matrix, load, lattice=lattice), lattice)
    assert len(found.levels) == 2
    for level in found.levels:
        np.testing.assert_allclose(level.smoother.matrix.diagonal(), 1.0, atol=1e-6)
    assert len(found.inverse) <= 300


def test_without_a_lattice_it_is_refused():
    message = r"multigrid needs one grid of splines and an energy.*choose auto"
    with pytest.raises(NumericsError, match=message):
        solve(np.eye(3), np.ones(3), "multigrid")
    with pytest.raises(NumericsError, match=message):
        iterations(dirichlet(), 6, 8, basis="legendre")


def test_what_has_no_lattice():
    space, other = (space_of(ball_states, degree, 12, 12) for degree in (2, 3))
    stencil = Assembler(space).stencil
    assert lattice_of([space, space], {(0, 0): stencil, (1, 1): stencil}).size == space.n_dofs
    assert lattice_of([space, other], {}) is None
    grid = unit_grid(12, 12)
    assert lattice_of([SplineSpace.build(grid, 2, full_states(grid), wraps={0: 1.0})], {}) is None


def test_automatic_choice_of_high_degree():
    options = SolverOptions(tolerance=1e-11)
    coarse, fine = (
        pipeline.solve(dirichlet(), Discretization(degree=5, grid=grid), Ritz(), options).linear
        for grid in (56, 140)
    )
    assert (coarse.method, fine.method) == ("superlu", "multigrid")
    assert "cheaper than multigrid" in coarse.reason
    assert "splines of degree 5" in fine.reason
    space = space_of(ball_states, 3, 100, 100)
    matrix, load, lattice = system_of(space)
    names = [c.name for c in choose(ScaledSystem.of(matrix, load, lattice=lattice))]
    assert names[:2] == ["ssor", "multigrid"]
    assert "amg" not in names


@pytest.mark.parametrize(
    ("degree", "method", "most"), [(2, "ssor", 650), (3, "multigrid", 1450), (5, "multigrid", 3900)]
)
def test_memory_an_unknown_is_bounded(degree, method, most):
    """Matrix and preconditioner in bytes: no more on fine grids than the entries of a row of the whole plane cost."""
    options = SolverOptions(linear=method, tolerance=1e-11)
    found = [
        pipeline.solve(dirichlet(), Discretization(degree=degree, grid=grid), Ritz(), options)
        for grid in (48, 96)
    ]
    sizes = [one.linear.nbytes / one.dofs for one in found]
    assert max(sizes) <= most
    assert sizes[1] <= 1.15 * sizes[0]


@pytest.mark.parametrize(
    ("degree", "method", "most"), [(2, "ssor", 3000), (2, "multigrid", 3400), (3, "multigrid", 7600)]
)
def test_memory_an_unknown_is_bounded_in_space(degree, method, most):
    options = SolverOptions(linear=method, tolerance=1e-11)
    found = pipeline.solve(on_the_ball(), Discretization(degree=degree, grid=20), Ritz(), options)
    assert found.linear.nbytes / found.dofs <= most
