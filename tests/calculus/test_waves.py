"""Saw-tooth and triangle waves: values, bounds over intervals, derivatives, the Fourier series."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rfm.calculus import Interval, partials
from rfm.calculus.waves import cell, fold_series, saw, triangle

HALF = 0.7
numbers = st.floats(-8.0, 8.0)


@pytest.mark.parametrize("wave", [saw, triangle])
@pytest.mark.parametrize("ends", [{}, {"first": 0.0, "last": 3.0}])
@given(start=numbers, width=st.floats(0.0, 5.0), t=st.floats(0.0, 1.0))
def test_bounds_contain_the_values(wave, ends, start: float, width: float, t: float) -> None:
    low, high = np.array([start]), np.array([start + width])
    bound = wave(Interval(low, high), HALF, **ends)
    point = np.clip(low + t * width, low, high)
    assert bound.contains(wave(point, HALF, **ends)).all()


def test_bounds_become_tight_at_a_wall_and_away_from_it() -> None:
    for middle in (0.3, HALF, 3 * HALF, -HALF):
        x = Interval(np.array([middle - 1e-6]), np.array([middle + 1e-6]))
        assert (triangle(x, HALF).width < 2.1e-6).all()
    assert (triangle(Interval(np.array([-np.inf]), np.array([np.inf])), HALF).hi == HALF).all()


def test_the_triangle_wave_is_its_closed_form() -> None:
    x = np.linspace(-6, 6, 777)
    np.testing.assert_allclose(
        triangle(x, HALF), 2 * HALF / np.pi * np.arcsin(np.sin(np.pi * x / (2 * HALF))), atol=1e-14
    )
    assert np.abs(saw(x, HALF)).max() <= HALF * (1 + 1e-15)
    np.testing.assert_allclose((x - saw(x, HALF)) / (2 * HALF), cell(x, HALF), atol=1e-13)


def test_slopes() -> None:
    x = np.array([0.1, 1.0, 2.5, -1.0])
    np.testing.assert_allclose(partials(lambda t: triangle(t, HALF), (x,), 1)[1], [1, -1, 1, -1])
    np.testing.assert_allclose(partials(lambda t: saw(t, HALF), (x,), 1)[1], 1.0)


def test_limited_waves_go_on_beyond_their_last_cell() -> None:
    x = np.array([-3.0, 9.0])
    np.testing.assert_allclose(saw(x, HALF, 2.0, 0.0), [-3.0, 9.0 - 4 * HALF])
    np.testing.assert_allclose(triangle(x, HALF, 1.0, 0.0), [-3.0, -(9.0 - 2 * HALF)])


def test_the_series_converges_as_stated() -> None:
    x = np.linspace(-3, 3, 1001)
    for terms in (4, 16, 64):
        error = np.abs(fold_series(x, HALF, terms) - triangle(x, HALF)).max()
        assert 0.9 < error / (2 * HALF / (np.pi**2 * terms)) <= 1.0
