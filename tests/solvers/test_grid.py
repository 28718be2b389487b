from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rfm.errors import DiscretizationError, GeometryError
from rfm.geometry import Box
from solvers.grid import Grid

lengths = st.floats(1e-3, 1e3)


@given(lengths, lengths, st.integers(1, 200))
def test_cover_is_aligned_with_the_box(a: float, b: float, n: int) -> None:
    box = Box((-1.0, 2.0), (-1.0 + a, 2.0 + b))
    grid = Grid.cover(box, n)
    np.testing.assert_allclose(grid.upper, box.upper, rtol=1e-14)
    assert grid.cells.max() == n
    # No direction is coarser than the longest one.
    assert grid.spacing.max() <= max(np.subtract(box.upper, box.lower)) / n * (1 + 1e-8)


def test_equal_sides_get_equal_cells_in_spite_of_rounding() -> None:
    grid = Grid.cover(Box((0.1, 0.1, 0.1), (0.1 + 0.7, 0.8, 0.8)), 7)
    assert grid.shape == (7, 7, 7)


def test_padding_widens_every_side() -> None:
    grid = Grid.cover(Box((0.0, 0.0), (1.0, 1.0)), 4, padding=0.5)
    np.testing.assert_allclose(grid.lower, [-0.5, -0.5])
    np.testing.assert_allclose(grid.upper, [1.5, 1.5])


def test_spacing_is_kept_and_the_box_covered() -> None:
    grid = Grid.with_spacing(Box((0.0, 0.0), (1.0, 0.55)), 0.25)
    assert grid.shape == (4, 3)
    np.testing.assert_allclose(grid.spacing, 0.25)


@given(st.integers(0, 2**32 - 1))
def test_locate_inverts_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = Grid([-1.0, 3.0, 0.0], [0.3, 0.2, 0.7], [5, 4, 3])
    cells = np.stack([rng.integers(0, n, 20) for n in grid.cells], axis=1)
    unit = rng.uniform(0.01, 0.99, (20, 1, 3))
    points = np.stack([x[:, 0] for x in grid.points(cells, unit)], axis=1)
    found, inside = grid.locate(points)
    np.testing.assert_array_equal(found, cells)
    np.testing.assert_allclose(inside, unit[:, 0], atol=1e-12)


def test_points_far_away_belong_to_the_nearest_cell() -> None:
    cells, unit = Grid([0.0, 0.0], [1.0, 1.0], [2, 2]).locate(np.array([[-1.0, 5.0]]))
    np.testing.assert_array_equal(cells, [[0, 1]])
    np.testing.assert_allclose(unit, [[-1.0, 4.0]])


def test_refined_covers_the_same_box() -> None:
    grid = Grid([0.0, 1.0], [0.5, 0.25], [3, 4])
    np.testing.assert_allclose(grid.refined(3).upper, grid.upper)
    assert grid.refined(3).cell_volume == pytest.approx(grid.cell_volume / 9)


@pytest.mark.parametrize(
    ("box", "error"),
    [
        (Box((0.0, -np.inf), (1.0, 1.0)), "unbounded"),
        (Box((0.0, 1.0), (1.0, 0.0)), "empty"),
    ],
)
def test_boxes_that_cannot_be_covered(box: Box, error: str) -> None:
    with pytest.raises(GeometryError, match=error):
        Grid.cover(box, 4)


def test_nonsense_is_refused() -> None:
    box = Box((0.0, 0.0), (1.0, 1.0))
    with pytest.raises(DiscretizationError, match="at least one cell"):
        Grid.cover(box, 0)
    with pytest.raises(DiscretizationError, match="spacing must be positive"):
        Grid.with_spacing(box, -1.0)
    with pytest.raises(DiscretizationError, match="positive spacings"):
        Grid([0.0, 0.0], [1.0, 0.0], [1, 1])
