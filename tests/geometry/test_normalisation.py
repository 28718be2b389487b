"""Normalisation to order m: at random boundary points, the sign elsewhere, and what systems keep."""

from __future__ import annotations

import math

import numpy as np
import pytest
from boundary_sampling import boundary_points, inside_points

import rfm.geometry as g
from rfm.calculus.jets import partials
from rfm.calculus.r_systems import RAlphaField, system
from rfm.errors import GeometryError
from rfm.geometry.normalisation import Slope, kept_order, raised

OVAL = g.ellipse((0.1, 0), (1.0, 0.6), 0.3).named("oval")
RING = g.torus((0, 0, 0), (0, 1, 1), 1.0, 0.4).named("ring")
PLATE = g.rectangle((-1, -1), (1.5, 1)).named("plate") - g.disk((0.4, 0.1), 0.4).named("hole")
CASES = {
    "ellipse": (OVAL, "all"),
    "torus": (RING, "all"),
    "hole": (PLATE, "hole"),
    "plate and hole": (PLATE, "all"),
    "union, trimmed": (OVAL | g.disk((1, 0), 0.6).named("disk"), "disk"),
}


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("case", CASES)
def test_normal_derivatives_of_a_distance(case: str, order: int) -> None:
    """w = 0, dw/dn = 1, d^k w/dn^k = 0 for k = 2..m, away from corners."""
    shape, name = CASES[case]
    part = shape.part(name)
    w = g.distance(shape, part, order)
    for surface in part.surfaces:
        points, normals = boundary_points(shape, surface, 40)
        others = [np.abs(s.function(*points.T)) for s in shape.surfaces if s is not surface]
        keep = np.min([np.ones(len(points)), *others], axis=0) > 0.1
        lines = list(zip(points[keep].T, normals[keep].T, strict=True))
        assert keep.sum() > 5
        jet = partials(lambda t: w(*(x + t * n for x, n in lines)), (np.zeros(keep.sum()),), order)  # noqa: B023
        assert np.abs(jet[0]).max() < 1e-13
        assert np.abs(jet[1] - 1.0).max() < 1e-10
        assert np.abs(jet[2:]).max(initial=0.0) < 1e-6


@pytest.mark.parametrize("order", [2, 3, 4])
@pytest.mark.parametrize("shape", [OVAL, RING, g.ellipse((0, 0), (1, 0.2))])
def test_the_sign_stays_everywhere(shape: g.Shape, order: int) -> None:
    """(4.10) as published loses it: 0 <= w_m/w_1 <= 2 holds here also far from the boundary."""
    f, dim = shape.surfaces[0].function, shape.dimension
    points = np.random.default_rng(0).uniform(-4, 4, (4000, dim)).T
    first, w = Slope(f)(*points), g.normalise(f, dim, order)(*points)
    ratio = w / first
    assert ratio.min() > 0.0
    assert ratio.max() < 2.0


def test_a_normalised_function_is_not_divided_again() -> None:
    """Raised by (4.10) alone; (4.9) once more would change it where its gradient is not one."""
    first = g.distance(PLATE, PLATE.part("all"))
    points = inside_points(PLATE, 500).T
    np.testing.assert_array_equal(raised(first, 2, 1)(*points), first(*points))
    assert np.abs(g.normalise(first, 2)(*points) - first(*points)).max() > 0.05


def test_fourth_order_does_not_blow_up_inside() -> None:
    points = inside_points(PLATE, 4000).T
    first, fourth = (g.distance(PLATE, PLATE.part("all"), order)(*points) for order in (1, 4))
    assert fourth.min() > 0.0
    assert (fourth / first).max() < 2.0


@pytest.mark.parametrize(
    ("name", "order"),
    [("r0", 1), ("r1", math.inf), ("rp2", 1), ("rp4", 3), ("rp8", 7), ("r0m2", 0), ("ralpha-0.5", 1)],
)
def test_orders_that_systems_keep(name: str, order: float) -> None:
    assert kept_order(system(name)) == order


def test_alpha_as_a_function_keeps_the_slope() -> None:
    varying = RAlphaField(lambda x, y: 0.3 + 0.1 * x)
    both = OVAL.intersect(g.half_plane((0, 0), (1, 0)), varying)
    assert both.report().kept == 1


def test_order_must_be_positive() -> None:
    for build in (lambda: g.distance(OVAL, OVAL.part("all"), 0), lambda: g.normalise(lambda x: x, 1, 0)):
        with pytest.raises(GeometryError, match=r"^order of normalisation must be at least 1, got 0$"):
            build()
