r"""Storage of a matrix of tensor B-splines as a stencil, and its way to dense and sparse matrices.

Sums of element matrices of one parity (:mod:`solvers.assembly_parity`) keep it:

.. math:: A_{ij} = \sum_{\sigma} \Bigl(\prod_{\sigma_\nu = -} \operatorname{sign}(j_\nu - i_\nu)\Bigr)
          V^\sigma_{|j - i|,\,\min(i, j)}, \qquad |j_\nu - i_\nu| \le p,

minimum and modulus direction by direction. V has ``(p+1)^d`` numbers an index, entries are added in place,
and there is nothing to sort.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.assembly_parity import Parity

Indices = NDArray[np.integer[Any]]
WORK = 2_000_000
"""Entries looked up at a time on the way to a matrix."""


class Stencil:
    """A matrix over a full tensor array of B-splines, in stencil form.

    Parameters
    ----------
    shape
        Full shape of the index array.
    degree
        Degree p.
    """

    def __init__(self, shape: tuple[int, ...], degree: int) -> None:
        self.shape, self.degree = shape, degree
        self.size = int(np.prod(shape))
        self.values: dict[Parity, Array] = {}

    def array(self, parity: Parity) -> Array:
        """Flat storage of one parity."""
        if parity not in self.values:
            self.values[parity] = np.zeros((self.degree + 1) ** len(self.shape) * self.size)
        return self.values[parity]

    def dense(self, rows: Indices, columns: Indices) -> Array:
        """Submatrix of flat indices `rows` and `columns` as an array."""
        result = np.zeros((len(rows), len(columns)))
        for row, column, _, values in self._entries(rows, columns):
            result[row, column] = values
        return result

    def sparse(self, rows: Indices, columns: Indices) -> Any:
        """Submatrix of flat indices `rows` and `columns` (ascending) as a CSR matrix."""
        from scipy.sparse import csr_array

        data, indices, counts = [np.zeros(0)], [np.zeros(0, np.int32)], [np.zeros(1, np.intp)]
        for _, column, count, values in self._entries(rows, columns):
            data.append(values)
            indices.append(column)
            counts.append(count)
        pointer = np.cumsum(np.concatenate(counts))
        return csr_array(
            (np.concatenate(data), np.concatenate(indices), pointer), shape=(len(rows), len(columns))
        )

    def _entries(
        self, rows: Indices, columns: Indices
    ) -> Iterator[tuple[NDArray[np.intp], NDArray[np.int32], NDArray[np.intp], Array]]:
        """Entries inside the band, row by row, a chunk of rows at a time.

        Yields
        ------
        tuple
            Positions in `rows` and in `columns`, the number of entries in each row of the chunk, and the values.
        """
        p, dimension = self.degree, len(self.shape)
        number = self._numbering(columns)
        padded_strides = _strides(number.shape)
        offsets = np.indices((2 * p + 1,) * dimension).reshape(dimension, -1) - p
        weights = (p + 1) ** np.arange(dimension)[::-1]
        shift = (weights @ np.abs(offsets)) * self.size + _strides(self.shape) @ np.minimum(offsets, 0)
        neighbour = padded_strides @ offsets
        centre = padded_strides @ (np.stack(np.unravel_index(rows, self.shape)) + p)
        signs = {
            parity: np.prod([np.sign(offsets[axis]) for axis, sign in enumerate(parity) if sign < 0], axis=0)
            for parity in self.values
        }
        numbers = number.ravel()
        step = max(1, WORK // offsets.shape[1])
        for start in range(0, len(rows), step):
            piece = slice(start, start + step)
            target = numbers[centre[piece, None] + neighbour]
            inside = target >= 0
            where = (rows[piece, None] + shift)[inside]
            values = np.zeros(len(where))
            for parity, stored in self.values.items():
                if min(parity) > 0:
                    values += stored[where]
                else:
                    values += np.broadcast_to(signs[parity], inside.shape)[inside] * stored[where]
            count = inside.sum(axis=1)
            yield np.repeat(np.arange(start, start + len(count)), count), target[inside], count, values

    def _numbering(self, columns: Indices) -> NDArray[np.int32]:
        """Position of each index in `columns`, -1 elsewhere, with a margin of p around the full array."""
        number = np.full(tuple(n + 2 * self.degree for n in self.shape), -1, dtype=np.int32)
        inner = number[tuple(slice(self.degree, self.degree + n) for n in self.shape)]
        inner[np.unravel_index(columns, self.shape)] = np.arange(len(columns))
        return number


def _strides(shape: tuple[int, ...]) -> NDArray[np.intp]:
    """Strides in items of a C-ordered array."""
    return np.append(np.cumprod(shape[:0:-1])[::-1], 1).astype(np.intp)
