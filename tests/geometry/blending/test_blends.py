"""Blends: plain outside their range, rounder inside it, boxes that contain them, no poles."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rfm.geometry as g
from rfm.calculus import partials
from rfm.calculus.intervals import Interval
from rfm.errors import GeometryError
from rfm.geometry.blending import blend, bounded_blend, displacement_blend
from rfm.geometry.blending.rho import rho_blend
from tests.solvers.quadrature.measures import measure

LEFT, RIGHT = g.disk((0.0, 0.0), 1.0), g.disk((1.5, 0.0), 0.8)
UNION = LEFT | RIGHT
WITHIN = g.disk((0.9, 0.8), 0.5)
X, Y = g.half_plane((0.0, 0.0), (1.0, 0.0)), g.half_plane((0.0, 0.0), (0.0, 1.0))

BLENDS = {
    "fillet": blend([LEFT, RIGHT], 0.3),
    "smooth fillet": blend([LEFT, RIGHT], 0.3, smoothness=3),
    "three": blend([LEFT, RIGHT, g.disk((0.7, 1.0), 0.4)], 0.2),
    "displacement": displacement_blend([LEFT, RIGHT], 0.15),
    "bounded": bounded_blend([LEFT, RIGHT], WITHIN, 0.2, (0.3, 0.3, 0.3)),
    "lens": blend([LEFT, RIGHT], 0.3, "intersection"),
    "difference": blend([LEFT, ~RIGHT], 0.2, "intersection"),
    "lowered": displacement_blend([LEFT, RIGHT], -0.1, (0.2, 0.2), "intersection"),
    "ellipses": blend([g.ellipse((0, 0), (1.0, 0.5)), g.ellipse((0.8, 0.3), (0.4, 1.0), 0.3)], 0.2),
    "solid": blend([g.ball((0, 0, 0), 0.8), g.cylinder((0, 0, 0), (0, 0, 1), 0.3, 3.0)], 0.2),
}
ADDING = {"fillet", "smooth fillet", "three", "displacement", "bounded", "ellipses"}


def around(shape: g.Shape, count: int = 20000) -> np.ndarray:
    low, size = np.array(shape.box.lower), np.array(shape.box.size)
    return low + size * np.random.default_rng(7).uniform(-0.4, 1.4, (count, shape.dimension))


@pytest.mark.parametrize("name", BLENDS)
def test_the_box_contains_the_blend_and_the_function_has_no_pole(name: str) -> None:
    shape = BLENDS[name]
    points = around(shape)
    values = partials(shape.surfaces[0].function, tuple(points.T), 2)
    assert np.isfinite(values).all()
    inside = points[values[0] > 0]
    assert len(inside) > 500
    assert (inside >= shape.box.lower).all()
    assert (inside <= shape.box.upper).all()
    assert len(shape.surfaces) == 1


@pytest.mark.parametrize("name", BLENDS)
def test_intervals_enclose_the_blend(name: str) -> None:
    shape = BLENDS[name]
    low = around(shape, 400)
    high = low + np.random.default_rng(8).uniform(0, 0.1, low.shape)
    field = shape.surfaces[0].function
    bound = Interval.of(field(*(Interval(a, b) for a, b in zip(low.T, high.T, strict=True))))
    for t in (0.0, 0.4, 1.0):
        values = field(*(low + t * (high - low)).T)
        assert np.all((bound.lo <= values) & (values <= bound.hi))


@pytest.mark.parametrize("name", sorted(ADDING))
def test_blended_unions_contain_the_union(name: str) -> None:
    plain = UNION if name != "ellipses" else g.ellipse((0, 0), (1.0, 0.5))
    points = around(plain)
    grown = BLENDS[name].contains(points)
    assert grown[plain.contains(points)].all()
    assert grown.sum() > plain.contains(points).sum()


def test_blended_intersections_lie_in_the_intersection() -> None:
    points = around(LEFT, 40000)
    for name, plain in (("lens", LEFT & RIGHT), ("difference", LEFT - RIGHT), ("lowered", LEFT & RIGHT)):
        inside = BLENDS[name].contains(points)
        assert plain.contains(points)[inside].all()
        assert 0 < inside.sum() < plain.contains(points).sum()


def test_a_fillet_changes_nothing_outside_its_range() -> None:
    points = around(UNION)
    f, g_ = (shape.membership(*points.T) for shape in (LEFT, RIGHT))
    far = f**2 + g_**2 > 0.09
    np.testing.assert_array_equal(BLENDS["fillet"].contains(points)[far], UNION.contains(points)[far])
    away = ~WITHIN.contains(points)
    np.testing.assert_array_equal(BLENDS["bounded"].contains(points)[away], UNION.contains(points)[away])
    assert (BLENDS["bounded"].contains(points) != UNION.contains(points)).sum() > 10


@given(st.floats(0.05, 2.0), st.floats(0.0, 0.5 * pi))
def test_a_fillet_between_perpendicular_lines_is_an_arc(radius: float, angle: float) -> None:
    x, y = radius * (1 - np.cos(angle)), radius * (1 - np.sin(angle))
    assert abs(rho_blend(x, y, radius, -1.0)) < 1e-12 * radius + 1e-9 * radius * (x + y == 0)
    assert abs(rho_blend(-x, -y, radius, 1.0)) < 1e-12 * radius
    assert rho_blend(1.01 * x + 1e-3 * radius, 1.01 * y + 1e-3 * radius, radius, -1.0) > 0


@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(0, 1), st.floats(0, 1), st.integers(1, 7))
def test_rho_blends_increase(f: float, g_: float, df: float, dg: float, smoothness: int) -> None:
    for sign in (-1.0, 1.0):
        low, high = (rho_blend(a, b, 1.0, sign, smoothness) for a, b in ((f, g_), (f + df, g_ + dg)))
        assert low <= high + 1e-12


def test_rounded_square_has_the_known_area() -> None:
    corner = blend([X, Y], 0.3, "intersection") & g.rectangle((-1.0, -1.0), (1.0, 1.0))
    found = measure(corner, 8, 5)
    assert found.volume == pytest.approx(1 - 0.09 * (1 - pi / 4), rel=1e-9)
    assert found.volume_by_divergence == pytest.approx(found.volume, rel=1e-8)


@pytest.mark.parametrize("smoothness", [1, 2, 3])
def test_a_fillet_is_as_smooth_as_it_says(smoothness: int) -> None:
    # across f = rho on the line g = 0 derivatives up to the order exist, the next one jumps
    def jump(order: int) -> float:
        at = [
            partials(lambda x: rho_blend(x, 0.2 * x, 1.0, 1.0, smoothness), (np.array([edge]),), order)[-1, 0]
            for edge in (1 / 1.04**0.5 * (1 - 1e-9), 1 / 1.04**0.5 * (1 + 1e-9))
        ]
        return abs(at[1] - at[0])

    assert jump(smoothness) < 1e-5 < 1e-2 < jump(smoothness + 1)


REFUSED = [
    (lambda: blend([LEFT, RIGHT], 0.9), r"radius must not exceed the size of the shapes \(0.8\), got 0.9"),
    (lambda: blend([LEFT, RIGHT], -0.1), "radius must be positive, got -0.1"),
    (lambda: blend([LEFT], 0.1), "a blend needs at least two shapes, got 1"),
    (lambda: blend([LEFT, g.ball((0, 0, 0), 1)], 0.1), "shapes of dimension 2 and 3 cannot be blended"),
    (lambda: blend([LEFT, RIGHT], 0.1, "xor"), "operation must be one of union, intersection, got 'xor'"),
    (lambda: blend([LEFT, RIGHT], 0.1, smoothness=8), "smoothness must be a whole number from 1 to 7, got 8"),
    (lambda: displacement_blend([LEFT, RIGHT], 0.0), "amount must not be 0: there would be no blend"),
    (
        lambda: displacement_blend([LEFT, RIGHT], -1.0),
        r"amount must not exceed the size of the shapes \(0.8\), got 1",
    ),
    (lambda: displacement_blend([LEFT, RIGHT, X], 0.1), "a displacement joins two shapes, got 3"),
    (lambda: displacement_blend([LEFT, RIGHT], 0.1, (1, 0)), "ranges must be positive, got 0"),
    (lambda: bounded_blend([LEFT, RIGHT], WITHIN, 0.1, (1, 1)), "ranges must be 3 numbers, got 2"),
]


@pytest.mark.parametrize(("build", "message"), REFUSED)
def test_refused(build, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        build()
