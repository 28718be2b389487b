from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from solvers.grid import Grid
from solvers.quadrature.batch import PointRule, TensorBatch
from solvers.quadrature.tensor import inner_rule

GRID = Grid([1.0, -2.0], [0.5, 0.25], [4, 6])


def random_rule(seed: int) -> tuple[PointRule, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    cells = np.stack(np.unravel_index(rng.permutation(24)[:9], (4, 6)), axis=1)
    rows = rng.integers(0, 9, rng.integers(0, 60))
    nodes, weights = rng.uniform(size=(len(rows), 2)), rng.uniform(0.1, 1, len(rows))
    return PointRule.gather(cells, rows, nodes, weights, nodes), cells, rows, nodes, weights


@given(st.integers(0, 2**32 - 1))
def test_gathering_keeps_every_point(seed: int) -> None:
    rule, cells, rows, nodes, weights = random_rule(seed)
    f = lambda x, y: np.sin(x) + y * y  # noqa: E731
    expected = weights * f(*(GRID.lower + GRID.spacing * (cells[rows] + nodes)).T)
    np.testing.assert_allclose(rule.weights @ f(*rule.points(GRID)), expected.sum(), rtol=1e-12, atol=1e-12)
    padded = rule.padded()
    np.testing.assert_allclose((padded.weights * f(*padded.points(GRID))).sum(), expected.sum(), atol=1e-12)
    assert (np.diff(rule.counts) >= 0).all()


@given(st.integers(0, 2**32 - 1), st.integers(1, 80))
def test_chunks_are_the_whole(seed: int, limit: int) -> None:
    rule, *_ = random_rule(seed)
    chunks = list(rule.chunks(limit))
    assert sum(len(chunk) for chunk in chunks) == len(rule)
    np.testing.assert_array_equal(
        np.concatenate([rule.cells[:0], *(chunk.cells for chunk in chunks)]), rule.cells
    )
    assert sum(np.count_nonzero(chunk.weights) for chunk in chunks) == rule.size
    for chunk in chunks:
        assert chunk.size <= max(limit, chunk.weights.shape[1])
        # Padding repeats a node of the same cell.
        assert chunk.nodes.shape == chunk.normals.shape == (*chunk.weights.shape, 2)


def test_take_accepts_slices_and_numbers() -> None:
    rule, *_ = random_rule(3)
    some = rule.take(np.array([1, 3]))
    np.testing.assert_array_equal(some.cells, rule.cells[[1, 3]])
    np.testing.assert_array_equal(
        some.weights, np.concatenate([rule.weights[rule.first[i] : rule.first[i + 1]] for i in (1, 3)])
    )
    np.testing.assert_array_equal(rule.take(slice(2, 4)).cells, rule.cells[2:4])
    np.testing.assert_array_equal(rule.padded().take(slice(2, 4)).cells, rule.cells[2:4])


def test_tensor_points_are_in_c_order() -> None:
    batch = TensorBatch(np.array([[1, 2]]), np.array([0.25, 0.75]), np.ones((1, 4)))
    x, y = batch.points(GRID)
    np.testing.assert_allclose(x, [[1.625, 1.625, 1.875, 1.875]])
    np.testing.assert_allclose(y, [[-1.4375, -1.3125, -1.4375, -1.3125]])


def test_inner_rule_is_exact_to_its_degree() -> None:
    cells = np.argwhere(np.ones(GRID.shape))
    batch = inner_rule(GRID, cells, 3)
    x, y = batch.points(GRID)
    exact = (3.0**6 - 1.0) / 6 * (2.0**5 - 0.5**5) / 5
    np.testing.assert_allclose(
        sum((b.weights * b.points(GRID)[0] ** 5 * b.points(GRID)[1] ** 4).sum() for b in batch.chunks(20)),
        exact,
        rtol=1e-13,
    )
    assert batch.size == x.size == y.size == 24 * 9
