"""Volumes, areas and moments of solids against closed forms."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.geometry import ball, box, cylinder, torus
from rfm.geometry.shape import Shape
from tests.solvers.quadrature.measures import check_rules, measure

ORIGIN = (0.0, 0.0, 0.0)
BALL = ball(center=ORIGIN, radius=1.0).named("ball")
CUBE = box(min=(-1.0, -1.0, -1.0), max=(1.0, 1.0, 1.0))
RING = torus(center=ORIGIN, axis=(0.0, 0.0, 1.0), major_radius=1.0, minor_radius=0.4)
HALF = sqrt(1.0 - 0.09)
LENS = 5 * pi / 12


def drilled(axis: tuple[float, float, float]) -> Shape:
    return BALL - cylinder(center=(0.0, 0.0, 0.0), axis=axis, radius=0.3)


SOLIDS = {
    "ball": (BALL, 4 / 3 * pi, 4 * pi),
    "shell": (BALL - ball(center=(0.01, 0.02, 0.03), radius=0.5), 4 / 3 * pi * 0.875, 5 * pi),
    "drilled": (drilled((0.0, 0.0, 1.0)), 4 / 3 * pi * HALF**3, 4 * pi * HALF + 1.2 * pi * HALF),
    "lens": (BALL & ball(center=(0.36, 0.48, 0.8), radius=1.0), LENS, 2 * pi),
    "cube without ball": (CUBE - ball(center=(0.03, 0.05, 0.07), radius=0.6), 8 - 0.288 * pi, 24 + 1.44 * pi),
    "rod": (cylinder(center=ORIGIN, axis=(1.0, 1.0, 0.0), radius=0.5, height=1.2), 0.3 * pi, 1.7 * pi),
    "torus": (RING, 0.32 * pi**2, 1.6 * pi**2),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids(name: str) -> None:
    solid, volume, area = SOLIDS[name]
    found = measure(solid, 8, 6)
    check_rules(found)
    assert found.rules.unresolved == 0.0
    assert found.volume == pytest.approx(volume, rel=2e-9)
    assert found.perimeter == pytest.approx(area, rel=5e-7)
    assert found.volume_by_divergence == pytest.approx(volume, rel=5e-7)
    assert found.flux_of_constants < 5e-7


def test_high_order_reaches_rounding() -> None:
    found = measure(drilled((0.0, 0.0, 1.0)), 8, 11)
    assert found.volume == pytest.approx(4 / 3 * pi * HALF**3, rel=1e-14)
    assert found.of("ball") == pytest.approx(4 * pi * HALF, rel=1e-12)
    assert found.perimeter - found.of("ball") == pytest.approx(1.2 * pi * HALF, rel=1e-12)
    # Both the ball's and the cylinder's second moments about the axis are known.
    moment = found.integral(lambda x, y, z: x * x + y * y)
    exact = 4 * pi * (HALF**3 / 3 - HALF**5 / 5)
    assert moment == pytest.approx(exact, rel=1e-13)


def test_an_oblique_edge_has_full_order() -> None:
    found = measure(drilled((1.0, 2.0, 3.0)), 8, 7)
    assert found.volume == pytest.approx(4 / 3 * pi * HALF**3, rel=1e-10)
    assert found.of("ball") == pytest.approx(4 * pi * HALF, rel=1e-7)
    assert found.perimeter - found.of("ball") == pytest.approx(1.2 * pi * HALF, rel=1e-7)


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 5))
def test_rotated_cubes_are_exact(seed: int, cells: int) -> None:
    rng = np.random.default_rng(seed)
    axis = tuple(float(x) for x in rng.normal(size=3))
    # Over a base line the integrand is a polynomial of degree 4: three points.
    found = measure(CUBE.rotate(float(rng.uniform(0, 3)), axis=axis), cells, 3)
    assert found.volume == pytest.approx(8.0, rel=1e-12)
    assert found.perimeter == pytest.approx(24.0, rel=1e-12)
    assert found.integral(lambda x, y, z: x * x + y * y + z * z) == pytest.approx(8.0, rel=1e-12)


def test_crossing_cylinders() -> None:
    # Steinmetz: at two points the edges cross and no direction serves; the rest is at full order.
    def along(axis: tuple[float, float, float]) -> Shape:
        return cylinder(center=(0.0, 0.0, 0.0), axis=axis, radius=1.0)

    found = measure(along((1.0, 0.0, 0.0)) & along((0.0, 1.0, 0.0)) & CUBE.scale(1.5), 5, 5)
    assert found.volume == pytest.approx(16 / 3, rel=1e-8)
    assert found.perimeter == pytest.approx(16.0, rel=1e-7)
    assert found.rules.unresolved < 1e-5
