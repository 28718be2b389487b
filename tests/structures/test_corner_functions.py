"""Functions of corners: zero where values are given, harmonic, and their derivatives those of differences."""

import math

import numpy as np
import pytest

from rfm.calculus.jets import partials
from rfm.geometry import polygon
from rfm.geometry.singular.straight import StraightCorner, straight_corners
from structures.corner_functions import CornerFunctions
from structures.fading import VANISHED, Window, fading

(CORNER,) = straight_corners(polygon(((0, 0), (1, 0), (1, 1), (-1, 1), (-1, -1), (0, -1))))


def functions(angle: float, held: tuple[bool, bool], start: float = 0.4, degree: int = 5) -> CornerFunctions:
    corner = StraightCorner((0.3, -0.2), start, angle, CORNER.first, CORNER.second)
    return CornerFunctions(corner, held, degree, 1.7)


def along(one: CornerFunctions, angle: float, radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    direction = one.corner.start + angle
    return (
        one.corner.point[0] + radius * math.cos(direction),
        one.corner.point[1] + radius * math.sin(direction),
    )


ANGLES = [1.5 * math.pi, math.radians(300), math.radians(355), math.radians(200)]
HELD = [(True, True), (True, False), (False, True), (False, False)]


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("held", HELD)
def test_they_vanish_where_values_are_given(angle, held):
    one = functions(angle, held)
    radius = np.linspace(0.01, 1.5, 20)
    for side, given in zip((0.0, angle), held, strict=True):
        values = one.table(*along(one, side, radius), 0)[0]
        assert values.shape == (one.count, 20)
        if given:
            assert np.abs(values).max() < 1e-12


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("held", HELD)
def test_the_singular_ones_are_harmonic_without_flux_where_none_is_given(angle, held):
    one = functions(angle, held)
    x, y = along(one, 0.37 * angle, np.linspace(0.2, 1.5, 9))
    jets = one.table(x, y, 2)[:, : len(one.exponents)]
    assert np.abs(jets[3] + jets[5]).max() < 1e-10
    for side, given in zip((0.0, angle), held, strict=True):
        if not given:
            direction = one.corner.start + side
            gradient = one.table(*along(one, side, np.linspace(0.2, 1.5, 9)), 1)[1:, : len(one.exponents)]
            normal = -math.sin(direction) * gradient[0] + math.cos(direction) * gradient[1]
            assert np.abs(normal).max() < 1e-11


@pytest.mark.parametrize("held", HELD)
def test_derivatives_are_those_of_differences(held):
    one = functions(1.5 * math.pi, held)
    assert one.resonances
    x, y, step = *along(one, 2.0, np.array([0.5, 0.9])), 1e-5
    jets = one.table(x, y, 2)
    for row, lower, (dx, dy) in (
        (1, 0, (1, 0)),
        (2, 0, (0, 1)),
        (3, 1, (1, 0)),
        (4, 1, (0, 1)),
        (5, 2, (0, 1)),
    ):
        ahead = one.table(x + dx * step, y + dy * step, 1)[lower]
        behind = one.table(x - dx * step, y - dy * step, 1)[lower]
        assert np.allclose(jets[row], (ahead - behind) / (2 * step), atol=1e-7)


def test_leading_exponents():
    assert functions(1.5 * math.pi, (True, True)).exponents[:3] == pytest.approx((2 / 3, 4 / 3, 8 / 3))
    assert functions(1.5 * math.pi, (True, True)).resonances == (2, 4)
    assert functions(1.5 * math.pi, (True, False)).exponents[:2] == pytest.approx((1 / 3, 5 / 3))
    assert functions(2 * math.pi, (True, True)).exponents[:2] == pytest.approx((1 / 2, 3 / 2))
    assert functions(2 * math.pi, (True, True)).resonances == ()


def test_at_the_corner_values_are_zero_and_derivatives_finite():
    one = functions(1.5 * math.pi, (True, True))
    jets = one.table(np.array([0.3]), np.array([-0.2]), 1)
    assert not jets[0].any()
    assert np.isfinite(jets).all()


def test_factors_are_one_at_the_corner_to_their_order():
    factor = fading(lambda x, y: (1 + 0.5 * x) * (2 - y) * (9 + x), 18.0, 60.0, 2)
    jet = partials(factor, (0.0, 0.0), 1)
    assert jet == pytest.approx([1.0, 0.0, 0.0], abs=1e-14)
    assert factor(-2.0, 0.3) == pytest.approx(0.0, abs=1e-15)
    window = Window((0.0, 0.0), 0.5)
    assert partials(window, (0.0, 0.0), 3).ravel() == pytest.approx([1.0] + [0.0] * 9)
    assert abs(window(0.5 * VANISHED, 0.0)) < 3e-16


@pytest.mark.parametrize("held", HELD)
def test_products_with_the_squared_radius(held):
    plain = functions(1.5 * math.pi, held)
    one = CornerFunctions(plain.corner, held, plain.degree, plain.reach, radial=True)
    x, y = along(one, 2.0, np.array([0.5, 0.9]))
    jets, radius = one.table(x, y, 2), np.array([0.5, 0.9]) / one.reach
    assert np.array_equal(jets[:, : plain.count], plain.table(x, y, 2))
    pairs = one._products
    assert pairs[:2] == [(0, 1), (0, 2)]
    for row, (k, j) in enumerate(pairs, start=plain.count):
        assert jets[0, row] == pytest.approx(radius ** (2 * j) * jets[0, k])
        laplacian = 4 * j * (j + one.exponents[k]) * radius ** (2 * j - 2) * jets[0, k] / one.reach**2
        assert jets[3, row] + jets[5, row] == pytest.approx(laplacian)
