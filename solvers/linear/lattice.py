r"""Where the unknowns of a spline sit, and the same on coarser grids: the two-scale relation.

A B-spline on the cells of width 2h is a combination of those on the cells of width h.  With the index i living on the
cells ``i - p, ..., i``,

.. math:: B^{2h}_i = \sum_{j=0}^{p+1} 2^{-p} \binom{p+1}{j}\, B^h_{2i - p + j}

in each direction (Hoellig, *Finite Element Methods with B-Splines*, SIAM 2003, (3.11), shifted).  A WEB-spline of the
coarse grid is first written in all its B-splines (:mod:`solvers.extension`), these in the fine ones, and of the fine
coefficients the inner ones are kept; the fine space extends them to the outer ones in its own way,

.. math:: P = R\, T\, E_{2h}^T

(Hoellig, Reif, Wipper, Numer. Math. 91, 2002).  Polynomials of degree p are carried over exactly, and away from the
boundary every spline.  The coarse matrices are the energies of the coarse WEB-splines themselves,

.. math:: A_{2h} = E_{2h}\, T^T A^h\, T\, E_{2h}^T

with the matrix of all fine B-splines (:mod:`solvers.linear.coarse_stencil`): weight and coefficients are those of the
fine rules.  :math:`P^T A P` differs only next to the boundary, needs as many iterations, and takes thirty times as
long to compute.

The coarse grid has half as many cells, rounded up, from the same corner.  A coarse cell counts as inner when all of its
fine ones do, a fine cell when all its B-splines are free.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from solvers.assembly_reduction import reduce_sparse
from solvers.assembly_stencil import Stencil
from solvers.bases.basis import Space
from solvers.extension import Extension, Indices, Mask, extend, full_arrays, touched
from solvers.linear.coarse_stencil import coarse_shape, coarse_stencil, mask
from solvers.web import SplineSpace

if TYPE_CHECKING:
    pass


@dataclass(frozen=True, eq=False)
class Lattice:
    """Free coefficients of splines in the full tensor array, the same for every component.

    Attributes
    ----------
    shape, degree
        Full shape ``cells + p`` of the coefficient array, and p.
    free
        Which coefficients are unknowns, and how the others follow.
    stencils
        Energies of all B-splines, by pairs ``m <= m'`` of components.
    """

    shape: tuple[int, ...]
    degree: int
    free: Extension
    stencils: Mapping[tuple[int, int], Stencil]

    @property
    def size(self) -> int:
        """Number of unknowns of a component."""
        return len(self.free.dofs)

    @property
    def components(self) -> int:
        """Number of components."""
        return 1 + max(m for _, m in self.stencils)

    @cached_property
    def numbers(self) -> Indices:
        """Number of each unknown in the full array, -1 where there is none."""
        numbers = np.full(self.shape, -1, dtype=np.intp)
        numbers.ravel()[self.free.dofs] = np.arange(self.size)
        return numbers

    def matrix(self) -> Any:
        """CSR matrix of the unknowns, component after component."""
        from scipy.sparse import block_array

        blocks = {key: reduce_sparse(s, self.free, key[0] == key[1]) for key, s in self.stencils.items()}
        if len(blocks) == 1:
            return blocks[0, 0]
        blocks |= {(n, m): block.T for (m, n), block in blocks.items() if m < n}
        every = range(self.components)
        return block_array([[blocks.get((m, n)) for n in every] for m in every], format="csr")

    def coarser(self) -> tuple[Lattice, Any]:
        """Lattice of the grid with half as many cells, and the prolongation of a component from it.

        Returns
        -------
        tuple
            The coarse lattice, and the CSR matrix P of shape (size, coarse size).
        """
        p, shape = self.degree, coarse_shape(self.shape, self.degree)
        fine = full_arrays(self.numbers >= 0, p)
        # fine cells that a coarse one has beyond the grid count as outside
        whole = fine
        for axis in range(fine.ndim):
            view = np.moveaxis(np.concatenate([whole, np.zeros_like(whole.take([0], axis))], axis), axis, 0)
            count = (fine.shape[axis] + 1) // 2
            whole = np.moveaxis(view[: 2 * count : 2] & view[1 : 2 * count : 2], 0, axis)
        inner = touched(np.ascontiguousarray(whole), p)
        free = extend(inner, self._relevant(shape) | inner, p)
        stencils = {key: coarse_stencil(one) for key, one in self.stencils.items()}
        return Lattice(shape, p, free, stencils), (self._two_scale(shape) @ free.matrix(inner.size).T).tocsr()

    def _relevant(self, coarse: tuple[int, ...]) -> Mask:
        """Coarse indices whose B-splines contain a relevant fine one."""
        p = self.degree
        result: Mask = np.zeros(self.shape, dtype=bool)
        result.ravel()[self.free.dofs] = True
        result.ravel()[self.free.outer] = True
        for axis, size in enumerate(coarse):
            fine = np.moveaxis(result, axis, 0)
            padded = np.zeros((2 * size + p, *fine.shape[1:]), dtype=bool)
            padded[p : p + len(fine)] = fine
            found = [padded[a : a + 2 * size - 1 : 2] for a in range(p + 2)]
            result = np.moveaxis(np.logical_or.reduce(found), 0, axis)
        return np.ascontiguousarray(result)

    def _two_scale(self, coarse: tuple[int, ...]) -> Any:
        """Rows of the unknowns of the two-scale matrix, its columns the full coarse array."""
        from scipy.sparse import csr_array

        p, width = self.degree, (self.degree + 1) // 2 + 1
        factors = np.concatenate([[0.0], mask(p)])
        columns = np.zeros((self.size, 1), dtype=np.intp)
        values = np.ones((self.size, 1))
        for index, size in zip(np.unravel_index(self.free.dofs, self.shape), coarse, strict=True):
            # fine k meets the coarse i = k//2 + s, s = 0, 1, ..., with j = p + k - 2 i
            steps = np.arange(width)
            partner = np.minimum(index[:, None] // 2 + steps, size - 1)
            factor = factors[1 + p + (index % 2)[:, None] - 2 * steps]
            columns = (columns[:, :, None] * size + partner[:, None, :]).reshape(self.size, -1)
            values = (values[:, :, None] * factor[:, None, :]).reshape(self.size, -1)
        pointer = np.arange(self.size + 1) * columns.shape[1]
        shape = (self.size, int(np.prod(coarse)))
        scale = csr_array((values.ravel(), columns.ravel(), pointer), shape=shape)
        scale.eliminate_zeros()
        return scale


def lattice_of(spaces: Sequence[Space], stencils: Mapping[tuple[int, int], Stencil]) -> Lattice | None:
    """Lattice that all splines of a system share, None where there is none.

    Global functions, periodic splines, and splines of several spaces (``conditions: exact``) have none.
    """
    first = spaces[0]
    if not isinstance(first, SplineSpace) or first.periodic or any(space is not first for space in spaces):
        return None
    return Lattice(first.shape, first.degree, first.free, stencils)
