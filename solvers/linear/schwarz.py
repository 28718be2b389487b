r"""Multiplicative Schwarz method on overlapping tiles: the smoother for splines of every degree.

B-splines of degree p are ill-conditioned as a basis, as :math:`4^{pd}`, and the smooth fields among the badly
scaled ones are not what a coarse grid sees.  All of it is local: exact solutions on tiles that overlap, one after the
other,

.. math:: x \mathrel{+}= R_k^T (R_k A R_k^T)^{-1} R_k (b - A x), \qquad k = 1, 2, \dots

do away with it (de la Riva, Rodrigo, Gaspar, SIAM J. Sci. Comput. 41, 2019; de Prenter, Verhoosel, van Brummelen,
CMAME 358, 2019, for splines cut by a boundary).  The tiles are boxes of indices, the same all over; at the boundary
they hold the unknowns that are there, whatever their weight.  A sweep backwards is the adjoint of one forwards, so
both together are a symmetric smoother.  The loops over tiles are PyAMG's, compiled.

The inverses are computed in double precision and kept in that of the matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from rfm.calculus.types import Array
from solvers.extension import Indices
from solvers.linear.lattice import Lattice

WORK = 1_000_000
"""Numbers inverted at a time."""

CHUNK = 100_000
"""Entries scaled at a time."""

Integers = NDArray[np.integer[Any]]


@dataclass(frozen=True, eq=False)
class Schwarz:
    """Sweeps over the tiles of a CSR matrix.

    Attributes
    ----------
    matrix
        The matrix A, in the precision of the sweeps.
    members, ends
        Unknowns of all tiles, ascending in each, and where each tile begins and ends.
    inverses, corners
        Inverses of the diagonal blocks row by row, and where each begins and ends.
    """

    matrix: Any
    members: Integers
    ends: Integers
    inverses: NDArray[np.floating[Any]]
    corners: Integers

    @staticmethod
    def of(matrix: Any, scale: Array, tiles: Indices, kind: DTypeLike = float) -> Schwarz:
        """Tiles of ``S A S``, A a CSR matrix of doubles with sorted indices, S the diagonal matrix of `scale`.

        Parameters
        ----------
        matrix, scale
            A and the diagonal of S.
        tiles
            Unknowns of each tile, shape (t, m), filled up with -1.
        kind
            Precision to keep.
        """
        count = (tiles >= 0).sum(axis=1)
        ends, corners = (np.append(0, np.cumsum(size)) for size in (count, count**2))
        large = max(int(corners[-1]), matrix.nnz) > np.iinfo(np.int32).max
        index = np.int64 if large else np.int32
        ordered = np.sort(tiles, axis=1)
        members: Integers = ordered[ordered >= 0].astype(index)
        whole = (
            matrix.indptr.astype(index, copy=False),
            matrix.indices.astype(index, copy=False),
            matrix.data,
        )
        inverses = np.empty(corners[-1], dtype=kind)
        first = 0
        while first < len(count):
            last = max(first + 1, int(np.searchsorted(corners, corners[first] + WORK, "right")) - 1)
            piece = slice(first, last)
            blocks = _inverted(whole, scale, members[ends[first] : ends[last]], count[piece])
            inverses[corners[first] : corners[last]] = blocks
            first = last
        kept = type(matrix)((scaled_entries(matrix, scale, kind), whole[1], whole[0]), shape=matrix.shape)
        return Schwarz(kept, members, ends.astype(index), inverses, corners.astype(index))

    @property
    def nbytes(self) -> int:
        """Memory of the tiles."""
        return int(self.members.nbytes + self.inverses.nbytes)

    def sweep(self, x: Array, load: Array, backwards: bool = False) -> None:
        """Improve `x` in place."""
        from pyamg.amg_core import overlapping_schwarz_csr

        count = len(self.ends) - 1
        order = (count - 1, -1, -1) if backwards else (0, count, 1)
        sparse = (self.matrix.indptr, self.matrix.indices, self.matrix.data)
        tiles = (self.inverses, self.corners, self.members, self.ends)
        overlapping_schwarz_csr(*sparse, x, load, *tiles, count, len(x), *order)


def _inverted(whole: tuple[Any, Any, Array], scale: Array, members: Integers, count: Indices) -> Array:
    """Inverses of the scaled diagonal blocks on tiles of `count` unknowns each, one after the other."""
    from pyamg.amg_core import extract_subblocks

    pointer, columns, data = whole
    ends, corners = (np.append(0, np.cumsum(size)).astype(pointer.dtype) for size in (count, count**2))
    blocks = np.zeros(int(corners[-1]))
    extract_subblocks(*(pointer, columns, data, blocks, corners, members, ends), len(count), len(scale))
    for size in np.unique(count):
        chosen = count == size
        where = corners[:-1][chosen, None] + np.arange(size**2)
        s = scale[members[ends[:-1][chosen, None] + np.arange(size)]]
        inverse = np.linalg.inv(blocks[where].reshape(-1, size, size) * (s[:, :, None] * s[:, None, :]))
        blocks[where] = (0.5 * (inverse + inverse.transpose(0, 2, 1))).reshape(where.shape)
    return blocks


def scaled_entries(matrix: Any, scale: Array, kind: DTypeLike) -> NDArray[np.floating[Any]]:
    """Entries of ``S A S`` for a CSR matrix A; in chunks, for large temporary arrays cost more than products."""
    data = np.empty(matrix.nnz, dtype=kind)
    step = max(1, CHUNK * len(scale) // max(matrix.nnz, 1))
    for start in range(0, len(scale), step):
        pointer = matrix.indptr[start : start + step + 1]
        piece = slice(pointer[0], pointer[-1])
        rows = np.repeat(scale[start : start + step], np.diff(pointer))
        data[piece] = matrix.data[piece] * rows * scale[matrix.indices[piece]]
    return data


def tiled(lattice: Lattice, edge: int, stride: int) -> Indices:
    """Boxes of ``edge^d`` indices every `stride` indices.

    Returns
    -------
    ndarray, shape (t, edge^d)
        Numbers of the unknowns in each box that has any, -1 where the box has none.
    """
    dimension = len(lattice.shape)
    padded = np.pad(lattice.numbers, edge, constant_values=-1)
    strides = np.array(padded.strides) // padded.itemsize
    # the first box begins before the first index, so that all indices are in equally many boxes
    starts = np.meshgrid(*(np.arange(stride, n + edge, stride) for n in lattice.shape), indexing="ij")
    corner = strides @ np.stack([s.ravel() for s in starts])
    local = strides @ np.indices((edge,) * dimension).reshape(dimension, -1)
    boxes = padded.ravel()[corner[:, None] + local]
    return np.asarray(boxes[(boxes >= 0).any(axis=1)], dtype=np.intp)
