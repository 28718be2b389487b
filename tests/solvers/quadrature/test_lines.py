from __future__ import annotations

import numpy as np
import pytest

from rfm.geometry import ball, cylinder, disk
from solvers.classify import classify
from solvers.grid import Grid
from solvers.quadrature import domain_rules
from solvers.quadrature.lines import LineRule, Lines
from solvers.quadrature.moments import fold

ANNULUS = disk(center=(0.5, 0.5), radius=0.4) - disk(center=(0.5, 0.5), radius=0.1)
DRILLED = ball(center=(0.0, 0.0, 0.0), radius=1.0) - cylinder(
    center=(0.0, 0.0, 0.0), axis=(0.0, 1.0, 2.0), radius=0.3
)


def line_rule(domain, cells: int, points: int) -> LineRule:
    grid = Grid.cover(domain.box, cells)
    rule = domain_rules(domain, classify(domain, grid), inner=1, cut=points).cut
    assert isinstance(rule, LineRule)
    return rule


@pytest.mark.parametrize(("domain", "cells"), [(ANNULUS, 6), (DRILLED, 4)])
@pytest.mark.parametrize(("points", "m"), [(4, 3), (3, 8), (5, 6)])
def test_moments_of_lines_are_those_of_their_points(domain, cells: int, points: int, m: int) -> None:
    # 3 points a line are too few for degree 7: the rule is folded as it is, not as it should be.
    rule = line_rule(domain, cells, points)
    on_points = rule.on_points()
    expected = fold(on_points, m).weights
    np.testing.assert_allclose(fold(rule, m).weights, expected, atol=1e-14 * np.abs(expected).max())
    assert (rule.size, len(rule)) == (on_points.size, len(on_points))
    np.testing.assert_array_equal(rule.counts, on_points.counts)
    np.testing.assert_array_equal(rule.weights, on_points.weights)
    np.testing.assert_array_equal(rule.nodes, on_points.nodes)


def test_some_cells_and_chunks() -> None:
    rule = line_rule(ANNULUS, 6, 3)
    some = np.array([0, 3, 4])
    found, expected = rule.take(some).on_points(), rule.on_points().take(some)
    np.testing.assert_array_equal(found.cells, expected.cells)
    np.testing.assert_array_equal(found.nodes, expected.nodes)
    np.testing.assert_array_equal(found.weights, expected.weights)
    assert len(rule.take(np.zeros(0, dtype=np.int64))) == 0
    for found, expected in zip(rule.chunks(100), rule.on_points().chunks(100), strict=True):
        np.testing.assert_array_equal(found.cells, expected.cells)
        np.testing.assert_array_equal(found.weights, expected.weights)


def test_points_of_lines() -> None:
    lines = Lines(
        np.array([[0.0, 0.5], [0.25, 0.5]]),
        np.array([0, 1], dtype=np.int8),
        np.array([1.0, 0.5]),
        np.array([2.0, 3.0]),
    )
    nodes, weights = lines.points(1)
    np.testing.assert_allclose(nodes, [[0.5, 0.5], [0.25, 0.75]])
    np.testing.assert_allclose(weights, [2.0, 3.0])
