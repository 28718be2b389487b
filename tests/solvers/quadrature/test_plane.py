"""Areas, perimeters and moments of plane domains against closed forms."""

from __future__ import annotations

from math import acos, cos, hypot, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus import functions as fn
from rfm.geometry import Box, Shape, disk, ellipse, function, half_plane, polygon, rectangle
from solvers.grid import Grid
from tests.solvers.quadrature.measures import check_rules, measure

ORDER = 10
OFFSET = (0.9, 0.3)
DISTANCE = hypot(*OFFSET)


def lens_area(big: float, small: float, distance: float) -> float:
    a = big**2 * acos((distance**2 + big**2 - small**2) / (2 * distance * big))
    b = small**2 * acos((distance**2 + small**2 - big**2) / (2 * distance * small))
    c = (
        (-distance + big + small)
        * (distance + big - small)
        * (distance - big + small)
        * (distance + big + small)
    )
    return a + b - 0.5 * sqrt(c)


def arc_inside(radius: float, other: float, distance: float) -> float:
    """Length of the part of a circle inside another disk."""
    return 2 * radius * acos((distance**2 + radius**2 - other**2) / (2 * distance * radius))


A, B = disk(center=(0.0, 0.0), radius=1.0).named("a"), disk(center=OFFSET, radius=0.8).named("b")
LENS, IN_B, IN_A = (
    lens_area(1.0, 0.8, DISTANCE),
    arc_inside(1.0, 0.8, DISTANCE),
    arc_inside(0.8, 1.0, DISTANCE),
)
ROUND = {
    "disk": (A, pi, 2 * pi),
    "annulus": (A - disk(center=(0.0, 0.0), radius=0.4), pi * 0.84, 2.8 * pi),
    "lens": (A & B, LENS, IN_A + IN_B),
    "union": (A | B, 1.64 * pi - LENS, 3.6 * pi - IN_A - IN_B),
    "moon": (A - B, pi - LENS, 2 * pi - IN_B + IN_A),
    "ellipse": (ellipse(center=(0.1, 0.2), semi_axes=(1.0, 0.7), angle=0.3), 0.7 * pi, None),
    "disk without quarter": (
        A
        - (
            half_plane(point=(0.0, 0.0), normal=(1.0, 0.2)) & half_plane(point=(0.0, 0.0), normal=(-0.2, 1.0))
        ),
        0.75 * pi,
        1.5 * pi + 2.0,
    ),
}


@pytest.mark.parametrize("name", ROUND)
@pytest.mark.parametrize("cells", [7, 12])
def test_round_domains(name: str, cells: int) -> None:
    domain, area, perimeter = ROUND[name]
    found = measure(domain, cells, ORDER)
    check_rules(found)
    assert found.rules.unresolved == 0.0
    assert found.volume == pytest.approx(area, rel=1e-12)
    if perimeter is not None:
        assert found.perimeter == pytest.approx(perimeter, rel=1e-10)
    assert found.volume_by_divergence == pytest.approx(area, rel=1e-10)
    assert found.flux_of_constants < 1e-10


def test_boundaries_are_attributed_to_their_surfaces() -> None:
    found = measure(A - B, 9, ORDER)
    assert found.of("a") == pytest.approx(2 * pi - IN_B, rel=1e-10)
    assert found.of("b") == pytest.approx(IN_A, rel=1e-10)


def test_moments_of_a_shifted_disk() -> None:
    x0, y0, r = 0.3, -0.2, 0.7
    found = measure(disk(center=(x0, y0), radius=r), 9, ORDER)
    area = pi * r * r
    assert found.integral(lambda x, y: x) == pytest.approx(x0 * area, rel=1e-12)
    assert found.integral(lambda x, y: x * y) == pytest.approx(x0 * y0 * area, rel=1e-12)
    assert found.integral(lambda x, y: x * x) == pytest.approx(area * (x0**2 + r * r / 4), rel=1e-12)
    assert found.integral(lambda x, y: (x - x0) ** 4 * (y - y0) ** 2) == pytest.approx(
        pi * r**8 / 64, rel=1e-12
    )


# Straight boundaries: any rule has to be exact, corners included.

SQUARE = ((-1.0, -0.5), (1.0, 0.5))


@settings(max_examples=15, deadline=None)
@given(st.floats(0.0, 6.3), st.integers(1, 7), st.floats(-0.5, 0.5))
def test_rotated_rectangles_are_exact(angle: float, cells: int, shift: float) -> None:
    domain = rectangle(min=SQUARE[0], max=SQUARE[1]).rotate(angle).move((shift, 0.1))
    # A little room: the tip of a nearly aligned rectangle would leave its own box by rounding.
    found = measure(domain, Grid.cover(domain.box, cells, padding=0.01), 2)
    assert found.volume == pytest.approx(2.0, rel=1e-13)
    assert found.perimeter == pytest.approx(6.0, rel=1e-13)
    centre = found.integral(lambda x, y: x) / 2.0
    assert centre == pytest.approx(shift, abs=1e-13)


@pytest.mark.parametrize("angle", [10.0**-k for k in range(4, 17)])
def test_nearly_aligned_rectangles(angle: float) -> None:
    # Edges cross grid lines at a tiny angle, down to where they lie on them but for rounding.
    grid = Grid([-1.5, -1.0], [0.25, 0.25], [12, 8])
    found = measure(rectangle(min=SQUARE[0], max=SQUARE[1]).rotate(angle), grid, 2)
    assert found.volume == pytest.approx(2.0, rel=1e-13)
    assert found.perimeter == pytest.approx(6.0, rel=1e-12)


STAR = [
    (cos(t) * r, sin(t) * r) for t, r in zip(np.linspace(0, 2 * pi, 11)[:-1], [0.4, 1.0] * 5, strict=True)
]
POLYGONS = {
    "star": STAR,
    "L": [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)],
    "wedge": [(0.0, 0.0), (3.0, 0.1), (3.0, 0.2)],
}


@pytest.mark.parametrize("name", POLYGONS)
@pytest.mark.parametrize("cells", [1, 3, 8])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_polygons_are_exact(name: str, cells: int, angle: float) -> None:
    vertices = np.array(POLYGONS[name])
    x, y = vertices.T
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    found = measure(polygon(vertices=POLYGONS[name]).rotate(angle), cells, 2)
    check_rules(found)
    assert found.volume == pytest.approx(area, rel=1e-12)
    assert found.perimeter == pytest.approx(np.hypot(x - np.roll(x, -1), y - np.roll(y, -1)).sum(), rel=1e-12)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 9))
def test_random_differences_obey_the_divergence_theorem(seed: int, cells: int) -> None:
    rng = np.random.default_rng(seed)
    domain: Shape = rectangle(min=(0.0, 0.0), max=(1.0, 0.8)).rotate(rng.uniform(0, 1))
    for _ in range(3):
        domain -= disk(center=tuple(rng.uniform(0, 1, 2)), radius=rng.uniform(0.05, 0.3))
    found = measure(domain, cells, 12)
    check_rules(found)
    assert found.flux_of_constants < 1e-7
    assert found.volume_by_divergence == pytest.approx(found.volume, abs=1e-7)


def test_formulas_that_are_no_polynomials() -> None:
    # In polar coordinates r < 0.6 + 0.1 cos(3 t), written with Chebyshev polynomials over r.
    def inside(x, y):
        r = fn.sqrt(x * x + y * y + 1e-300)
        c = x / r
        return 0.6 + 0.1 * (4.0 * c * c * c - 3.0 * c) - r

    shifted = function(lambda x, y: inside(x + 0.013, y + 0.011), Box((-0.75, -0.75), (0.75, 0.75)))
    grid = Grid([-0.75, -0.75], [0.1, 0.1], [15, 15])
    found = measure(shifted, grid, ORDER)
    check_rules(found)
    assert found.volume == pytest.approx(pi * (0.36 + 0.005), rel=1e-10)
    assert found.volume_by_divergence == pytest.approx(found.volume, rel=1e-9)


def test_a_smooth_function_on_the_boundary() -> None:
    found = measure(disk(center=(0.0, 0.0), radius=1.0), 8, ORDER)
    (batch,) = found.rules.boundary.values()
    x, y = batch.points(found.grid)
    assert (batch.weights * np.exp(x)).sum() == pytest.approx(2 * pi * np.i0(1.0), rel=1e-10)
    # Outward normals of the unit disk are the points.
    np.testing.assert_allclose(batch.normals[..., 0], x, atol=1e-13)
    np.testing.assert_allclose(batch.normals[..., 1], y, atol=1e-13)
