r"""Whether functions continue smoothly over a whole cell.

A moment-fitted rule is as good as the polynomial interpolant of the integrand at its nodes.  The
interpolant is expanded in Legendre polynomials, :math:`f = \sum_k c_k P_{k_1}(x_1)\cdots P_{k_d}(x_d)`; for a
smooth function the coefficients decay geometrically, for a kink or a jump they do not.  So the size of
the coefficients of the two highest degrees, relative to the largest, is the test.

With few nodes a smooth function may still fail it where cells are large.  Then the decay decides: let a, b and c be the
largest value and the largest coefficients of the two degrees below the highest two and of these.  A geometric
sequence has :math:`a c = b^2`, coefficients of entire functions and of polynomials fall faster; a kink so weak that
c is some thousandths of a has an :math:`a c` of many times :math:`b^2`, because b is hardly larger than c.  (A ball
without a cylinder, p = 2, 40 cells across: 176 of 8896 cut cells are rough instead of 4400, the error is the same.)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array

TOLERANCE = 1e-4
"""Relative size of the highest Legendre coefficients up to which a cell counts as smooth."""
WEAK = 3e-3
"""Relative size up to which it does when the coefficients decay fast."""
DECAY = 0.5
"""Largest ``a c / b^2`` of a fast decay."""
TOGETHER = 100_000
"""Numbers looked at in one call."""


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
    distinct = list({id(f): f for f in functions}.values())
    step = max(1, TOGETHER // max(1, distinct[0].size))
    for start in range(0, len(distinct), step):
        # few cells: many functions in one call; many cells: one by one, without a copy
        values = np.stack(distinct[start : start + step]) if step > 1 else distinct[start][None]
        if not np.isfinite(values.sum()):
            finite = np.asarray(np.isfinite(values).all(axis=1))
            rough |= ~finite.all(axis=0)
            values = np.where(finite[:, None], values, 0.0)
        largest = _largest(values)
        for axis in range(dim):
            tail = _coefficients(values, axis, m, slice(m - 2, m))
            function, cell = np.nonzero(tail > TOLERANCE * largest)
            if len(cell) and m >= 6:
                doubtful = np.ascontiguousarray(values[function, :, cell].T)[None]
                b = _coefficients(doubtful, axis, m, slice(m - 4, m - 2))[0]
                a, c = largest[function, cell], tail[function, cell]
                cell = cell[(c > WEAK * a) | (a * c > DECAY * b**2)]
            rough[cell] = True
    return rough


def _coefficients(values: Array, axis: int, m: int, degrees: slice) -> Array:
    """Largest coefficients of some degrees along one axis, at the nodes of the others: by function and cell."""
    count, _, cells = values.shape
    found = np.matmul(legendre_transform(m)[degrees], values.reshape(count * m**axis, m, -1))
    return _largest(found.reshape(count, -1, cells))


def _largest(values: Array) -> Array:
    """Largest modulus at the nodes, by function and cell."""
    result: Array = np.maximum(values.max(axis=1), -values.min(axis=1))
    return result
