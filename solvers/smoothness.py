r"""Whether functions continue smoothly over a whole cell.

A moment-fitted rule is as good as the polynomial interpolant of the integrand at its nodes.  The
interpolant is expanded in Legendre polynomials, :math:`f = \sum_k c_k P_{k_1}(x_1)\cdots P_{k_d}(x_d)`; for a
smooth function the coefficients decay geometrically, for a kink or a jump they do not.  So the size of
the coefficients of the two highest degrees, relative to the largest, is the test.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array

TOLERANCE = 1e-4
"""Relative size of the highest Legendre coefficients above which a cell counts as rough."""


@lru_cache(maxsize=32)
def legendre_transform(count: int) -> Array:
    """Matrix (count, count) from values at Gauss nodes to orthonormal Legendre coefficients."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    degrees = np.arange(count)
    table = np.polynomial.legendre.legvander(nodes, count - 1) * np.sqrt(2 * degrees + 1)
    transform: Array = table.T * (weights / 2)
    return transform


def rough_cells(functions: Sequence[Array], nodes: Array, dim: int) -> NDArray[np.bool_]:
    """Cells on which some function is not finite or not smooth.

    Parameters
    ----------
    functions
        Values at the m**d tensor Gauss nodes of n cells, each (m**d, n); one that occurs again is looked at once.
    nodes
        The m nodes of one direction.
    dim
        Dimension d.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    m = len(nodes)
    rough = np.zeros(functions[0].shape[1], dtype=bool)
    highest = legendre_transform(m)[-2:]
    for values in {id(f): f for f in functions}.values():
        if not np.isfinite(values.sum()):
            finite = np.asarray(np.isfinite(values).all(axis=0))
            rough |= ~finite
            values = np.where(finite, values, 0.0)
        limit = TOLERANCE * _largest(values)
        for axis in range(dim):
            # only the two highest degrees along this axis; the other axes stay nodal values
            tail = np.matmul(highest, values.reshape(m**axis, m, -1))
            rough |= _largest(tail.reshape(-1, len(rough))) > limit
    return rough


def _largest(values: Array) -> Array:
    """Largest modulus in each column."""
    result: Array = np.maximum(values.max(axis=0), -values.min(axis=0))
    return result
