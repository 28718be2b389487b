"""Maps back undo the maps forward; folded functions are enclosed over boxes; every kind of value gives the same."""

from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rfm.geometry as g
from rfm.calculus import partials
from rfm.calculus.intervals import Interval
from rfm.calculus.waves import triangle
from rfm.geometry.shape import Shape
from rfm.geometry.similarity import frame
from rfm.geometry.transforms import cyclic, extrude, repeat, twist
from rfm.geometry.transforms.affine import Affine
from rfm.geometry.transforms.cyclic import Kaleidoscope
from rfm.geometry.transforms.extrude import Prism
from rfm.geometry.transforms.revolve import Revolution
from rfm.geometry.transforms.screw import Twist
from rfm.geometry.transforms.taper import Taper

number = st.floats(-1.0, 1.0)
point = st.tuples(number, number, number)
BOX = g.Box((-1, -1, -1), (1, 1, 1))


@given(point, number, st.floats(-3, 3))
def test_maps_back_undo_the_maps(p: tuple[float, float, float], slope: float, rate: float) -> None:
    x, y, z = p
    turned = (x * cos(rate * z) - y * sin(rate * z), x * sin(rate * z) + y * cos(rate * z), z)
    np.testing.assert_allclose(Twist(rate, 2.0, -1.0, 1.0).back(*turned), p, atol=1e-14)
    np.testing.assert_allclose(Twist(rate, 2.0, -1.0, 1.0, flat=True).back(*turned), (x, y), atol=1e-14)
    scale = 1.0 + 0.5 * slope * z
    np.testing.assert_allclose(Taper(0.0, 0.5 * slope, BOX).back(x * scale, y * scale, z), p, atol=1e-14)
    prism = Prism(np.array([[1.0, 0.0, -slope], [0.0, 1.0, -rate]]), np.zeros(2))
    np.testing.assert_allclose(prism.back(x + slope * z, y + rate * z, z), (x, y), atol=1e-14)
    axis, base = np.array([slope, 1.0, rate]) / hypot(slope, 1.0, rate), np.array([0.2, -0.1, 0.3])
    rows = frame(axis)
    place = base + abs(x) * (cos(y) * rows[0] + sin(y) * rows[1]) + z * axis
    np.testing.assert_allclose(Revolution(base, rows).back(*place), (abs(x), z), atol=1e-14)


@given(st.lists(number, min_size=9, max_size=9), point, point)
def test_affine_maps_have_inverses(
    entries: list[float], shift: tuple[float, ...], p: tuple[float, ...]
) -> None:
    matrix = np.array(entries).reshape(3, 3) + 4.0 * np.eye(3)
    inverse = np.linalg.inv(matrix)
    mapping = Affine(inverse, -inverse @ shift, matrix=matrix, offset=np.array(shift))
    np.testing.assert_allclose(mapping.back(*(matrix @ p + shift)), p, atol=1e-13)


@given(st.integers(2, 9), st.floats(0.01, 2.0), st.floats(0.0, 1.0), st.integers(0, 20))
def test_all_sectors_are_folded_onto_one(count: int, radius: float, share: float, sector: int) -> None:
    half = 0.5 * pi / count
    fold = Kaleidoscope(2, lambda angle: triangle(angle - half, half) + half, 2.0)
    angle = share * pi / count
    expected = (radius * cos(angle), radius * sin(angle))
    for sign in (1.0, -1.0):
        place = sign * angle + 2 * pi * sector / count
        found = fold.back(radius * cos(place), radius * sin(place))
        np.testing.assert_allclose(found, expected, atol=1e-12)


PETAL = g.ellipse((0.8, 0.0), (0.3, 0.1))
FOLDED: dict[str, Shape] = {
    "wave around": cyclic(PETAL, 5, by="wave"),
    "series around": cyclic(PETAL, 5, by="fourier", terms=5),
    "wave around an axis": cyclic(g.ball((0.8, 0.0, 0.1), 0.2), 3, (0.1, 0.0, 0.0), by="wave"),
    "row": repeat(PETAL, (0.7, 0.2), 4, "wave"),
    "row in space": repeat(g.torus((0, 0, 0), (0, 0, 1), 0.5, 0.1), (0, 0.3, 0.4), 3, "copies"),
}


@pytest.mark.parametrize("name", FOLDED)
def test_folded_functions_are_enclosed_and_boxes_hold(name: str) -> None:
    shape, rng = FOLDED[name], np.random.default_rng(3)
    size = np.array(shape.box.size)
    low = shape.box.lower + size * rng.uniform(-0.2, 1.2, (2000, shape.dimension))
    low[0] = 0.0
    high = low + rng.uniform(0.0, 0.2, low.shape)
    bound = Interval.of(shape.membership(*(Interval(a, b) for a, b in zip(low.T, high.T, strict=True))))
    for t in (0.0, 0.5, 1.0):
        values = shape.membership(*(low + t * (high - low)).T)
        assert np.all((bound.lo <= values) & (values <= bound.hi))
    inside = low[shape.contains(low)]
    assert len(inside) > 20
    assert (inside >= shape.box.lower).all()
    assert (inside <= shape.box.upper).all()


def test_derivatives_at_the_center_are_finite() -> None:
    for by in ("wave", "fourier"):
        flower = cyclic(g.disk((0.3, 0.0), 0.5), 4, by=by)
        assert np.isfinite(partials(flower.membership, (np.zeros(1), np.zeros(1)), 1)).all()
        assert np.isfinite(flower.membership(0.0, 0.0))


def test_maps_work_on_a_device() -> None:
    import jax.numpy as jnp

    x = np.random.default_rng(5).uniform(-1, 1, (3, 50))
    solids = [
        twist(g.half_space((0, 0, 0), (0, 1, 0)), 1.0),
        extrude(cyclic(g.disk((0.8, 0.0), 0.3), 5, by="wave"), (0.1, 0.2, 0.5)),
    ]
    for solid in solids:
        np.testing.assert_allclose(
            np.asarray(solid.membership(*(jnp.asarray(c) for c in x))),
            solid.membership(*x),
            rtol=1e-4,
            atol=1e-5,
        )
