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
        Values at the m**d tensor Gauss nodes of n cells, each (n, m**d).
    nodes
        The m nodes of one direction.
    dim
        Dimension d.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    m = len(nodes)
    rough = np.zeros(len(functions[0]), dtype=bool)
    transform = legendre_transform(m)
    for values in functions:
        finite = np.asarray(np.isfinite(values).all(axis=1))
        rough |= ~finite
        coefficients = np.where(finite[:, None], values, 0.0).reshape((-1,) + (m,) * dim)
        largest = np.abs(coefficients).reshape(len(values), -1).max(axis=1)
        for axis in range(1, dim + 1):
            # only the two highest degrees along this axis; the other axes stay nodal values
            tail = np.tensordot(coefficients, transform[-2:], axes=(axis, 1))
            rough |= np.abs(tail).reshape(len(values), -1).max(axis=1) > TOLERANCE * largest
    return rough
