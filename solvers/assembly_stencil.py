r"""Storage of a matrix of tensor B-splines as a stencil, and its way to dense and sparse matrices.

Sums of element matrices of one parity (:mod:`solvers.assembly_parity`) keep it:

.. math:: A_{ij} = \sum_{\sigma} \Bigl(\prod_{\sigma_\nu = -} \operatorname{sign}(j_\nu - i_\nu)\Bigr)
          V^\sigma_{|j - i|,\,\min(i, j)}, \qquad |j_\nu - i_\nu| \le p,

minimum and modulus direction by direction. V has ``(p+1)^d`` numbers an index, entries are added in place,
and there is nothing to sort.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.assembly_parity import Parity
from solvers.extension import full_arrays

Indices = NDArray[np.integer[Any]]
Numbers = NDArray[np.int32]
WORK = 200_000
"""Entries looked up at a time on the way to a matrix: they stay in the cache."""


@dataclass(frozen=True, eq=False)
class Band:
    """The offsets ``j - i`` of the entries of a row, and where they lead.

    Attributes
    ----------
    offsets
        All of them, shape (d, width), the last direction fastest.
    stored
        Place of the entry in the storage of a parity, relative to i.
    neighbour
        Place of j in an array with a margin of p on all sides, relative to that of ``i - p``.
    """

    offsets: NDArray[np.intp]
    stored: NDArray[np.intp]
    neighbour: NDArray[np.intp]

    def signs(self, parity: Parity) -> NDArray[np.intp]:
        """Product of the signs of the offsets in the antisymmetric directions."""
        chosen = [axis for axis, sign in enumerate(parity) if sign < 0]
        signs: NDArray[np.intp] = np.sign(self.offsets[chosen]).prod(axis=0)
        return signs


@lru_cache(maxsize=64)
def band(shape: tuple[int, ...], degree: int) -> Band:
    """Band of the splines of a degree on an index array of the given full shape."""
    dimension = len(shape)
    offsets = np.indices((2 * degree + 1,) * dimension).reshape(dimension, -1) - degree
    weights = (degree + 1) ** np.arange(dimension)[::-1]
    stored = (weights @ np.abs(offsets)) * int(np.prod(shape)) + _strides(shape) @ np.minimum(offsets, 0)
    return Band(offsets, stored, _strides(_padded(shape, degree)) @ (offsets + degree))


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
        band, number = self._band, self._numbering(columns).ravel()
        # what lies outside goes to one more column
        result = np.zeros((len(rows), len(columns) + 1))
        corners, step = self._corners(rows), max(1, WORK // band.stored.size)
        for start in range(0, len(rows), step):
            piece = slice(start, start + step)
            target = number.take(corners[piece, None] + band.neighbour)
            np.put_along_axis(result[piece], target, self._values(rows[piece]), axis=1)
        return result[:, :-1]

    def sparse(self, rows: Indices, columns: Indices, added: Any = None) -> Any:
        """Submatrix of flat indices `rows` and `columns`, both ascending, as a CSR matrix.

        Most rows are *whole*: the columns of all their band are there, and nothing is added.  They are written to
        their final place without a search and without a copy: fresh memory costs more than the arithmetic.

        Parameters
        ----------
        rows, columns
            Flat indices.
        added
            CSR matrix with sorted rows to be added, in which few rows have entries.
        """
        from scipy.sparse import csr_array

        number, width = self._numbering(columns), self._band.stored.size
        complete = full_arrays(number >= 0, 2 * self.degree).ravel()[rows]
        if added is not None:
            complete &= np.diff(added.indptr) == 0
        near, whole = np.flatnonzero(~complete), np.flatnonzero(complete)
        step = max(1, WORK // width)
        parts = []
        for start in range(0, len(near), step):
            chosen = near[start : start + step]
            part = self._searched(rows[chosen], number, len(columns))
            parts.append((chosen, part if added is None else part + added[chosen]))
        counts = np.full(len(rows), width)
        for chosen, part in parts:
            counts[chosen] = np.diff(part.indptr)
        pointer = np.append(0, np.cumsum(counts))
        pointer = pointer.astype(np.int32 if pointer[-1] <= np.iinfo(np.int32).max else np.int64)
        data, indices = np.empty(pointer[-1]), np.empty(pointer[-1], pointer.dtype)
        for chosen, part in parts:
            place = np.repeat(pointer[chosen] - part.indptr[:-1], counts[chosen]) + np.arange(part.nnz)
            data[place], indices[place] = part.data, part.indices
        for start in range(0, len(whole), step):
            chosen = whole[start : start + step]
            place = pointer[chosen, None] + np.arange(width)
            data[place] = self._values(rows[chosen])
            indices[place] = self._columns(rows[chosen], number)
        result = csr_array((data, indices, pointer), shape=(len(rows), len(columns)))
        result.has_canonical_format = True
        return result

    @property
    def _band(self) -> Band:
        return band(self.shape, self.degree)

    def _values(self, rows: Indices) -> Array:
        """Entries of rows, shape (rows, width); any number where the band leaves the array."""
        where = rows[:, None] + self._band.stored
        values = np.zeros(where.shape)
        for parity, stored in self.values.items():
            entries = stored.take(where, mode="clip")
            values += entries if min(parity) > 0 else self._band.signs(parity) * entries
        return values

    def _columns(self, rows: Indices, number: Numbers) -> Numbers:
        """Columns of whole rows: columns are ascending, so those of a line of the last direction are consecutive."""
        length = 2 * self.degree + 1
        first = number.ravel().take(self._corners(rows)[:, None] + self._band.neighbour[::length])
        columns: NDArray[Any] = (first[:, :, None] + np.arange(length, dtype=np.int32)).reshape(
            len(rows), self._band.stored.size
        )
        return columns

    def _searched(self, rows: Indices, number: Numbers, columns: int) -> Any:
        """A few rows of which only some of the band may be there, as a CSR matrix."""
        from scipy.sparse import csr_array

        target = number.ravel().take(self._corners(rows)[:, None] + self._band.neighbour)
        inside = target >= 0
        pointer = np.append(0, np.cumsum(inside.sum(axis=1)))
        return csr_array((self._values(rows)[inside], target[inside], pointer), shape=(len(rows), columns))

    def _corners(self, rows: Indices) -> NDArray[np.intp]:
        """Place of ``i - p`` in an array with a margin of p."""
        strides = _strides(_padded(self.shape, self.degree))
        corners: NDArray[np.intp] = strides @ np.stack(np.unravel_index(rows, self.shape))
        return corners

    def _numbering(self, columns: Indices) -> Numbers:
        """Position of each index in `columns`, -1 elsewhere, with a margin of p around the full array."""
        number = np.full(_padded(self.shape, self.degree), -1, dtype=np.int32)
        inner = number[tuple(slice(self.degree, self.degree + n) for n in self.shape)]
        inner[np.unravel_index(columns, self.shape)] = np.arange(len(columns))
        return number


def _padded(shape: tuple[int, ...], margin: int) -> tuple[int, ...]:
    """Shape with a margin on all sides."""
    return tuple(n + 2 * margin for n in shape)


def _strides(shape: tuple[int, ...]) -> NDArray[np.intp]:
    """Strides in items of a C-ordered array."""
    return np.append(np.cumprod(shape[:0:-1])[::-1], 1).astype(np.intp)
