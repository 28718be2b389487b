"""Interpolation weights: partition of unity, exact on the parts, finite and smooth there."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rfm.calculus.functions import sin
from rfm.calculus.jets import partials
from rfm.errors import StructureError
from structures.field_expression import field
from structures.transfinite import interpolate, weights

X, Y = field(lambda x, y: x), field(lambda x, y: y)
SIDES = [X, 1 - X, Y, 1 - Y]
inner = st.floats(1e-3, 1 - 1e-3)


@given(inner, inner, st.sampled_from([1.0, 2.0, 3.0]))
def test_weights_are_a_partition_of_unity(x, y, exponent):
    values = [w(x, y) for w in weights(SIDES, exponent)]
    assert sum(values) == pytest.approx(1.0)
    assert min(values) >= 0


@given(inner, st.sampled_from([1.0, 2.0]))
def test_weights_are_one_on_their_part_and_zero_on_the_others(t, exponent):
    points = [(0.0, t), (1.0, t), (t, 0.0), (t, 1.0)]
    values = [[float(w(x, y)) for w in weights(SIDES, exponent)] for x, y in points]
    assert np.array(values) == pytest.approx(np.eye(4), abs=1e-14)


def test_formula_of_the_paper():
    # (7.11): W_i = omega_i^-mu_i / sum_j omega_j^-mu_j
    x, y = np.random.default_rng(0).random((2, 20))
    mu = [1.0, 2.0, 3.0, 2.0]
    omegas = np.array([x, 1 - x, y, 1 - y])
    inverse = np.array([o**-m for o, m in zip(omegas, mu, strict=True)])
    got = np.array([w(x, y) for w in weights(SIDES, mu)])
    assert got == pytest.approx(inverse / inverse.sum(axis=0))


def test_exponents_interpolate_derivatives():
    # with exponents m, derivatives below order m are those of the data
    g = lambda x, y: sin(3 * x) + y  # noqa: E731
    u = interpolate([(g, X), (0.0, 1 - X)], 3.0)
    coords = (np.zeros(5), np.linspace(0.1, 0.9, 5))
    assert partials(u, coords, 2) == pytest.approx(partials(g, coords, 2), abs=1e-12)


def test_derivatives_are_finite_on_the_boundary():
    x = np.array([0.0, 1.0, 0.3, 0.0])
    y = np.array([0.4, 0.2, 1.0, 0.0])
    assert np.isfinite(partials(interpolate([(1.0, X), (2.0, Y)], 2.0), (x, y), 2)).all()


def test_at_a_common_point_the_mean_of_those_that_meet():
    u = interpolate([(1.0, X), (9.0, 1 - X), (2.0, Y)], 2.0)
    assert u(0.0, 0.0) == pytest.approx(1.5)


def test_errors():
    with pytest.raises(StructureError, match="at least one"):
        interpolate([])
    with pytest.raises(StructureError, match="2 parts need 2 exponents"):
        weights([X, Y], [1.0])
    with pytest.raises(StructureError, match="positive"):
        weights([X, Y], 0.0)
