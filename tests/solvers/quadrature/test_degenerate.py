"""Degenerate geometry on purpose: alignment with the grid, slivers, thin and tiny things, tangency."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from rfm.geometry import Box, ball, box, cone, cylinder, disk, half_plane, half_space, rectangle, strip
from solvers.classify import classify
from solvers.grid import Grid
from solvers.quadrature import domain_rules
from tests.solvers.quadrature.measures import check_rules, measure

UNIT = ((0.0, 0.0), (1.0, 1.0))
EXPONENTS = range(1, 13)


def test_a_boundary_along_the_grid_is_found_once() -> None:
    domain = rectangle(min=(0.25, 0.25), max=(0.75, 0.75)).named("plate")
    found = measure(domain, Grid.cover(Box(*UNIT), 8), 3)
    assert found.rules.cut.size == 0
    assert found.volume == pytest.approx(0.25, rel=1e-14)
    for side in ("left", "right", "bottom", "top"):
        assert found.of(f"plate.{side}") == pytest.approx(0.5, rel=1e-14)
    # It belongs to the cells inside.
    state = classify(domain, found.grid).state
    for batch in found.rules.boundary.values():
        assert (state[tuple(batch.cells.T)] == 1).all()


def test_the_complement_has_the_same_boundary_with_opposite_normals() -> None:
    hole = rectangle(min=(0.25, 0.25), max=(0.75, 0.75)).named("hole")
    found = measure(rectangle(min=UNIT[0], max=UNIT[1]) - hole, 8, 3)
    assert found.volume == pytest.approx(0.75, rel=1e-14)
    assert found.perimeter == pytest.approx(6.0, rel=1e-14)
    assert found.of("hole.left") == pytest.approx(0.5, rel=1e-14)
    assert found.flux_of_constants < 1e-14
    assert found.volume_by_divergence == pytest.approx(0.75, rel=1e-14)


def test_aligned_boxes_in_space() -> None:
    domain = box(min=(0.0, 0.0, 0.0), max=(1.0, 1.0, 1.0)) - box(min=(0.5, 0.5, 0.5), max=(1.0, 1.0, 1.0))
    found = measure(domain, 4, 2)
    assert found.rules.cut.size == 0
    assert found.volume == pytest.approx(0.875, rel=1e-14)
    assert found.perimeter == pytest.approx(6.0, rel=1e-14)
    assert found.volume_by_divergence == pytest.approx(0.875, rel=1e-13)


def test_coincident_surfaces_of_two_shapes() -> None:
    left, right = rectangle(min=(0.0, 0.0), max=(0.53, 1.0)), rectangle(min=(0.53, 0.0), max=(1.0, 1.0))
    together = measure(left | right, 5, 2)
    assert together.volume == pytest.approx(1.0, rel=1e-13)
    assert together.perimeter == pytest.approx(4.0, rel=1e-13)
    same_top = measure(
        rectangle(min=UNIT[0], max=UNIT[1]) & rectangle(min=(0.21, 0.13), max=(0.77, 1.0)), 5, 2
    )
    assert same_top.perimeter == pytest.approx(2 * (0.56 + 0.87), rel=1e-13)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_slivers_of_a_half_plane(exponent: int) -> None:
    # The domain ends a sliver beyond, or short of, a grid line.
    sliver = 10.0**-exponent
    for edge in (0.5 + 0.1 * sliver, 0.5 - 0.1 * sliver):
        domain = rectangle(min=UNIT[0], max=UNIT[1]) & half_plane(
            point=(edge, 0.0), normal=(-1.0, 0.0)
        ).named("cut")
        found = measure(domain, 10, 3)
        assert found.volume == pytest.approx(edge, rel=1e-13)
        assert found.of("cut") == pytest.approx(1.0, rel=1e-13)
        assert found.volume_by_divergence == pytest.approx(edge, rel=1e-13)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_slivers_of_a_disk(exponent: int) -> None:
    radius = 0.4 + 0.1 * 10.0**-exponent
    grid = Grid([-0.5, -0.5], [0.1, 0.1], [10, 10])
    found = measure(disk(center=(0.0, 0.0), radius=radius), grid, 10)
    check_rules(found)
    assert found.volume == pytest.approx(pi * radius**2, rel=1e-12)
    # The arcs beyond the grid line are known to rounding of the depth of the sliver.
    arcs = 8 * sqrt(2 * 0.4 * (radius - 0.4))
    assert found.perimeter == pytest.approx(
        2 * pi * radius, rel=1e-10, abs=arcs * 0.1 * 10.0 ** (exponent - 12)
    )


@pytest.mark.parametrize("exponent", [1, 4, 8, 12])
def test_slivers_in_space(exponent: int) -> None:
    edge = 0.5 + 0.25 * 10.0**-exponent
    cube = box(min=(0.0, 0.0, 0.0), max=(1.0, 1.0, 1.0))
    found = measure(cube & half_space(point=(0.0, edge, 0.0), normal=(0.0, -1.0, 0.0)).named("cut"), 4, 3)
    assert found.volume == pytest.approx(edge, rel=1e-13)
    assert found.of("cut") == pytest.approx(1.0, rel=1e-13)
    radius = 0.5 + 0.1 * 10.0**-exponent
    grid = Grid([-0.75] * 3, [0.25] * 3, [6] * 3)
    found = measure(ball(center=(0.0, 0.0, 0.0), radius=radius), grid, 8)
    assert found.volume == pytest.approx(4 / 3 * pi * radius**3, rel=1e-9)
    assert found.perimeter == pytest.approx(4 * pi * radius**2, rel=1e-7)


@pytest.mark.parametrize("radius", [1e-1, 1e-3, 1e-6])
def test_a_hole_smaller_than_a_cell(radius: float) -> None:
    domain = rectangle(min=UNIT[0], max=UNIT[1]) - disk(center=(0.43, 0.57), radius=radius).named("hole")
    found = measure(domain, 4, 10)
    assert 1.0 - found.volume == pytest.approx(pi * radius**2, rel=1e-7, abs=1e-14)
    # The function of a tiny disk is large at the corners of the cell: its zero is known less well.
    assert found.of("hole") == pytest.approx(2 * pi * radius, rel=1e-8 + 1e-12 / radius)


def test_a_cavity_smaller_than_a_cell() -> None:
    found = measure(
        box(min=(0.0, 0.0, 0.0), max=(1.0, 1.0, 1.0)) - ball(center=(0.3, 0.4, 0.55), radius=0.05), 2, 7
    )
    assert 1.0 - found.volume == pytest.approx(4 / 3 * pi * 0.05**3, rel=1e-6)
    assert found.perimeter == pytest.approx(6 + 4 * pi * 0.05**2, rel=1e-8)


@pytest.mark.parametrize("width", [1e-2, 1e-5, 1e-9])
def test_a_strip_thinner_than_a_cell(width: float) -> None:
    domain = rectangle(min=(-1.0, -width / 2), max=(1.0, width / 2)).rotate(0.3)
    found = measure(domain, Grid([-1.0, -1.0], [0.4, 0.4], [5, 5]), 2)
    assert found.volume == pytest.approx(2 * width, rel=1e-6 if width < 1e-8 else 1e-9)
    assert found.perimeter == pytest.approx(4 + 2 * width, rel=1e-12)


def test_a_whole_domain_inside_one_cell() -> None:
    found = measure(disk(center=(0.51, 0.47), radius=0.1), Grid([0.0, 0.0], [1.0, 1.0], [1, 1]), 10)
    assert found.volume == pytest.approx(pi * 0.01, rel=1e-8)
    assert found.perimeter == pytest.approx(pi * 0.2, rel=1e-8)


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_tangent_circles(angle: float) -> None:
    outside = disk(center=(-0.5, 0.0), radius=0.5) | disk(center=(0.5, 0.0), radius=0.5)
    inside = disk(center=(0.0, 0.0), radius=1.0) - disk(center=(0.5, 0.0), radius=0.5)
    for domain, area, perimeter in ((outside, pi / 2, 2 * pi), (inside, 0.75 * pi, 3 * pi)):
        found = measure(domain.rotate(angle), 9, 10)
        assert found.volume == pytest.approx(area, rel=1e-9)
        assert found.perimeter == pytest.approx(perimeter, rel=1e-7)


def test_circles_that_cross_at_right_angles_along_the_axes() -> None:
    # At the corners no direction serves both circles: the recursion ends at its depth and says so.
    found = measure(disk(center=(0.0, 0.0), radius=1.0) & disk(center=(1.0, 1.0), radius=1.0),
                    Grid([-0.4, -0.3], [0.5, 0.5], [4, 4]), 12)  # fmt: skip
    assert found.volume == pytest.approx(pi / 2 - 1, abs=1e-10)
    assert found.perimeter == pytest.approx(pi, abs=1e-6)
    assert found.rules.unresolved < 1e-7


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-7])
def test_shells_thinner_than_a_cell(gap: float) -> None:
    # Nearly parallel surfaces that never meet must not be halved down to their distance.
    shell = ball(center=(0.0, 0.0, 0.0), radius=1.0) - ball(center=(0.0, 0.0, 0.0), radius=1.0 - gap)
    found = measure(shell, 5, 6)
    assert found.rules.unresolved == 0.0
    assert found.volume == pytest.approx(4 / 3 * pi * (3 * gap - 3 * gap**2 + gap**3), rel=1e-7)
    assert found.perimeter == pytest.approx(4 * pi * (1 + (1 - gap) ** 2), rel=1e-6)
    assert found.rules.cut.size < 200_000


def test_tangent_spheres() -> None:
    found = measure(ball(center=(0.0, 0.0, 0.0), radius=1.0) - ball(center=(0.1, 0.2, 0.2), radius=0.7), 6, 6)
    assert found.volume == pytest.approx(4 / 3 * pi * (1 - 0.343), rel=1e-6)
    assert found.perimeter == pytest.approx(4 * pi * 1.49, rel=1e-4)
    assert found.rules.unresolved < 1e-5


def test_a_cylinder_that_touches_the_grid_along_lines() -> None:
    domain = cylinder(center=(0.0, 0.0, 0.0), axis=(0.0, 0.0, 1.0), radius=0.5, height=1.0)
    found = measure(domain, 3, 8)
    assert found.rules.unresolved == 0.0
    assert found.volume == pytest.approx(pi / 4, rel=1e-9)
    assert found.perimeter == pytest.approx(pi + pi / 2, rel=1e-7)


def test_grids_that_cut_the_domain_off() -> None:
    # The grid covers a quarter of the disk: the faces of the grid are no boundary of the domain.
    found = measure(disk(center=(0.0, 0.0), radius=1.0), Grid([0.0, 0.0], [0.25, 0.25], [4, 4]), 8)
    assert found.volume == pytest.approx(pi / 4, rel=1e-9)
    assert found.perimeter == pytest.approx(pi / 2, rel=1e-8)


def test_auxiliary_surfaces_bear_no_boundary() -> None:
    # A cone is one nappe of a quadric, chosen by a plane through the apex.
    domain = cone(apex=(0.0, 0.0, 1.0), axis=(0.0, 0.0, -1.0), radius=0.5, height=1.0)
    found = measure(domain, 4, 6)
    assert found.volume == pytest.approx(pi * 0.25 / 3, rel=1e-6)
    assert found.perimeter == pytest.approx(pi * 0.25 + pi * 0.5 * sqrt(1.25), rel=1e-3)


def test_strip_across_everything() -> None:
    domain = strip(point=(0.5, 0.5), normal=(1.0, 1.0), width=0.2) & rectangle(min=UNIT[0], max=UNIT[1])
    found = measure(domain, 5, 2)
    assert found.volume == pytest.approx(1 - (1 - 0.1 * sqrt(2)) ** 2, rel=1e-12)


def test_no_boundary_rule_where_there_is_no_boundary() -> None:
    domain = disk(center=(0.5, 0.5), radius=5.0)
    grid = Grid.cover(Box(*UNIT), 3)
    rules = domain_rules(domain, classify(domain, grid), inner=2, cut=2)
    assert rules.boundary == {}
    assert rules.cut.size == 0
    assert rules.inner.weights.sum() == pytest.approx(1.0)
    assert np.array_equal(rules.inner.cells, np.argwhere(np.ones((3, 3))))
