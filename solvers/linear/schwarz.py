r"""Additive Schwarz blocks: what takes the place of the diagonal in a smoother for splines of high degree.

B-splines of degree p are ill-conditioned as a basis, as :math:`4^{pd}`, and the smooth fields among the badly
scaled ones are not what a coarse grid sees.  All of it is local: exact solutions on tiles that overlap,

.. math:: B = W \sum_k R_k^T (R_k A R_k^T)^{-1} R_k\, W, \qquad W = \text{(number of tiles an unknown is in)}^{-1/2},

do away with it (de la Riva, Rodrigo, Gaspar, SIAM J. Sci. Comput. 41, 2019, multiplicative; de Prenter, Verhoosel, van
Brummelen, CMAME 358, 2019, for splines cut by a boundary).  The tiles are boxes of indices, the same all over; at
the boundary they hold the unknowns that are there, whatever their weight.  The inverses are computed in double and
kept in single precision: half the memory and its traffic, the same number of iterations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.extension import Indices
from solvers.linear.lattice import Lattice

WORK = 2_000_000
"""Numbers handled at a time on the way to the tiles."""
CLASSES = 8
"""Sizes, at most, that tiles are padded to."""


@dataclass(frozen=True, eq=False)
class Schwarz:
    """Inverses of the diagonal blocks of a matrix on overlapping tiles.

    Attributes
    ----------
    groups
        Tiles of equal size: their unknowns (t, m), padded with n, and the inverses (t, m, m).
    weight
        W, with a zero appended for the padding.
    """

    groups: tuple[tuple[Indices, NDArray[np.float32]], ...]
    weight: Array

    @staticmethod
    def of(matrix: Any, tiles: Indices) -> Schwarz:
        """Blocks of a CSR matrix on `tiles`, shape (t, m), filled up with -1."""
        n = matrix.shape[0]
        weight = np.append(np.bincount(tiles[tiles >= 0], minlength=n) ** -0.5, 0.0)
        tiles = -np.sort(-tiles, axis=1)  # padding last
        count = (tiles >= 0).sum(axis=1)
        step = -(-tiles.shape[1] // CLASSES)
        size = np.minimum(-(-count // step) * step, tiles.shape[1])
        groups = []
        for width in np.unique(size):
            members = tiles[size == width, :width]
            groups.append((np.where(members < 0, n, members), inverses(matrix, members)))
        return Schwarz(tuple(groups), weight)

    def __call__(self, vector: Array) -> Array:
        """B times `vector`."""
        source = np.append(vector, 0.0) * self.weight
        result = np.zeros_like(source)
        for members, blocks in self.groups:
            part = np.matmul(blocks, source[members][:, :, None].astype(np.float32))
            result += np.bincount(members.ravel(), part.ravel(), minlength=len(result))
        result *= self.weight
        return result[:-1]


def inverses(matrix: Any, tiles: Indices) -> NDArray[np.float32]:
    """Inverses of the diagonal blocks of a matrix, each padded with the identity where the tile has -1."""
    width = tiles.shape[1]
    result = np.empty((len(tiles), width, width), dtype=np.float32)
    step = max(1, WORK // width**2)
    for start in range(0, len(tiles), step):
        piece = slice(start, start + step)
        inverse = np.linalg.inv(diagonal_blocks(matrix, tiles[piece]))
        result[piece] = 0.5 * (inverse + inverse.transpose(0, 2, 1))
    return result


def diagonal_blocks(matrix: Any, tiles: Indices) -> Array:
    """Diagonal blocks of a CSR matrix, padded with the identity."""
    count, width = tiles.shape
    n = matrix.shape[0]
    result = np.zeros((count, width, width))
    step = max(1, min(WORK // n, WORK * n // (width * matrix.nnz)))
    place = np.full((min(step, count), n), -1, dtype=np.int32)  # of each unknown in each tile of a piece
    for start in range(0, count, step):
        piece = tiles[start : start + step]
        tile, position = np.nonzero(piece >= 0)
        members = piece[tile, position]
        place[tile, members] = position
        rows = matrix[members]
        row = np.repeat(np.arange(len(members)), np.diff(rows.indptr))
        column = place.ravel()[tile[row] * n + rows.indices]
        kept = np.flatnonzero(column >= 0)
        row = row[kept]
        result[start + tile[row], position[row], column[kept]] = rows.data[kept]
        place[tile, members] = -1
    tile, position = np.nonzero(tiles < 0)
    result[tile, position, position] = 1.0
    return result


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
