from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus import functions as fn
from rfm.errors import GeometryError
from rfm.geometry import Box, ball, cylinder, disk, function, half_plane, rectangle, strip
from rfm.geometry.boundaries.curve import curve
from rfm.geometry.shape import Shape
from solvers.classify import CUT, INNER, OUTER, classify
from solvers.grid import Grid
from solvers.quadrature import domain_rules


def sampled(domain: Shape, grid: Grid, per_side: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """Whether samples of each cell lie inside and outside."""
    axes = [
        lo + h * (np.arange(n * per_side) + 0.5) / per_side
        for lo, h, n in zip(grid.lower, grid.spacing, grid.cells, strict=True)
    ]
    value = domain.membership(*np.meshgrid(*axes, indexing="ij"))
    shape = [size for n in grid.cells for size in (n, per_side)]
    blocks = value.reshape(shape)
    inner_axes = tuple(range(1, 2 * grid.dimension, 2))
    return (blocks > 0).any(axis=inner_axes), (blocks < 0).any(axis=inner_axes)


@settings(max_examples=25, deadline=None)
@given(st.floats(0.05, 0.6), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.integers(2, 12))
def test_states_agree_with_samples(radius: float, x: float, y: float, n: int) -> None:
    domain = rectangle(min=(0.0, 0.0), max=(1.0, 1.0)) - disk(center=(x, y), radius=radius)
    grid = Grid.cover(Box((-0.1, -0.1), (1.1, 1.13)), n)
    state = classify(domain, grid).state
    inside, outside = sampled(domain, grid)
    assert not outside[state == INNER].any()
    assert not inside[state == OUTER].any()


def test_cut_cells_are_really_cut() -> None:
    domain = disk(center=(0.0, 0.0), radius=1.0)
    grid = Grid.cover(Box((-1.1, -1.1), (1.1, 1.1)), 20)
    state = classify(domain, grid).state
    inside, outside = sampled(domain, grid, 40)
    both = inside & outside
    # Samples may miss a thin sliver, but not many.
    assert (state == CUT)[both].all()
    assert np.count_nonzero((state == CUT) & ~both) <= 4


@pytest.mark.parametrize("width", [1e-2, 1e-5, 1e-9])
def test_a_strip_thinner_than_a_cell_is_found(width: float) -> None:
    domain = strip(point=(0.513, 0.0), normal=(1.0, 0.3), width=width) & rectangle(
        min=(0.0, 0.0), max=(1.0, 1.0)
    )
    grid = Grid.cover(Box((0.0, 0.0), (1.0, 1.0)), 8)
    cells = classify(domain, grid).cut_cells
    assert set(cells[:, 1]) == set(range(8))


def test_a_hole_smaller_than_a_cell_is_found() -> None:
    domain = rectangle(min=(0.0, 0.0), max=(1.0, 1.0)) - disk(center=(0.43, 0.57), radius=1e-4)
    result = classify(domain, Grid.cover(domain.box, 5))
    np.testing.assert_array_equal(result.cut_cells, [[2, 2]])
    assert result.inner_cells.shape == (24, 2)


def test_a_boundary_along_the_grid_cuts_nothing() -> None:
    domain = rectangle(min=(0.0, 0.0), max=(1.0, 1.0))
    result = classify(domain, Grid.cover(Box((-0.5, -0.5), (1.5, 1.5)), 8))
    assert len(result.cut_cells) == 0
    assert len(result.inner_cells) == 16
    # The touching cells are the rim.
    assert len(result.touching_cells) == 12
    assert result.active.shape == (12, 4)
    np.testing.assert_array_equal(np.bincount(result.active.sum(axis=1)), [0, 8, 4])


def test_only_surfaces_that_matter_are_active() -> None:
    # The line continues through the disk but only bounds the domain outside of it.
    domain = disk(center=(0.0, 0.0), radius=0.5) | (
        half_plane(point=(0.0, 0.013), normal=(0.0, 1.0)).named("line")
        & rectangle(min=(-1.0, -1.0), max=(1.0, 1.0))
    )
    result = classify(domain, Grid([-1.1, -1.1], [0.1, 0.1], [22, 22]))
    line = [s.name for s in domain.surfaces].index("line")
    with_line = result.cut_cells[result.active[: len(result.cut_cells), line]]
    np.testing.assert_array_equal(with_line[:, 1], 11)
    np.testing.assert_array_equal(with_line[:, 0], [1, 2, 3, 4, 5, 6, 15, 16, 17, 18, 19, 20])


def test_blocks_and_cells_agree() -> None:
    domain = ball(center=(0.0, 0.0, 0.0), radius=1.0) - cylinder(
        center=(0.0, 0.0, 0.0), axis=(1.0, 2.0, 3.0), radius=0.3
    )
    fine = classify(domain, Grid.cover(domain.box, 36)).state
    coarse = classify(domain, Grid.cover(domain.box, 12)).state
    groups = fine.reshape(12, 3, 12, 3, 12, 3).transpose(0, 2, 4, 1, 3, 5).reshape(12, 12, 12, 27)
    np.testing.assert_array_equal((groups == INNER).all(axis=-1), coarse == INNER)
    np.testing.assert_array_equal((groups == OUTER).all(axis=-1), coarse == OUTER)


def test_formulas_that_are_no_polynomials() -> None:
    field = lambda x, y: fn.cos(3.0 * x) * fn.exp(-y * y) - 0.4  # noqa: E731
    domain = function(field, Box((-0.6, -1.5), (0.6, 1.5)))
    grid = Grid.cover(Box((-0.6, -1.5), (0.6, 1.5)), 15)
    state = classify(domain, grid).state
    inside, outside = sampled(domain, grid)
    assert not outside[state == INNER].any()
    assert not inside[state == OUTER].any()
    assert np.count_nonzero((state == CUT) & ~(inside & outside)) <= 4


@pytest.mark.parametrize("sharpness", [60.0, 800.0, 5000.0])
def test_a_hole_of_a_formula_inside_one_cell_is_found(sharpness: float) -> None:
    # The cell is halved until the interpolants are accurate; its last part lies inside, the hole in the first one.
    def field(x, y):
        return 0.5 - fn.exp(-sharpness * ((x - 0.2) * (x - 0.2) + (y - 0.3) * (y - 0.3)))

    domain = function(field, Box((0.0, 0.0), (2.0, 1.0)))
    classified = classify(domain, Grid([0.0, 0.0], [1.0, 1.0], [2, 1]))
    np.testing.assert_array_equal(classified.state, [[CUT], [INNER]])
    cut = domain_rules(domain, classified, inner=1, cut=8).cut
    assert 1.0 - cut.weights.sum() == pytest.approx(np.pi * np.log(2.0) / sharpness, rel=1e-6)


def test_boxes_are_halved_near_the_boundary_only() -> None:
    # The joint function of a curve bends along lines through the whole inside.
    leaf = curve((0, 0), [{"bezier": [(0.6, -0.8), (1.2, 0)]}, {"bezier": [(0.6, 1.0), (0, 0)]}])
    classified = classify(leaf, Grid.cover(leaf.box, 8))
    deepest = sum(int((boxes.depth == boxes.depth.max()).sum()) for boxes in classified.boxes)
    assert deepest < 400
    rules = domain_rules(leaf, classified, inner=4, cut=6)
    assert rules.inner.weights.sum() + rules.cut.weights.sum() == pytest.approx(0.72, rel=1e-7)


def test_an_empty_domain_says_so() -> None:
    domain = disk(center=(0.0, 0.0), radius=1.0) & disk(center=(3.0, 0.0), radius=1.0)
    with pytest.raises(GeometryError, match="empty"):
        classify(domain, Grid([-1.0, -1.0], [0.5, 0.5], [10, 4]))
    with pytest.raises(GeometryError, match="outside the grid"):
        classify(disk(center=(9.0, 0.0), radius=1.0), Grid([-1.0, -1.0], [0.5, 0.5], [4, 4]))


def test_dimensions_must_agree() -> None:
    with pytest.raises(GeometryError, match="2D domain needs a 2D grid"):
        classify(disk(center=(0.0, 0.0), radius=1.0), Grid([0.0] * 3, [1.0] * 3, [2] * 3))


def test_a_formula_that_is_not_finite_says_where() -> None:
    domain = function(lambda x, y: 1.0 - x * x - fn.log(y), Box((-1.0, -1.0), (1.0, 1.0)))
    with pytest.raises(GeometryError, match="not finite at"):
        classify(domain, Grid([-1.0, -1.0], [0.25, 0.25], [8, 8]))
