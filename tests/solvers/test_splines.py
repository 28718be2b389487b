"""Uniform B-splines on the unit span against scipy and against their defining properties."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from rfm.errors import DiscretizationError
from solvers.splines import MAX_DEGREE, require_degree, tables

DEGREES = range(1, MAX_DEGREE + 1)


@pytest.mark.parametrize("degree", DEGREES)
def test_all_derivatives_agree_with_scipy(degree):
    t = np.linspace(0.01, 0.99, 9)
    found = tables(degree, t, degree)
    for local in range(degree + 1):
        spline = BSpline.basis_element(np.arange(local - degree, local + 2), extrapolate=False)
        for order in range(degree + 1):
            expected = spline.derivative(order)(t) if order else spline(t)
            scale = np.abs(found[order]).max()
            np.testing.assert_allclose(found[order, :, local], expected, atol=1e-12 * scale)


@given(st.sampled_from(list(DEGREES)), st.floats(0, 1))
def test_partition_of_unity(degree, t):
    found = tables(degree, t, degree + 1)
    np.testing.assert_allclose(found[0].sum(), 1.0, rtol=1e-14)
    assert (found[0] >= 0).all()
    np.testing.assert_allclose(found[1:].sum(axis=-1), 0.0, atol=1e-10)


@given(st.sampled_from(list(DEGREES)), st.floats(0, 1))
def test_mirror_image(degree, t):
    np.testing.assert_allclose(tables(degree, t)[0], tables(degree, 1 - t)[0, ::-1], atol=1e-14)


@pytest.mark.parametrize("degree", DEGREES)
def test_derivatives_up_to_the_last_but_one_are_continuous_across_cells(degree):
    left, right = tables(degree, 1.0, degree - 1), tables(degree, 0.0, degree - 1)
    scale = np.abs(left).max()
    np.testing.assert_allclose(left[:, 1:], right[:, :-1], atol=1e-13 * scale)
    np.testing.assert_allclose(left[:, 0], 0.0, atol=1e-13 * scale)


def test_shapes_and_vanishing_derivatives():
    found = tables(2, np.full((4, 5), 0.3), 4)
    assert found.shape == (5, 4, 5, 3)
    assert not found[3:].any()


@pytest.mark.parametrize("degree", [0, 9])
def test_other_degrees_are_refused(degree):
    with pytest.raises(DiscretizationError, match="between 1 and 8"):
        require_degree(degree)
