from __future__ import annotations

import numpy as np
import pytest

from rfm.geometry import ball, cylinder, disk
from solvers.classify import classify
from solvers.grid import Grid
from solvers.quadrature import domain_rules
from solvers.quadrature.batch import PointRule, TensorBatch
from solvers.quadrature.moments import fold
from tests.solvers.quadrature.measures import slope

ANNULUS = disk(center=(0.5, 0.5), radius=0.4) - disk(center=(0.5, 0.5), radius=0.1)
DRILLED = ball(center=(0.0, 0.0, 0.0), radius=1.0) - cylinder(
    center=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0), radius=0.3
)


def cut_rule(domain, cells: int, points: int) -> tuple[Grid, PointRule]:
    grid = Grid.cover(domain.box, cells)
    return grid, domain_rules(domain, classify(domain, grid), inner=1, cut=points).cut


def by_cell(rule: PointRule, values: np.ndarray) -> np.ndarray:
    return np.add.reduceat(rule.weights * values, rule.first[:-1])


@pytest.mark.parametrize("m", [1, 2, 5, 12])
def test_polynomials_are_reproduced_cell_by_cell(m: int) -> None:
    grid, rule = cut_rule(ANNULUS, 7, 6)
    folded = fold(rule, m)
    np.testing.assert_array_equal(folded.cells, rule.cells)
    # Polynomials in the unit coordinates of the cell, where they are of order one.
    x, y = folded.unit_points().T
    for a, b in ((0, 0), (m - 1, 0), (m - 1, m - 1), (0, m - 1)):
        expected = by_cell(rule, rule.nodes[:, 0] ** a * rule.nodes[:, 1] ** b)
        found = (folded.weights * (x**a * y**b)).sum(axis=1)
        np.testing.assert_allclose(found, expected, atol=1e-13 * grid.cell_volume)


def test_polynomials_in_space() -> None:
    grid, rule = cut_rule(DRILLED, 4, 4)
    folded = fold(rule, 4)
    x, y, z = folded.unit_points().T
    expected = by_cell(rule, rule.nodes[:, 0] ** 3 * rule.nodes[:, 1] ** 2 * rule.nodes[:, 2])
    np.testing.assert_allclose(
        (folded.weights * (x**3 * y**2 * z)).sum(axis=1), expected, atol=1e-13 * grid.cell_volume
    )


@pytest.mark.parametrize("m", [2, 3, 4])
def test_order_on_smooth_functions(m: int) -> None:
    def smooth(x, y):
        return np.exp(x) * np.sin(3.0 * y + 1.0)

    sizes, errors = np.array([16, 24, 32, 48, 64]), []
    for cells in sizes:
        grid, rule = cut_rule(ANNULUS, int(cells), 8)
        folded = fold(rule, m)
        expected = by_cell(rule, smooth(*rule.points(grid)))
        found = (folded.weights * smooth(*folded.points(grid))).sum(axis=1)
        # Relative to the measure of a cell: the error of interpolation.
        errors.append(np.sqrt(np.mean((found - expected) ** 2)) / grid.cell_volume)
    assert slope(sizes, np.array(errors)) == pytest.approx(m, abs=0.15)


def test_folding_a_padded_batch_is_the_same() -> None:
    _, rule = cut_rule(ANNULUS, 6, 3)
    np.testing.assert_allclose(fold(rule.padded(), 4).weights, fold(rule, 4).weights, atol=1e-16)


def test_nothing_folds_to_nothing() -> None:
    empty = PointRule(
        np.zeros((0, 2), dtype=np.int64), np.zeros(1, dtype=np.int64), np.zeros((0, 2)), np.zeros(0)
    )
    folded = fold(empty, 3)
    assert isinstance(folded, TensorBatch)
    assert folded.weights.shape == (0, 9)
