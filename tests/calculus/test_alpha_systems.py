"""R_alpha with alpha a function of the arguments or a field: formula, bounds, symmetry, bad values."""

import math

import numpy as np
import pytest

from rfm.calculus import functions as fn
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import partials, variables
from rfm.calculus.r_systems import R0, R1, RAlpha, RAlphaField, RAlphaOf
from rfm.errors import GeometryError
from rfm.geometry import disk
from rfm.geometry.vanishing import Composition

rng = np.random.default_rng(3)
F, G = rng.uniform(-2, 2, (2, 500))


@pytest.mark.parametrize("alpha", [-0.7, 0.0, 0.4, 1.0])
def test_a_constant_function_is_the_constant_system(alpha: float) -> None:
    constant = R1() if alpha == 1.0 else RAlpha(alpha)
    of = RAlphaOf(lambda f, g: f * 0.0 + alpha)
    field = RAlphaField(lambda x, y: alpha + 0.0 * x).at(F, G)
    for other in (of, field):
        np.testing.assert_allclose(
            other.conjunction(F, G), constant.conjunction(F, G), rtol=1e-11, atol=1e-14
        )
        np.testing.assert_allclose(
            other.disjunction(F, G), constant.disjunction(F, G), rtol=1e-11, atol=1e-14
        )


def test_a_disjunction_mirrors_an_alpha_that_is_not_even() -> None:
    r = RAlphaOf(lambda f, g: fn.tanh(f + g) * 0.5)
    alpha = 0.5 * np.tanh(-(F + G))
    expected = (F + G + np.sqrt(F**2 + G**2 - 2 * alpha * F * G)) / (1 + alpha)
    np.testing.assert_allclose(r.disjunction(F, G), expected, rtol=1e-12, atol=1e-14)


def test_derivatives_agree_with_differences() -> None:
    r = RAlphaOf(lambda f, g: 0.3 * fn.sin(f * g))
    x, y, h = np.array([0.3, -0.4]), np.array([0.8, 0.5]), 1e-6
    jet = partials(r.conjunction, (x, y), 1)
    difference = (r.conjunction(x + h, y) - r.conjunction(x - h, y)) / (2 * h)
    np.testing.assert_allclose(jet[1], difference, rtol=1e-8)
    assert np.isfinite(partials(r.conjunction, (np.zeros(1), np.zeros(1)), 2)).all()


def test_intervals_enclose() -> None:
    r = RAlphaOf(lambda f, g: 0.5 - 0.25 * fn.cos(f * g))
    lo = rng.uniform(-1, 1, (2, 100))
    hi = lo + 0.05
    box = r.conjunction(Interval(lo[0], hi[0]), Interval(lo[1], hi[1]))
    assert box.contains(r.conjunction(0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1]))).all()
    assert np.max(box.width) < 1.0


def test_a_field_reaches_the_r_functions_of_a_shape() -> None:
    shape = disk((0, 0), 1) & disk((0.5, 0), 1)
    one, other = shape.surfaces
    system = RAlphaField(lambda x, y: 0.5 * x)
    composed = Composition(shape.expression, system, lambda surface: surface.function)
    x, y = np.array([0.2, 0.4]), np.array([0.1, -0.3])
    expected = [
        RAlpha(0.5 * a).conjunction(one.function(a, b), other.function(a, b))
        for a, b in zip(x, y, strict=True)
    ]
    np.testing.assert_allclose(composed(x, y), expected, rtol=1e-12)
    assert np.isfinite(composed(*variables((x, y), 2)).coefficients[-1]).all()


def test_bad_alpha() -> None:
    with pytest.raises(GeometryError, match=r"needs -1 < alpha <= 1, got alpha = -1$"):
        RAlphaOf(lambda f, g: -1.0)
    with pytest.raises(GeometryError, match=r"symmetric, but alpha\(-0.8, -0.3\) = -0.24 and .* = -0.09"):
        RAlphaOf(lambda f, g: 0.3 * f)
    steep = RAlphaOf(lambda f, g: 0.1 - 0.1 * (f * f + g * g))
    with pytest.raises(GeometryError, match=r"got alpha = -1.9"):
        steep.conjunction(np.array([0.0, 4.0]), np.array([0.1, 2.0]))
    with pytest.raises(GeometryError, match=r"got alpha = -1.5"):
        steep.conjunction(*variables((4.0, 0.0), 1))
    with pytest.raises(GeometryError, match=r"got alpha = -1.5"):
        steep.conjunction(Interval(4.0, 4.0), Interval(0.0, 0.0))
    field = RAlphaField(lambda x, y: x)
    with pytest.raises(GeometryError, match=r"got alpha = 1.5"):
        field.at(np.array([0.0, 1.5]), np.zeros(2))
    with pytest.raises(GeometryError, match=r"combine values by system.at\(x, y\)"):
        field.conjunction(1.0, 2.0)
    assert field.at(0.0, 0.0).conjunction(3.0, 4.0) == pytest.approx(R0.conjunction(3.0, 4.0))
    assert math.isfinite(field.at(1.0, 0.0).conjunction(3.0, 4.0))
