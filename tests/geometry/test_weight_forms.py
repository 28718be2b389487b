"""Scaled weights and plateaus: zero on the part, slope, limit, smoothness, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from boundary_sampling import boundary_points, inside_points

import rfm.geometry as g
from rfm.calculus.jets import partials
from rfm.errors import GeometryError
from rfm.geometry.weight_forms import Plateau, Scaled

RING = g.disk((0.5, 0.5), 0.4).named("outer") - g.disk((0.5, 0.5), 0.15).named("inner")
CUT = g.rectangle((0, 0), (2, 1)).named("plate") - g.disk((2, 1), 0.7).named("disk")

NAMES = {  # slope on the boundary relative to that of the weight it is made of
    "scaled:beta5": 1.0,
    "scaled:beta3:alpha1": 1.0,
    "scaled:beta2:alpha2.5": 1.0,
    "plateau:delta0.1": 30.0,
    "plateau:delta0.2:gamma1": 5.0,
    "plateau:delta0.05:gamma2.5": 50.0,
}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("shape", "part"), [(RING, "all"), (RING, "inner"), (CUT, "disk"), (CUT, "all")])
def test_zero_exactly_on_the_part_with_its_slope(shape: g.Shape, part: str, name: str) -> None:
    chosen = shape.part(part)
    w = g.weight(shape, chosen, name)
    base = g.distance(shape, chosen) if name.startswith("plateau") else g.weight(shape, chosen)
    assert w(*inside_points(shape).T).min() > 0
    for surface in chosen.surfaces:
        points, normals = boundary_points(shape, surface, 300)
        jet, plain = partials(w, tuple(points.T), 1), partials(base, tuple(points.T), 1)
        assert np.abs(jet[0]).max() < 1e-12
        slope, expected = ((item[1:] * normals.T).sum(axis=0) for item in (jet, plain))
        np.testing.assert_allclose(slope, NAMES[name] * expected, rtol=1e-8, atol=1e-12)


def test_plateau_is_one_from_delta_on() -> None:
    part = RING.part("all")
    points = inside_points(RING).T
    values, distance = (
        g.weight(RING, part, "plateau:delta0.05:gamma3")(*points),
        g.distance(RING, part)(*points),
    )
    assert (values[distance > 0.05] == 1.0).all()
    assert (values[distance < 0.05] < 1.0).all()
    np.testing.assert_allclose(values, 1 - np.maximum(0, 1 - distance / 0.05) ** 3, rtol=1e-13)


@pytest.mark.parametrize("gamma", [1, 2, 3, 4])
def test_plateau_has_gamma_minus_one_derivatives_at_delta(gamma: int) -> None:
    w = Plateau(lambda x: x, 0.5, gamma)
    sides = [partials(w, (np.array([0.5 + side]),), gamma)[:, 0] for side in (-1e-9, 1e-9)]
    jump = np.abs(sides[0] - sides[1])
    assert jump[:gamma].max() < 1e-6
    assert jump[gamma] > 1.0


def test_scaled_weight_levels_off() -> None:
    for alpha, limit in ((1.0, 0.25), (2.0, 0.0), (0.5, np.inf)):
        w = Scaled(lambda x: x, 4.0, alpha)
        assert w(1e9) == pytest.approx(limit, rel=1e-4, abs=1e-9) or (limit == np.inf and w(1e9) > 1e3)
    x = np.linspace(-2, 2, 401)
    np.testing.assert_array_equal(Scaled(lambda x: x, 4.0, 3.0)(x) > 0, x > 0)  # no pole beyond the boundary


def test_gamma_is_the_order_of_the_zero() -> None:
    w = Scaled(lambda x: x, 3.0, 2.0, 2.0)
    jet = partials(w, (np.zeros(1),), 2)[:, 0]
    np.testing.assert_allclose(jet, [0.0, 0.0, 2.0])


def test_no_part_gives_one() -> None:
    nothing = RING.part("outer") - RING.part("outer")
    for name in NAMES:
        assert g.weight(RING, nothing, name)(0.3, 0.4) == 1.0


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("plateau", "the weight plateau needs delta; write plateau:delta0.1:gamma3"),
        ("plateau:delta0", "delta must be positive, got 0"),
        ("plateau:delta-0.1:gamma2", "delta must be positive, got -0.1"),
        ("plateau:delta0.1:gamma0.5", "gamma must be at least 1, got 0.5"),
        (
            "plateau:delta0.1:beta2",
            "the weight plateau has no parameter 'beta2'; write plateau:delta0.1:gamma3",
        ),
        ("scaled", "the weight scaled needs beta; write scaled:beta5:alpha2:gamma1"),
        ("scaled:beta-1", "beta must be positive, got -1"),
        ("scaled:beta1:alpha0", "alpha must be positive, got 0"),
        ("scaled:beta1:gamma1.5", "gamma must be a positive integer, got 1.5"),
        ("rp3", "R_p needs an even p >= 2, got 3"),
        ("ralpha-1", "R_alpha needs -1 < alpha < 1, got -1.0; alpha = 1 is the system r1"),
    ],
)
def test_refused(name: str, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        g.weight(RING, RING.part("all"), name)
    assert str(caught.value) == message
