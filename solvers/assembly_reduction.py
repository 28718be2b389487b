r"""From all B-splines to the unknowns of a space: ``E A E^T`` and ``E f``.

With the free (inner) indices I, the dependent (outer) ones J and the extension ``E = (1, X)``,

.. math:: E A E^T = A_{II} + X A_{JI} + A_{IJ} X^T + X A_{JJ} X^T = A_{II} + Z + Z^T, \quad
          Z = X (A_{JI} + \tfrac12 A_{JJ} X^T)

for a symmetric matrix: only the part near the boundary is multiplied.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.assembly_stencil import Stencil
from solvers.extension import Extension

DENSE = 700
"""Up to this many relevant indices the matrix is always an array."""
DENSE_COUPLED = 6000
"""Up to this many it is one when an index couples to a tenth of the others."""
COLUMNS = 128
"""Columns multiplied at a time."""


def reduce_load(load: Array, free: Extension) -> Array:
    """Load of the unknowns."""
    outer = free.coefficients * load[free.outer, None]
    extended = np.bincount(free.sources.ravel(), outer.ravel(), minlength=len(free.dofs))
    reduced: Array = load[free.dofs] + extended
    return reduced


def reduce_matrix(stencil: Stencil, free: Extension, symmetric: bool) -> Any:
    """Matrix of the unknowns: an array when it is small or full anyway, else CSR."""
    relevant = len(free.dofs) + len(free.outer)
    if relevant <= DENSE:
        return _small(stencil, free, symmetric)
    coupled = 10 * (2 * stencil.degree + 1) ** len(stencil.shape) >= relevant
    if coupled and relevant <= DENSE_COUPLED:
        return _dense(stencil, free, symmetric)
    return reduce_sparse(stencil, free, symmetric)


def reduce_sparse(stencil: Stencil, free: Extension, symmetric: bool) -> Any:
    """Matrix of the unknowns as CSR."""
    correction = _correction(stencil, free, symmetric) if len(free.outer) else None
    return stencil.sparse(free.dofs, free.dofs, correction)


def _correction(stencil: Stencil, free: Extension, symmetric: bool) -> Any:
    """``Z + Z^T``, or what stands for it, as CSR with sorted rows."""
    extension = _sparse_extension(free)
    half = stencil.sparse(free.outer, free.dofs)
    image = extension @ stencil.sparse(free.outer, free.outer)
    if symmetric:
        half = extension @ (half + 0.5 * image.T)
        # the sum is symmetric: this only sorts its rows
        return (half + half.T).T.tocsr()
    result = extension @ half + ((stencil.sparse(free.dofs, free.outer) + image) @ extension.T)
    result.sort_indices()
    return result


def _dense(stencil: Stencil, free: Extension, symmetric: bool) -> Array:
    """Matrix of the unknowns as an array."""
    result = stencil.dense(free.dofs, free.dofs)
    if not len(free.outer):
        return result
    # sums in place: for large arrays fresh memory costs more than the arithmetic
    extension = _sparse_extension(free)
    half = stencil.dense(free.outer, free.dofs)
    image = _product(extension, stencil.dense(free.outer, free.outer))
    if symmetric:
        image *= 0.5
        half += image.T
        half = _product(extension, half)
        result += half
        result += half.T
    else:
        result += _product(extension, half)
        result += _product(extension, (stencil.dense(free.dofs, free.outer) + image).T).T
    return result


def _small(stencil: Stencil, free: Extension, symmetric: bool) -> Array:
    """Matrix of the unknowns with arrays throughout: few calls, for few unknowns."""
    split = len(free.dofs)
    order = np.concatenate([free.dofs, free.outer])
    full = stencil.dense(order, order)
    # rows may name a source twice (periodic splines)
    places = free.sources * len(free.outer) + np.arange(len(free.outer))[:, None]
    entries = np.bincount(places.ravel(), free.coefficients.ravel(), split * len(free.outer))
    extension = entries.reshape(split, len(free.outer))
    left = full[split:, :split]
    outer = extension @ full[split:, split:]
    result: Array = full[:split, :split]
    if symmetric:
        half = extension @ (left + 0.5 * outer.T)
        return result + half + half.T
    return result + extension @ left + (full[:split, split:] + outer) @ extension.T


def _product(extension: Any, matrix: Array) -> Array:
    """``X M`` in blocks of columns that stay in the cache."""
    result = np.empty((extension.shape[0], matrix.shape[1]))
    for start in range(0, matrix.shape[1], COLUMNS):
        piece = slice(start, start + COLUMNS)
        result[:, piece] = extension @ np.ascontiguousarray(matrix[:, piece])
    return result


def _sparse_extension(free: Extension) -> Any:
    """X as a sparse matrix, shape (dofs, outer)."""
    from scipy.sparse import csr_array

    width = free.sources.shape[1]
    pointer = np.arange(len(free.outer) + 1) * width
    transposed = csr_array(
        (free.coefficients.ravel(), free.sources.ravel(), pointer), shape=(len(free.outer), len(free.dofs))
    )
    return transposed.T.tocsr()
