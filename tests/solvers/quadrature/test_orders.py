"""Measured orders: n points on each piece integrate with error h^(2n)."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from rfm.geometry import ball, disk, half_plane
from solvers.grid import Grid
from tests.solvers.quadrature.measures import measure, slope

BAND = 0.15
CASES = [
    (2, n, (12, 16, 24, 32, 48), 24) for n in (1, 2, 3)
] + [
    pytest.param(3, n, (10, 14, 20, 28), 4, marks=pytest.mark.slow) for n in (1, 2, 3)
]  # fmt: skip
EXACT = {2: (disk, pi, 2 * pi), 3: (ball, 4 / 3 * pi, 4 * pi)}


def mean_errors(dimension: int, cells: int, points: int, shifts: int) -> tuple[float, float]:
    """Mean error of volume and boundary over random positions of the grid."""
    rng = np.random.default_rng(2)
    shape, volume, boundary = EXACT[dimension]
    grid = Grid([-1.5] * dimension, [3 / cells] * dimension, [cells] * dimension)
    errors = []
    for _ in range(shifts):
        center = tuple(rng.uniform(-1.5, 1.5, dimension) / cells)
        found = measure(shape(center=center, radius=1.0), grid, points)
        errors.append((abs(found.volume - volume), abs(found.perimeter - boundary)))
    first, second = np.mean(errors, axis=0)
    return float(first), float(second)


@pytest.mark.parametrize(("dimension", "points", "sizes", "shifts"), CASES)
def test_order_of_volume_and_boundary(
    dimension: int, points: int, sizes: tuple[int, ...], shifts: int
) -> None:
    errors = np.array([mean_errors(dimension, cells, points, shifts) for cells in sizes])
    orders = [slope(np.array(sizes), errors[:, i]) for i in range(2)]
    assert orders == pytest.approx([2 * points] * 2, abs=BAND)


@pytest.mark.parametrize("angle", [0.2, 1.1])
def test_order_at_corners(angle: float) -> None:
    # A sector of 100 degrees: without a break at the corner the order would drop to two.
    a, b = angle, angle + 100 / 180 * pi
    sector = (
        disk(center=(0.0, 0.0), radius=1.0)
        & half_plane(point=(0.0, 0.0), normal=(-np.sin(a), np.cos(a)))
        & half_plane(point=(0.0, 0.0), normal=(np.sin(b), -np.cos(b)))
    )
    sizes = (12, 16, 24, 32)
    rng = np.random.default_rng(5)
    errors = []
    for cells in sizes:
        grid = Grid([-1.5, -1.5], [3 / cells] * 2, [cells] * 2)
        shifts = rng.uniform(-1.5, 1.5, (12, 2)) / cells
        errors.append(
            np.mean([abs(measure(sector.move(tuple(s)), grid, 2).volume - 50 / 180 * pi) for s in shifts])
        )
    assert slope(np.array(sizes), np.array(errors)) == pytest.approx(4, abs=0.3)
