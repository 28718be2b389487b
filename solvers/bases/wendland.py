r"""Wendland's radial functions of least degree, and their derivatives.

.. math::

    \varphi_{\ell,k}(r) = (1 - r)_+^{\ell + k}\, q_{\ell,k}(r), \qquad \ell = \lfloor d/2 \rfloor + k + 1,

positive definite in d dimensions and :math:`C^{2k}`; their Fourier transform decays like :math:`|\xi|^{-(d + 2k + 1)}`
(Wendland, *Scattered Data Approximation*, Cambridge 2005, section 9.4 and theorem 10.35). The polynomials here are
made by the dimension walk :math:`\varphi_{\ell,k} = I^k (1-r)_+^\ell`, :math:`(If)(r) = \int_r^1 t f(t)\,dt`, so that

.. math:: D\varphi_{\ell,k} = -\varphi_{\ell,k-1}, \qquad (Df)(r) = f'(r)/r,

gives all partial derivatives without a division by r: with :math:`\varphi(x) = f(|x|)`,
:math:`\partial_i \varphi = x_i\,Df`, :math:`\partial_i\partial_j \varphi = \delta_{ij} Df + x_i x_j D^2 f`, and so on.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import Polynomial

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array


@lru_cache(maxsize=64)
def profiles(dimension: int, smoothness: int, count: int) -> tuple[tuple[Polynomial, int], ...]:
    r"""Pairs (q, e) with :math:`D^j\varphi_{\ell,k} = (1-r)_+^e\,q(r)` for j = 0, ..., count - 1 <= k.

    Scaled to :math:`\varphi(0) = 1`.
    """
    exponent = dimension // 2 + smoothness + 1
    one_minus = Polynomial([1.0, -1.0])
    r = Polynomial([0.0, 1.0])
    # with s = 1 - r: I (s^e q) is s^(e+1) times a polynomial; integrate in powers of s
    functions = [(Polynomial([1.0]), exponent)]
    for _ in range(smoothness):
        q, e = functions[-1]
        in_s = (r * q)(one_minus)  # r q(r) as a polynomial of s
        integral = Polynomial(list(np.asarray(in_s.coef, dtype=float) / (e + 1 + np.arange(len(in_s.coef)))))
        functions.append((integral(one_minus), e + 1))
    size = float(functions[-1][0](0.0))
    chosen = functions[::-1][:count]
    return tuple(((-1) ** j * q / size, e) for j, (q, e) in enumerate(chosen))


def derivatives(offsets: Array, radius: float, smoothness: int, order: int) -> Array:
    """Partial derivatives of a Wendland function with support of the given radius.

    Parameters
    ----------
    offsets
        Points relative to the centre, shape (..., d).
    radius
        Radius of the support.
    smoothness
        k: the function has 2k continuous derivatives.
    order
        Highest derivative, at most k.

    Returns
    -------
    ndarray, shape (n_alpha, ...)
    """
    dimension = offsets.shape[-1]
    x = [offsets[..., axis] / radius for axis in range(dimension)]
    r: Array = np.sqrt(np.sum([component * component for component in x], axis=0))
    inside = np.maximum(1.0 - r, 0.0)
    radial = [
        _power(inside, e) * _horner(np.asarray(q.coef, dtype=float), r)
        for q, e in profiles(dimension, smoothness, order + 1)
    ]
    alphas = multi_indices(dimension, order)
    result = np.empty((len(alphas), *r.shape))
    for k, alpha in enumerate(alphas):
        total = np.zeros_like(r)
        for number, powers, coefficient in chain(alpha):
            term = coefficient * radial[number]
            for axis, power in enumerate(powers):
                for _ in range(power):
                    term = term * x[axis]
            total += term
        result[k] = total / radius ** sum(alpha)
    return result


def _power(values: Array, exponent: int) -> Array:
    """Power by repeated squaring, several times faster than ``**`` on arrays."""
    result: Array | None = None
    square = values
    while exponent:
        if exponent & 1:
            result = square if result is None else result * square
        exponent >>= 1
        if exponent:
            square = square * square
    return np.ones_like(values) if result is None else result


def _horner(coefficients: Array, r: Array) -> Array:
    total = np.full_like(r, coefficients[-1])
    for c in coefficients[-2::-1]:
        total *= r
        total += c
    return total


@lru_cache(maxsize=64)
def chain(alpha: tuple[int, ...]) -> tuple[tuple[int, tuple[int, ...], float], ...]:
    """Terms (j, powers, c) of d^alpha f(|x|) = sum c x^powers D^j f, by applying d_i (x^m D^j f) repeatedly."""
    terms: dict[tuple[int, tuple[int, ...]], float] = {(0, (0,) * len(alpha)): 1.0}
    for axis, times in enumerate(alpha):
        for _ in range(times):
            following: dict[tuple[int, tuple[int, ...]], float] = {}
            for (j, powers), c in terms.items():
                raised = tuple(m + (i == axis) for i, m in enumerate(powers))
                following[j + 1, raised] = following.get((j + 1, raised), 0.0) + c
                if powers[axis]:
                    lowered = tuple(m - (i == axis) for i, m in enumerate(powers))
                    following[j, lowered] = following.get((j, lowered), 0.0) + c * powers[axis]
            terms = following
    return tuple((j, powers, c) for (j, powers), c in terms.items())
