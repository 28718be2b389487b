"""Matrices and loads against a brute-force sum over all pairs of B-splines, and properties they must have."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from rfm.calculus.jets import multi_indices
from solvers.assembly import Assembler
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.splines import tables
from solvers.web import SplineSpace
from tests.solvers.synthetic import as_points, ball_states, full_states, gauss_batch, to_array, unit_grid


def brute_force(space, batch, C, b):
    """Dense sums over all splines, points and pairs of derivatives."""
    grid, p = space.grid, space.degree
    dimension, size = len(grid.cells), int(np.prod(space.shape))
    order = max(sum(alpha) for alpha in multi_indices(dimension, 2)[: len(b)])
    matrix, load = np.zeros((size, size)), np.zeros(size)
    local = np.array(list(itertools.product(range(p + 1), repeat=dimension)))
    for row, cell in enumerate(batch.cells):
        index = np.ravel_multi_index((cell + local).T, space.shape)
        line = tables(p, batch.nodes[row], order)  # (order + 1, q, d, p + 1)
        jets = []
        for alpha in multi_indices(dimension, order):
            factors = [line[r, :, j] / grid.spacing[j] ** r for j, r in enumerate(alpha)]
            jets.append(np.prod([f[:, local[:, j]] for j, f in enumerate(factors)], axis=0))
        for i, left in enumerate(jets[: len(b)]):
            load[index] += left.T @ b[i, row]
            for k, right in enumerate(jets[: len(b)]):
                matrix[np.ix_(index, index)] += left.T @ (C[i, k, row][:, None] * right)
    E = space.extension.toarray()
    return E @ matrix @ E.T, E @ load


def problem(dimension, degree, derivatives, seed=0, keep=12):
    """Space over a ball, a random batch on some of its cells, random coefficients."""
    rng = np.random.default_rng(seed)
    grid = unit_grid(*np.arange(dimension) + 6)
    states = ball_states(grid)
    space = SplineSpace.build(grid, degree, states)
    cells = rng.permutation(np.argwhere(states.state >= 0))[:keep]
    batch = TensorBatch(cells, np.sort(rng.uniform(size=3)), np.ones((len(cells), 3**dimension)))
    shape = (len(cells), 3**dimension)
    C = rng.standard_normal((derivatives, derivatives, *shape))
    return space, batch, C, rng.standard_normal((derivatives, *shape))


def assemble(space, batch, C, b, **options):
    assembler = Assembler(space, **options)
    assembler.add(batch, C, b)
    matrix, load = assembler.finish()
    return to_array(matrix), load


def finished(space, batch, C, b, symmetric):
    assembler = Assembler(space, symmetric)
    assembler.add(batch, C, b)
    return assembler.finish()[0]


def assert_close(found, expected):
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-11 * np.abs(other).max())


CASES = [(2, 1, 3), (2, 2, 6), (2, 3, 3), (2, 4, 6), (3, 1, 4), (3, 2, 4), (3, 2, 10)]


@pytest.mark.parametrize(("dimension", "degree", "derivatives"), CASES)
def test_symmetric_forms_equal_the_brute_force_sum(dimension, degree, derivatives):
    space, batch, C, b = problem(dimension, degree, derivatives)
    C = C + C.swapaxes(0, 1)
    expected = brute_force(space, as_points(batch), C, b)
    assert_close(assemble(space, batch, C, b), expected)
    assert_close(assemble(space, as_points(batch), C, b), expected)


@pytest.mark.parametrize(("dimension", "degree", "derivatives"), [(2, 2, 3), (2, 3, 6), (3, 1, 4)])
def test_forms_that_are_not_symmetric(dimension, degree, derivatives):
    space, batch, C, b = problem(dimension, degree, derivatives)
    expected = brute_force(space, as_points(batch), C, b)
    assert_close(assemble(space, batch, C, b, symmetric=False), expected)
    assert_close(assemble(space, as_points(batch), C, b, symmetric=False), expected)


def test_blocks_by_key_equal_the_full_array():
    space, batch, C, b = problem(2, 3, 3)
    keep = np.zeros((3, 3, 1, 1))
    keep[0, 0] = keep[0, 1] = keep[1, 0] = keep[2, 2] = 1
    C = (C + C.swapaxes(0, 1)) * keep
    blocks = {(0, 0): C[0, 0], (0, 1): C[0, 1], (2, 2): C[2, 2]}
    assert_close(
        assemble(space, batch, blocks, {1: b[1]}),
        brute_force(space, as_points(batch), C, b * [[[0]], [[1]], [[0]]]),
    )


def test_scattered_points_outside_the_tensor_grid():
    space, batch, C, b = problem(3, 2, 4)
    nodes = np.random.default_rng(3).uniform(size=(*batch.weights.shape, 3))
    points = PointBatch(batch.cells, nodes, batch.weights)
    C = C + C.swapaxes(0, 1)
    assert_close(assemble(space, points, C, b), brute_force(space, points, C, b))


@pytest.mark.parametrize(("dimension", "degree"), [(2, 3), (3, 2)])
def test_sparse_and_dense_matrices_agree(dimension, degree, monkeypatch):
    space, batch, C, b = problem(dimension, degree, 1 + dimension)
    for symmetric in (True, False):
        dense = assemble(space, batch, C, b, symmetric=symmetric)
        with monkeypatch.context() as patch:
            patch.setattr("solvers.assembly_reduction.DENSE", 0)
            mixed = assemble(space, batch, C, b, symmetric=symmetric)
            patch.setattr("solvers.assembly_reduction.DENSE_COUPLED", 0)
            patch.setattr("solvers.assembly_stencil.WORK", 1000)
            sparse = assemble(space, batch, C, b, symmetric=symmetric)
            rows = finished(space, batch, C, b, symmetric)
        assert_close(mixed, dense)
        assert_close(sparse, dense)
        assert all((np.diff(row) > 0).all() for row in np.split(rows.indices, rows.indptr[1:-1]))


def test_chunks_do_not_matter(monkeypatch):
    space, batch, C, b = problem(2, 4, 3, keep=30)
    whole = [assemble(space, each, C, b) for each in (batch, as_points(batch))]
    monkeypatch.setattr("solvers.assembly.ELEMENTS", 1)
    monkeypatch.setattr("solvers.assembly.PRODUCTS", 1)
    for each, expected in zip((batch, as_points(batch)), whole, strict=True):
        assert_close(assemble(space, each, C, b), expected)


def test_the_matrix_is_symmetric():
    space, batch, C, b = problem(2, 3, 6)
    matrix, _ = assemble(space, batch, C, b)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-13 * np.abs(matrix).max())


@pytest.mark.parametrize(("dimension", "degree"), [(2, 2), (2, 6), (3, 3)])
def test_mass_and_stiffness_of_a_box(dimension, degree):
    grid = unit_grid(*[3] * dimension)
    space = SplineSpace.build(grid, degree, full_states(grid))
    batch = gauss_batch(grid, np.argwhere(full_states(grid).state == 1), degree + 1)
    volume = float(np.prod(grid.spacing * grid.cells))
    mass, load = assemble(space, batch, {(0, 0): batch.weights}, {0: batch.weights})
    np.testing.assert_allclose(mass.sum(), volume, rtol=1e-12)
    np.testing.assert_allclose(mass.sum(axis=1), load, atol=1e-14)
    stiffness, _ = assemble(space, batch, {(k, k): batch.weights for k in range(1, dimension + 1)}, {})
    np.testing.assert_allclose(stiffness @ np.ones(space.n_dofs), 0.0, atol=1e-11)
    assert np.linalg.eigvalsh(stiffness)[0] > -1e-12


def test_two_batches_add():
    space, batch, C, b = problem(2, 3, 3, keep=20)
    assembler = Assembler(space)
    for rows in (slice(0, 8), slice(8, 20)):
        assembler.add(batch.take(rows), C[:, :, rows], b[:, rows])
    assembler.add(batch.take(slice(0, 0)), C[:, :, :0], b[:, :0])
    matrix, load = assembler.finish()
    assert_close((to_array(matrix), load), assemble(space, batch, C, b))
