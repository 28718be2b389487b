"""Forms between two spline spaces, and scattered points as tensor nodes, against sums over all points."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.jets import multi_indices
from solvers.assembly import Assembler
from solvers.assembly_folding import parts
from solvers.cross_assembly import CrossAssembler, used_cells
from solvers.extension import extend, no_extension, touched
from solvers.point_tables import local_indices, node_table, spline_table
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.web import SplineSpace
from tests.solvers.synthetic import ball_states, to_array, unit_grid


def spaces(dimension, degree, basis):
    """A space over a ball and one of a degree less in its upper half."""
    grid = unit_grid(*np.arange(dimension) + 6)
    states = ball_states(grid)
    active = states.state >= 0
    upper = active.copy()
    upper[:3] = False
    inner = touched(states.state == 1, degree - 1)
    build = no_extension if basis == "b-spline" else extend
    collar = touched(upper, degree - 1)
    second = SplineSpace(grid, degree - 1, build(inner & collar, collar, degree - 1))
    return SplineSpace.build(grid, degree, states, basis), second, np.argwhere(active)


def scattered(cells, count, seed=0):
    rng = np.random.default_rng(seed)
    return PointBatch(
        cells, rng.uniform(size=(len(cells), count, cells.shape[1])), np.ones((len(cells), count))
    )


def brute_force(rows, columns, batch, blocks, order):
    """Dense sum over all points."""
    full = np.zeros((int(np.prod(rows.shape)), int(np.prod(columns.shape))))
    nodes = np.broadcast_to(node_table(batch), (*batch.weights.shape, batch.cells.shape[1]))
    left, right = (spline_table(space, nodes, order) for space in (rows, columns))
    first, second = (local_indices(space, batch.cells) for space in (rows, columns))
    for (a, b), values in blocks.items():
        element = np.einsum("nqi,nq,nqj->nij", left[a], values, right[b])
        np.add.at(full, (first[:, :, None], second[:, None, :]), element)
    return rows.extension @ full @ columns.extension.T


@pytest.mark.parametrize("basis", ["web-spline", "b-spline"])
@pytest.mark.parametrize(("dimension", "degree", "order"), [(2, 3, 2), (3, 2, 1)])
def test_between_two_spaces(dimension, degree, order, basis):
    """In the b-spline basis the cut cells are delicate and keep their points."""
    rows, columns, cells = spaces(dimension, degree, basis)
    rng = np.random.default_rng(1)
    count = len(multi_indices(dimension, order))
    keys = [(0, 0), (1, 0), (count - 1, 1), (2, count - 1)]
    half = len(cells) // 2
    tensor = TensorBatch(cells[:half], np.sort(rng.uniform(size=3)), np.ones((half, 3**dimension)))
    points = scattered(cells[half // 2 :], 5)
    assembler = CrossAssembler(rows, columns)
    expected = 0.0
    for batch in (tensor, points):
        blocks = {key: rng.standard_normal(batch.weights.shape) for key in keys}
        assembler.add(batch, blocks, {})
        expected = expected + brute_force(rows, columns, batch, blocks, order)
    found, load = assembler.finish()
    assert not len(load)
    np.testing.assert_allclose(to_array(found), expected, atol=1e-11 * np.abs(expected).max())


def test_nothing_in_common():
    rows, columns, _ = spaces(2, 2, "web-spline")
    far = np.argwhere(~used_cells(columns))
    assembler = CrossAssembler(rows, columns)
    batch = scattered(far, 3)
    assembler.add(batch, {(0, 0): batch.weights}, {})
    found, _ = assembler.finish()
    assert found.shape == (rows.n_dofs, columns.n_dofs)
    assert found.nnz == 0
    with pytest.raises(ValueError, match="no load"):
        assembler.add(batch, {}, {0: batch.weights})


def test_delicate_cells_keep_their_points():
    """The energy of a spline whose part in the domain is a sliver is positive, however small."""
    space, _, cells = spaces(2, 5, "b-spline")
    delicate = space.delicate_cells[tuple(cells.T)]
    corner = np.full(2, 1e-4)
    nodes = 1.0 - corner * np.random.default_rng(0).uniform(size=(delicate.sum(), 40, 2))
    batch = PointBatch(cells[delicate], nodes, np.ones(nodes.shape[:2]))
    assembler = Assembler(space)
    assembler.add(batch, {(0, 0): batch.weights}, {})
    found = to_array(assembler.finish()[0])
    diagonal = np.sqrt(found.diagonal())
    met = diagonal > 0
    scaled = found[np.ix_(met, met)] / np.outer(diagonal[met], diagonal[met])
    assert diagonal[met].min() < 1e-15
    assert np.abs(scaled).max() < 1 + 1e-12


def test_split_of_a_batch():
    cells = np.argwhere(np.ones((2, 2), dtype=bool))
    batch = scattered(cells, 7)
    delicate = np.array([[True, False], [False, False]])
    (kept, points, _, _), (rest, nodes, matrix, load) = parts(
        batch, {(0, 0): batch.weights}, {0: batch.weights}, delicate, 4
    )
    assert kept.tolist() == [[0, 0]]
    assert points.shape == (1, 7, 2)
    assert len(rest) == 3
    assert nodes.shape == (5,)
    np.testing.assert_allclose(matrix[0, 0].sum(axis=1), 7)
    np.testing.assert_allclose(load[0], matrix[0, 0])
    assert not list(parts(batch, {}, {}, delicate, 4))
