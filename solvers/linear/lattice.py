r"""Where the unknowns of a spline sit, and the same on coarser grids: the two-scale relation.

A B-spline on the cells of width 2h is a combination of those on the cells of width h.  With the index i living on the
cells ``i - p, ..., i``,

.. math:: B^{2h}_i = \sum_{j=0}^{p+1} 2^{-p} \binom{p+1}{j}\, B^h_{2i - p + j}

in each direction (Hoellig, *Finite Element Methods with B-Splines*, SIAM 2003, (3.11), shifted).  A WEB-spline of the
coarse grid is first written in all its B-splines (:mod:`solvers.extension`), these in the fine ones, and of the fine
coefficients the inner ones are kept; the fine space extends them to the outer ones in its own way,

.. math:: P = R\, T\, E_{2h}^T

(Hoellig, Reif, Wipper, Numer. Math. 91, 2002).  Polynomials of degree p are carried over exactly, and away from the
boundary every spline.  The weight and the coefficients of the problem are in the matrix only: the coarse matrices
are :math:`P^T A P`.

The coarse grid has half as many cells, rounded up, from the same corner.  A coarse cell counts as inner when all of its
fine ones do, a fine cell when all its B-splines are free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import comb
from typing import Any

import numpy as np

from solvers.bases.basis import Space
from solvers.extension import Extension, Indices, Mask, extend, full_arrays, touched
from solvers.web import SplineSpace


@dataclass(frozen=True, eq=False)
class Lattice:
    """Free coefficients of a spline in the full tensor array.

    Attributes
    ----------
    shape, degree
        Full shape ``cells + p`` of the coefficient array, and p.
    free
        Which coefficients are unknowns, and how the others follow.
    """

    shape: tuple[int, ...]
    degree: int
    free: Extension

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.free.dofs)

    @cached_property
    def numbers(self) -> Indices:
        """Number of each unknown in the full array, -1 where there is none."""
        numbers = np.full(self.shape, -1, dtype=np.intp)
        numbers.ravel()[self.free.dofs] = np.arange(self.size)
        return numbers

    def coarser(self) -> tuple[Lattice, Any]:
        """Lattice of the grid with half as many cells, and the prolongation from it.

        Returns
        -------
        tuple
            The coarse lattice, and the CSR matrix P of shape (size, coarse size).
        """
        p = self.degree
        fine = full_arrays(self.numbers >= 0, p)
        cells = tuple((n + 1) // 2 for n in fine.shape)
        # fine cells that a coarse one has beyond the grid count as outside
        padded = np.zeros(tuple(2 * n for n in cells), dtype=bool)
        padded[tuple(slice(0, n) for n in fine.shape)] = fine
        paired = padded.reshape([m for n in cells for m in (n, 2)])
        whole: Mask = np.logical_and.reduce(paired, axis=tuple(range(1, 2 * len(cells), 2)))
        inner = touched(whole, p)
        scale = self._two_scale(inner.shape)
        seen = np.bincount(scale.indices, scale.data, minlength=inner.size).reshape(inner.shape) > 0
        free = extend(inner, seen, p)
        coarse = Lattice(inner.shape, p, free)
        return coarse, (scale @ free.matrix(inner.size).T).tocsr()

    def _two_scale(self, coarse: tuple[int, ...]) -> Any:
        """Rows of the unknowns of the two-scale matrix, its columns the full coarse array."""
        from scipy.sparse import csr_array

        p, width = self.degree, (self.degree + 1) // 2 + 1
        mask = np.array([comb(p + 1, j) / 2**p if 0 <= j <= p + 1 else 0.0 for j in range(-1, p + 2)])
        columns = np.zeros((self.size, 1), dtype=np.intp)
        values = np.ones((self.size, 1))
        for index, size in zip(np.unravel_index(self.free.dofs, self.shape), coarse, strict=True):
            # fine k meets the coarse i = k//2 + s, s = 0, 1, ..., with j = p + k - 2 i
            steps = np.arange(width)
            partner = np.minimum(index[:, None] // 2 + steps, size - 1)
            factor = mask[1 + p + (index % 2)[:, None] - 2 * steps]
            columns = (columns[:, :, None] * size + partner[:, None, :]).reshape(self.size, -1)
            values = (values[:, :, None] * factor[:, None, :]).reshape(self.size, -1)
        pointer = np.arange(self.size + 1) * columns.shape[1]
        shape = (self.size, int(np.prod(coarse)))
        scale = csr_array((values.ravel(), columns.ravel(), pointer), shape=shape)
        scale.eliminate_zeros()
        return scale


def lattice_of(spaces: Sequence[Space]) -> Lattice | None:
    """Lattice that all splines of a system share, None where there is none.

    Global functions, periodic splines, and splines of several spaces (``conditions: exact``) have none.
    """
    first = spaces[0]
    if not isinstance(first, SplineSpace) or first.periodic or any(space is not first for space in spaces):
        return None
    return Lattice(first.shape, first.degree, first.free)
