"""Which cells count as smooth: analytic functions do, kinks and poles do not, however weak the kink."""

from __future__ import annotations

import numpy as np
import pytest

from solvers.quadrature.pieces import gauss
from solvers.smoothness import rough_cells

NODES, _ = gauss(6)


def rough(function, dimension=2, nodes=NODES):
    """Whether a function of the unit cell counts as rough."""
    coords = np.meshgrid(*[nodes] * dimension, indexing="ij")
    with np.errstate(all="ignore"):
        values = np.broadcast_to(function(*coords), coords[0].shape)
    return bool(rough_cells([values.reshape(-1, 1)], nodes, dimension)[0])


@pytest.mark.parametrize(
    "function",
    [
        lambda x, y: 1.0 + 0 * x,
        lambda x, y: np.exp(x) * np.sin(y + 0.4),
        lambda x, y: (x - 0.4 + 0.3 * x * x) ** 2 * (1 + y),  # a weight squared
        lambda x, y: ((x + 1) ** 2 + (y + 2) ** 2) ** 2,
        lambda x, y: (1 - x * y / 4) ** 4,
    ],
)
def test_smooth_functions(function):
    assert not rough(function)


@pytest.mark.parametrize("size", [1e-2, 1e-1, 1.0])
@pytest.mark.parametrize("place", [0.2, 0.5, 0.63, 0.8])
def test_kinks(size, place):
    assert rough(lambda x, y: 1 + size * np.abs(x - place) + 0 * y)
    assert rough(lambda x, y: 1 + y / 2 + 2 * size * np.maximum(y - place, 0) + 0 * x)


def test_a_jump_in_the_second_derivative():
    assert rough(lambda x, y: 1 + np.maximum(x - 0.5, 0) ** 2 + 0 * y)


def test_what_is_not_finite():
    assert rough(lambda x, y: np.where(x > 0.9, np.nan, 1.0))
    assert rough(lambda x, y: np.where(y > 0.9, np.inf, x))


def test_cells_are_judged_one_by_one():
    smooth, kinked = np.ones((36, 1)), np.abs(np.repeat(NODES, 6) - 0.5)[:, None]
    values = np.concatenate([smooth, kinked, 2 * smooth], axis=1)
    np.testing.assert_array_equal(rough_cells([values, values[:, ::-1]], NODES, 2), [False, True, False])


def test_few_nodes_have_no_decay_to_look_at():
    nodes, _ = gauss(4)
    assert rough(lambda x: np.exp(2 * x), 1, nodes)
    assert not rough(lambda x: np.exp(2 * x), 1, gauss(9)[0])
