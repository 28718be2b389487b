"""Offsets and shells: exact for round and straight boundaries, first order for others."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rfm.geometry as g
from rfm.errors import GeometryError
from rfm.geometry.blending import offset, shell
from tests.solvers.quadrature.measures import measure

FRAME = g.rectangle((0.0, 0.0), (2.0, 1.0)).named("plate") - g.disk((1.0, 0.5), 0.2).named("hole")


@settings(max_examples=12)
@given(st.floats(-0.15, 0.15))
def test_exact_shapes_stay_what_they_are(distance: float) -> None:
    points = np.random.default_rng(1).uniform(-1.6, 1.6, (500, 3))
    for grown, same in (
        (offset(g.ball((0.1, 0, 0), 0.5), distance), g.ball((0.1, 0, 0), 0.5 + distance)),
        (
            offset(g.torus((0, 0, 0), (0, 1, 1), 1.0, 0.3), distance),
            g.torus((0, 0, 0), (0, 1, 1), 1.0, 0.3 + distance),
        ),
        (
            offset(g.cylinder((0, 0, 0), (1, 1, 0), 0.4, 1.0), distance),
            g.cylinder((0, 0, 0), (1, 1, 0), 0.4 + distance, 1.0 + 2 * distance),
        ),
    ):
        np.testing.assert_allclose(
            grown.membership(*points.T), same.membership(*points.T), rtol=1e-9, atol=1e-12
        )
        assert [s.degree for s in grown.surfaces] == [s.degree for s in same.surfaces]
        assert grown.box.contains(same.box, 1e-12)


def test_holes_shrink_when_the_shape_grows() -> None:
    grown = offset(FRAME, 0.1)
    assert grown.parts == FRAME.parts
    assert measure(grown, 12, 5).volume == pytest.approx(2.2 * 1.2 - 0.01 * pi, rel=1e-7)
    assert measure(offset(FRAME, -0.1), 12, 5).volume == pytest.approx(1.8 * 0.8 - 0.09 * pi, rel=1e-7)


def test_mitred_corners_lie_in_the_box() -> None:
    for angle in np.linspace(0.0, 1.5, 7):
        needle = g.polygon([(0, 0), (2, 0), (0, 0.7)]).rotate(float(angle))
        grown = offset(needle, 0.1)
        points = np.random.default_rng(2).uniform(-4, 4, (20000, 2))
        inside = points[grown.contains(points)]
        assert (inside >= grown.box.lower).all()
        assert (inside <= grown.box.upper).all()
        assert grown.contains(points[needle.contains(points)]).all()


def test_other_shapes_are_right_to_first_order() -> None:
    ellipse, length = g.ellipse((0, 0), (1.0, 0.5)), 4.844224110273838
    for distance in (0.02, 0.01, -0.01):
        grown = measure(offset(ellipse, distance), 10, 5).volume
        exact = pi * 0.5 + length * distance + pi * distance**2
        assert grown == pytest.approx(exact, abs=12 * distance**2)


def test_shells() -> None:
    hollow = shell(g.disk((0, 0), 1.0).named("ring"), 0.1)
    assert hollow.parts == ("ring", "inner", "inner.ring")
    assert measure(hollow, 10, 5).volume == pytest.approx(0.19 * pi, rel=1e-6)
    assert shell(g.box((0, 0, 0), (1, 1, 1)), 0.2).contains(
        np.array([[0.1, 0.5, 0.5], [0.5] * 3])
    ).tolist() == [
        True,
        False,
    ]


REFUSED = [
    (lambda: offset(g.disk((0, 0), 0.5), -0.5), "distance -0.5 makes the shape vanish: its size is 0.5"),
    (lambda: offset(FRAME, 0.2), "distance 0.2 makes the hole vanish: its size is 0.2"),
    (lambda: shell(FRAME, 0.6), "distance -0.6 makes the shape vanish: its size is 0.5"),
    (lambda: shell(FRAME, 0.0), "thickness must be positive, got 0"),
]


@pytest.mark.parametrize(("build", "message"), REFUSED)
def test_refused(build, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        build()
