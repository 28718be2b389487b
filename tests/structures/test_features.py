"""Interpolation over points, curves and regions; scattered data; materials: exactness, smoothness, bounds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rfm.geometry as g
from rfm.calculus.functions import exp, sin
from rfm.calculus.jets import partials
from rfm.errors import StructureError
from structures.features import Curve, Point, Region, feature, normalised
from structures.scattered import material, scattered
from structures.transfinite import interpolate, interpolate_derivatives, weights

SQUARE = g.rectangle(min=(0, 0), max=(1, 1)).named("box")
DISK = g.disk(center=(0.5, 0.5), radius=0.2)
LEFT = Curve(SQUARE, SQUARE.part("box.left"))
POINT = Point((0.9, 0.2))
a = lambda x, y: sin(3 * x) + y  # noqa: E731
b = lambda x, y: exp(x - y)  # noqa: E731
inner = st.floats(0.01, 0.99)


def test_point_curve_and_region_together():
    u = interpolate([(a, POINT), (b, LEFT), (2.0, Region(DISK))], [2.0, 1.0, 3.0])
    assert u(0.9, 0.2) == pytest.approx(a(0.9, 0.2))
    t = np.linspace(0.05, 0.95, 20)
    assert partials(u, (0 * t, t), 0)[0] == pytest.approx(b(0, t))
    x, y = 0.5 + 0.19 * np.cos(6 * t), 0.5 + 0.19 * np.sin(6 * t)
    assert partials(u, (x, y), 0)[0] == pytest.approx(np.full(20, 2.0))
    assert np.isfinite(partials(u, (x, y), 2)).all()


@given(inner, inner, st.sampled_from([1.0, 2.0, 3.0, 4.0]))
def test_weights_of_features_are_a_partition_of_unity(x, y, mu):
    values = [w(x, y) for w in weights([POINT, LEFT, Region(DISK)], mu)]
    assert sum(values) == pytest.approx(1.0)
    assert min(values) >= 0.0


@pytest.mark.parametrize("mu", [1, 2, 3])
@pytest.mark.parametrize("place", ["curve", "point", "region"])
def test_order_of_contact(mu, place):
    # u - a = O(t^mu) at the distance t from the feature that carries a
    other = Curve(SQUARE, SQUARE.part("box.right"))
    here = {
        "curve": LEFT,
        "point": Point((0.0, 0.4)),
        "region": Region(g.disk(center=(-0.2, 0.4), radius=0.2)),
    }
    u = interpolate([(a, here[place]), (b, other)], float(mu))
    gaps = [abs(u(t, 0.4) - a(t, 0.4)) for t in (2e-3, 1e-3)]
    assert np.log2(gaps[0] / gaps[1]) == pytest.approx(mu, abs=0.1)


def test_derivatives_on_two_parts_of_different_order():
    # (7.12): value, slope and second derivative on the left, value on the right
    right = g.half_plane(point=(1, 0), normal=(-1, 0))
    w1, w2 = lambda x, y: x, lambda x, y: 1 - x
    assert right.dimension == 2
    u = interpolate_derivatives([((a, b, 3.0), w1), ((0.5,), w2)], 2)
    t = np.linspace(0, 1, 9)
    jets = partials(u, (0 * t, t), 2)
    assert jets[0] == pytest.approx(a(0, t))
    assert jets[1] == pytest.approx(b(0, t))
    assert jets[3] == pytest.approx(np.full(9, 3.0))
    assert partials(u, (1 + 0 * t, t), 0)[0] == pytest.approx(np.full(9, 0.5))


def test_even_powers_of_the_distance_to_a_point_are_smooth():
    jets = partials(POINT.raised(2), (np.array([0.9]), np.array([0.2])), 2)[:, 0]
    assert jets == pytest.approx([0, 0, 0, 2, 0, 2])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([2, 4, 6]))
def test_scattered_data(seed, exponent):
    rng = np.random.default_rng(seed)
    points, values, slopes = rng.random((12, 2)), rng.normal(size=12), rng.normal(size=(12, 2))
    flat, steep = scattered(points, values, exponent=exponent), scattered(points, values, slopes, exponent)
    jets = partials(flat, tuple(points.T), 1)
    assert jets[0] == pytest.approx(values, abs=1e-12)
    assert jets[1:] == pytest.approx(np.zeros((2, 12)), abs=1e-9)
    jets = partials(steep, tuple(points.T), 1)
    assert jets[1:] == pytest.approx(slopes.T, abs=1e-9)
    everywhere = partials(flat, tuple(rng.random((2, 200))), 0)[0]
    assert everywhere.min() >= values.min() - 1e-12
    assert everywhere.max() <= values.max() + 1e-12


def test_scattered_is_the_transfinite_interpolation_over_points():
    rng = np.random.default_rng(0)
    points, values = rng.random((5, 2)), rng.normal(size=5)
    textbook = interpolate([(v, Point(tuple(p))) for p, v in zip(points, values, strict=True)], 4.0)
    where = tuple(rng.random((2, 30)))
    got = partials(scattered(points, values), where, 2)
    assert got == pytest.approx(partials(textbook, where, 2), rel=1e-8, abs=1e-8)
    assert scattered(points, values)(0.3, 0.4) == pytest.approx(textbook(0.3, 0.4))


def test_a_linear_function_is_reproduced_from_slopes():
    rng = np.random.default_rng(1)
    points = rng.random((8, 3))
    u = scattered(points, 1 + points @ [1.0, 2.0, 3.0], np.tile([1.0, 2.0, 3.0], (8, 1)))
    x = rng.random((3, 20))
    assert partials(u, tuple(x), 0)[0] == pytest.approx(1 + np.array([1.0, 2.0, 3.0]) @ x)


@given(inner, inner)
def test_a_material_stays_between_its_constituents(x, y):
    k = material([(1.0, LEFT), (50.0, Region(DISK)), (4.0, POINT)])
    assert 1.0 - 1e-12 <= k(x, y) <= 50.0 + 1e-12


def test_kinds_of_feature():
    assert [feature(f).dimension for f in ((0.1, 0.2), DISK, LEFT)] == [0, 2, 1]
    assert feature(SQUARE, SQUARE.part("box.left")).name == "box.left"


def test_errors():
    with pytest.raises(StructureError, match=r"must be positive, got -2 on box\.left"):
        material([(-2.0, LEFT), (1.0, POINT)])
    with pytest.raises(StructureError, match="2 points need as many values, got 1"):
        scattered([[0, 0], [1, 1]], [1.0])
    with pytest.raises(StructureError, match="must be even"):
        scattered([[0, 0], [1, 1]], [1.0, 2.0], exponent=3)
    with pytest.raises(StructureError, match="coincide"):
        scattered([[0, 0], [0, 0]], [1.0, 2.0])
    with pytest.raises(StructureError, match="shape of the points"):
        scattered([[0, 0], [1, 1]], [1.0, 2.0], [[1.0, 0.0]])


@pytest.mark.parametrize("order", [2, 3, 4])
def test_other_features_nearby_are_no_lack_of_smoothness(order):
    plate = g.rectangle((0, 0), (2, 1)).named("plate") - g.disk((1, 0.5), 0.2).named("hole")
    w = normalised(plate, plate.part("all"), order)
    x = np.array([0.3, 0.9])
    assert (w(x, np.zeros(2)) == 0.0).all()
