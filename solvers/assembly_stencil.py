r"""Storage of a matrix of tensor B-splines as a stencil, and its way to dense and sparse matrices.

Sums of element matrices of one parity (:mod:`solvers.assembly_parity`) keep it:

.. math:: A_{ij} = \sum_{\sigma} \Bigl(\prod_{\sigma_\nu = -} \operatorname{sign}(j_\nu - i_\nu)\Bigr)
          V^\sigma_{|j - i|,\,\min(i, j)}, \qquad |j_\nu - i_\nu| \le p,

minimum and modulus direction by direction. V has ``(p+1)^d`` numbers an index, entries are added in place,
and there is nothing to sort.
"""

from __future__ import annotations

from functools import cached_property
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
        self.length = (degree + 1) ** len(shape) * self.size
        # one more number, always zero: where entries outside the band are read from
        self.values: dict[Parity, Array] = {}

    def array(self, parity: Parity) -> Array:
        """Flat storage of one parity."""
        if parity not in self.values:
            self.values[parity] = np.zeros(self.length + 1)
        return self.values[parity]

    def dense(self, rows: Indices, columns: Indices) -> Array:
        """Submatrix of flat indices `rows` and `columns`."""
        result = np.zeros((len(rows), len(columns)))
        if not (len(rows) and len(columns)):
            return result
        row, column = np.unravel_index(rows, self.shape), np.unravel_index(columns, self.shape)
        step = max(1, WORK // len(columns))
        for start in range(0, len(rows), step):
            piece = slice(start, start + step)
            where = np.zeros((len(rows[piece]), len(columns)), dtype=np.intp)
            for axis, line in enumerate(self._line_positions):
                where += line[row[axis][piece]][:, column[axis]]
            np.minimum(where, self.length, out=where)
            for parity, values in self.values.items():
                found = values[where]
                for axis, sign in enumerate(parity):
                    if sign < 0:
                        found *= np.sign(column[axis][None, :] - row[axis][piece, None])
                result[piece] += found
        return result

    def sparse(self, rows: Indices, columns: Indices) -> Any:
        """Submatrix of flat indices `rows` and `columns` (ascending) as a CSR matrix without zeros."""
        from scipy.sparse import csr_array

        p, dimension = self.degree, len(self.shape)
        number = self._numbering(columns)
        margin_strides = _strides(number.shape)
        offsets = np.indices((2 * p + 1,) * dimension).reshape(dimension, -1) - p
        strides = _strides(self.shape)
        powers = np.array([(p + 1) ** (dimension - 1 - axis) for axis in range(dimension)])
        shift = (powers @ np.abs(offsets)) * self.size + strides @ np.minimum(offsets, 0)
        row = np.stack(np.unravel_index(rows, self.shape))
        padded = margin_strides @ (row + p)
        neighbour = margin_strides @ offsets
        signs = {
            parity: np.prod([np.sign(offsets[a]) for a, s in enumerate(parity) if s < 0], axis=0, dtype=float)
            for parity in self.values
        }
        data, indices, counts = [], [], [np.zeros(1, dtype=np.intp)]
        step = max(1, WORK // offsets.shape[1])
        flat_number = number.ravel()
        for start in range(0, len(rows), step):
            piece = slice(start, start + step)
            target = flat_number[padded[piece, None] + neighbour]
            inside = target >= 0
            where = (np.asarray(rows)[piece, None] + shift)[inside]
            entries = np.zeros(len(where))
            for parity, values in self.values.items():
                factor = np.broadcast_to(signs[parity], inside.shape)[inside] if min(parity) < 0 else 1.0
                entries += factor * values[where]
            kept = entries != 0.0
            data.append(entries[kept])
            indices.append(target[inside][kept])
            present = np.zeros(inside.shape, dtype=bool)
            present[inside] = kept
            counts.append(present.sum(axis=1))
        pointer = np.cumsum(np.concatenate(counts))
        joined = (np.concatenate([*data, np.zeros(0)]), np.concatenate([*indices, np.zeros(0, np.int32)]), pointer)
        return csr_array(joined, shape=(len(rows), len(columns)))

    @cached_property
    def _line_positions(self) -> list[NDArray[np.intp]]:
        """Position of an index pair in one direction; beyond the storage for pairs outside the band."""
        strides = _strides(self.shape)
        result = []
        for axis, n in enumerate(self.shape):
            i, j = np.arange(n)[:, None], np.arange(n)[None, :]
            step = (self.degree + 1) ** (len(self.shape) - 1 - axis) * self.size
            position = np.minimum(i, j) * strides[axis] + np.abs(i - j) * step
            result.append(np.where(np.abs(i - j) <= self.degree, position, self.length))
        return result

    def _numbering(self, columns: Indices) -> NDArray[np.int32]:
        """Position of each index in `columns`, -1 elsewhere, with a margin of p around the full array."""
        number = np.full(tuple(n + 2 * self.degree for n in self.shape), -1, dtype=np.int32)
        inner = number[tuple(slice(self.degree, self.degree + n) for n in self.shape)]
        inner[np.unravel_index(columns, self.shape)] = np.arange(len(columns))
        return number


def _strides(shape: tuple[int, ...]) -> NDArray[np.intp]:
    """Strides in items of a C-ordered array."""
    return np.append(np.cumprod(shape[:0:-1])[::-1], 1).astype(np.intp)
