r"""Uniform B-splines on one grid cell.

Notation. The degree is ``p``, the grid cell is the unit span ``0 <= t <= 1``. The B-spline with index ``i`` lives on
the cells ``i - p, ..., i``; so exactly ``p + 1`` of them do not vanish on cell ``c``, with the indices ``c + a``,
``a = 0, ..., p``. :math:`\varphi_a^p` is the piece of the one with local number ``a``. Derivatives are with respect
to ``t``: divide by :math:`h^r` for the r-th derivative on a cell of width ``h``.

.. math::

    p\,\varphi_a^p(t) &= (t + p - a)\,\varphi_{a-1}^{p-1}(t) + (a + 1 - t)\,\varphi_a^{p-1}(t), \\
    \frac{d}{dt} \varphi_a^p &= \varphi_{a-1}^{p-1} - \varphi_a^{p-1}

(Hoellig, *Finite Element Methods with B-Splines*, SIAM 2003, (3.3) and (3.4), shifted to one cell). All terms of
the recursion are non-negative, so the values carry no cancellation at any degree.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError

MAX_DEGREE = 8


def require_degree(degree: int) -> None:
    """Check that `degree` is one the spaces are built and tested for.

    Raises
    ------
    DiscretizationError
        The degree is not 1, ..., 8.
    """
    if not 1 <= degree <= MAX_DEGREE:
        raise DiscretizationError(f"degree must be between 1 and {MAX_DEGREE}, got {degree}")


def tables(degree: int, t: ArrayLike, order: int = 0) -> Array:
    """Values and derivatives of the B-splines that do not vanish on the unit span.

    Parameters
    ----------
    degree
        Degree p.
    t
        Points in [0, 1], of any shape.
    order
        Highest derivative.

    Returns
    -------
    ndarray, shape (order + 1, *t.shape, degree + 1)
        ``[r, ..., a]`` is the r-th derivative of the B-spline with local number ``a``; zero for ``r > degree``.
    """
    points = np.asarray(t, dtype=float)
    result = np.zeros((order + 1, *points.shape, degree + 1))
    values = np.ones((*points.shape, 1))
    for q in range(degree + 1):
        if q:
            values = _raise_degree(values, points, q)
        if degree - q <= order:
            result[degree - q] = _difference(values, degree - q)
    return result


def _raise_degree(lower: Array, t: Array, degree: int) -> Array:
    """Values of degree `degree` from the values `lower` of one degree less."""
    raised = np.zeros((*t.shape, degree + 1))
    # (t + p - a) with a = 1..p and (a + 1 - t) with a = 0..p-1 hold the same numbers a' = 0..p-1 of `lower`
    count = np.arange(degree)
    raised[..., 1:] = (t[..., None] + (degree - 1 - count)) * lower
    raised[..., :-1] += (count + 1 - t[..., None]) * lower
    raised /= degree
    return raised


def _difference(values: Array, times: int) -> Array:
    """Coefficients of the `times`-th derivative: repeated differences of the lower-degree values."""
    for _ in range(times):
        edge = np.zeros((*values.shape[:-1], 1))
        values = np.concatenate([edge, values], axis=-1) - np.concatenate([values, edge], axis=-1)
    return values
