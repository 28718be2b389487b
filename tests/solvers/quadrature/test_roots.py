from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solvers.quadrature import bernstein
from solvers.quadrature.roots import monotone_root, real_roots

seeds = st.integers(0, 2**32 - 1)
degrees = st.integers(1, 9)


def random_polynomials(seed: int, degree: int, count: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Bernstein coefficients and the same polynomials' values at Chebyshev points."""
    c = np.random.default_rng(seed).normal(size=(count, degree + 1))
    return c, c @ bernstein.basis(degree, bernstein.lobatto(degree)).T


@given(seeds, degrees)
def test_interpolation_inverts_evaluation(seed: int, degree: int) -> None:
    c, values = random_polynomials(seed, degree)
    np.testing.assert_allclose(bernstein.interpolate(values, 1), c, atol=1e-11)


@given(seeds, degrees)
def test_evaluation_agrees_with_the_basis(seed: int, degree: int) -> None:
    c, _ = random_polynomials(seed, degree)
    t = np.random.default_rng(seed).uniform(size=len(c))
    expected = (bernstein.basis(degree, t) * c).sum(axis=1)
    np.testing.assert_allclose(bernstein.evaluate(c, t), expected, atol=1e-13)
    np.testing.assert_allclose(bernstein.basis(degree, t).sum(axis=1), 1.0)


@given(seeds, degrees)
def test_halves_are_the_same_polynomial(seed: int, degree: int) -> None:
    c, _ = random_polynomials(seed, degree)
    left, right = bernstein.bisect(c, -1)
    t = np.linspace(0, 1, len(c))
    np.testing.assert_allclose(bernstein.evaluate(left, t), bernstein.evaluate(c, 0.5 * t), atol=1e-12)
    np.testing.assert_allclose(bernstein.evaluate(right, t), bernstein.evaluate(c, 0.5 + 0.5 * t), atol=1e-12)


@given(seeds, st.integers(1, 4))
def test_coefficients_bound_the_polynomial(seed: int, degree: int) -> None:
    c = np.random.default_rng(seed).normal(size=(1, degree + 1, degree + 1))
    t = np.linspace(0, 1, 20)
    basis = bernstein.basis(degree, t)
    values = np.einsum("nij,pi,qj->npq", c, basis, basis)
    low, high = bernstein.bounds(c, 2)
    assert low <= values.min() + 1e-13
    assert values.max() <= high + 1e-13


@given(seeds, degrees)
def test_derivative(seed: int, degree: int) -> None:
    c, _ = random_polynomials(seed, degree)
    t, step = np.full(len(c), 0.37), 1e-6
    difference = (bernstein.evaluate(c, t + step) - bernstein.evaluate(c, t - step)) / (2 * step)
    np.testing.assert_allclose(
        bernstein.evaluate(bernstein.derivative(c, -1), t), difference, rtol=1e-5, atol=1e-5
    )


@settings(deadline=None)
@given(seeds, st.integers(2, 9))
def test_all_roots_are_found(seed: int, degree: int) -> None:
    rng = np.random.default_rng(seed)
    roots = np.sort(rng.uniform(0.02, 0.98, degree))
    if degree > 1 and np.diff(roots).min() < 1e-2:
        return
    t = bernstein.lobatto(degree)
    values = np.prod(t[:, None] - roots, axis=1)
    index, found = real_roots(bernstein.interpolate(values[None], 1), np.array([1e-17]))
    assert (index == 0).all()
    np.testing.assert_allclose(np.sort(found), roots, atol=1e-6)


@given(st.floats(0.05, 0.95), st.floats(1e-6, 1e-2))
def test_close_pairs_of_roots(middle: float, gap: float) -> None:
    t = bernstein.lobatto(5)
    values = ((t - middle) ** 2 - gap**2 / 4) * (2.0 + t)
    _, found = real_roots(bernstein.interpolate(values[None], 1), np.array([1e-17]))
    inside = [r for r in (middle - gap / 2, middle + gap / 2) if 0 < r < 1]
    assert len(found) >= len(inside)
    for root in inside:
        assert np.abs(found - root).min() < 1e-7


def test_polynomials_without_roots_give_none() -> None:
    c = np.array([[1.0, -0.5, 1.0], [-1.0, -2.0, -0.1], [0.0, 0.0, 0.0]])
    index, roots = real_roots(c, np.full(3, 1e-14))
    assert len(index) == len(roots) == 0


@given(seeds, degrees)
def test_roots_of_monotone_polynomials(seed: int, degree: int) -> None:
    rng = np.random.default_rng(seed)
    c = np.cumsum(rng.exponential(size=(20, degree + 1)) + 1e-3, axis=1)
    c -= c[:, :1] + rng.uniform(0, 1, (20, 1)) * (c[:, -1:] - c[:, :1])
    c *= rng.choice([-1.0, 1.0], (20, 1))
    root = monotone_root(c)
    slope = np.abs(bernstein.evaluate(bernstein.derivative(c, -1), root))
    assert (np.abs(bernstein.evaluate(c, root)) <= 1e-14 * np.abs(c).max(axis=1) + 1e-15 * slope).all()


@pytest.mark.parametrize("curvature", [0.0, 1e-17, 1e-12, 1e-6, 1.0, 1e6])
def test_quadratic_root_without_cancellation(curvature: float) -> None:
    # curvature t^2 + t - 0.3 (curvature + 1): compare with a root in higher precision by Newton's method.
    a, b, c = curvature, 1.0, -0.3 * (curvature + 1.0)
    coefficients = np.array([[c, c + 0.5 * b, a + b + c]])
    t = np.longdouble(0.5)
    for _ in range(60):
        t -= (a * t * t + b * t + c) / (2 * a * t + b)
    assert monotone_root(coefficients)[0] == pytest.approx(float(t), rel=4e-16, abs=0)
