r"""Conjugate gradients with symmetric successive overrelaxation, at the cost of one product a step.

With the unit diagonal, the strictly lower triangle L and :math:`0 < \omega < 2`,

.. math:: K = \tfrac1\omega I + L, \qquad A = K + K^T + \bigl(1 - \tfrac2\omega\bigr) I,

the preconditioned matrix is

.. math:: K^{-1} A\, K^{-T} p = w + K^{-1} \bigl(p + (1 - \tfrac2\omega)\, w\bigr), \qquad w = K^{-T} p

(Eisenstat, SIAM J. Sci. Stat. Comput. 2, 1981): two triangular solutions, each with half the entries of A.  Splines
of low degree need a third of the steps of Jacobi's preconditioner.  The triangular solutions are sweeps of PyAMG's
compiled Gauss-Seidel method over a triangle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.extension import Indices
from solvers.linear.iterative import Goal, iterate
from solvers.linear.system import ScaledSystem, nbytes

OMEGA = 1.5
"""Steps for 1.2, 1.4 and 1.6: 35, 30, 30 (ball, degree 2, 64 cells), 55, 60, 70 (degree 3, 24 cells), 120, 100, 80
(annulus, degree 2, 256 cells)."""
NEAR = 2.0
"""The residual of the original system is computed when the estimate is below this multiple of the tolerance."""
CHUNK = 100_000
"""Entries handled at a time."""


@dataclass(frozen=True)
class Overrelaxation:
    """Conjugate gradients with symmetric successive overrelaxation."""

    limit: int = 10_000

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve to the relative residual `tolerance`."""
        split = Split.of(system)
        system.kept["ssor"] = nbytes(split.lower, split.upper)
        null = np.linalg.qr(split.lower.T @ system.null)[0]

        def project(vector: Array) -> Array:
            return vector - null @ (null.T @ vector) if null.size else vector

        right = project(split.forward(system.project(system.scaled_load)))
        unscale = 1.0 / (system.scale * float(np.linalg.norm(system.load)))
        goal = Goal(Residual(split.lower, unscale, tolerance), tolerance, self.limit)
        found, steps = iterate(split.apply, right, goal, lambda v: v, project)
        return split.backward(found), steps


@dataclass(frozen=True, eq=False)
class Split:
    """The triangles K and K^T of a scaled matrix in CSR form.

    K^T is stored with rows and columns in reverse order, as another lower triangle: then each solution comes to the
    unknown it has just computed last in a row and need not wait for it (10 ms instead of 34, 9 million entries).
    """

    lower: Any
    upper: Any

    @staticmethod
    def of(system: ScaledSystem) -> Split:
        """Triangles with the diagonal 1/omega."""
        from scipy.sparse import csr_array

        matrix, scale = csr_array(system.original), system.scale
        matrix.sort_indices()
        n = len(scale)
        counts = np.zeros((2, n + 1), dtype=matrix.indptr.dtype)
        for _, rows, columns in _pieces(matrix):
            for side, kept in enumerate((columns <= rows, columns >= rows)):
                found = np.bincount(rows[kept] - rows[0])
                counts[side, rows[0] + 1 : rows[0] + 1 + len(found)] = found
        pointers = np.cumsum(counts, axis=1, dtype=counts.dtype)
        arrays = [(np.empty(end), np.empty(end, matrix.indices.dtype)) for end in pointers[:, -1]]
        for where, rows, columns in _pieces(matrix):
            entries = matrix.data[where] * scale[rows] * scale[columns]
            entries[rows == columns] = 1 / OMEGA
            for side, kept in enumerate((columns <= rows, columns >= rows)):
                first = pointers[side, rows[0]]
                last = first + np.count_nonzero(kept)
                if side:
                    data, indices = entries[kept][::-1], n - 1 - columns[kept][::-1]
                    first, last = pointers[1, -1] - last, pointers[1, -1] - first
                else:
                    data, indices = entries[kept], columns[kept]
                arrays[side][0][first:last], arrays[side][1][first:last] = data, indices
        pointers[1] = pointers[1, -1] - pointers[1, ::-1]
        lower, upper = (csr_array((*arrays[side], pointers[side]), shape=(n, n)) for side in range(2))
        return Split(lower, upper)

    def forward(self, right: Array) -> Array:
        """Return the solution of ``K x = b``."""
        return _solved(self.lower, right)

    def backward(self, right: Array) -> Array:
        """Return the solution of ``K^T x = b``."""
        return _solved(self.upper, np.ascontiguousarray(right[::-1]))[::-1]

    def apply(self, vector: Array) -> Array:
        """Return the preconditioned matrix times `vector`."""
        w = self.backward(vector)
        image: Array = w + self.forward(vector + (1 - 2 / OMEGA) * w)
        return image


def _pieces(matrix: Any) -> Iterator[tuple[slice, Indices, Indices]]:
    """Rows and columns of the entries of a CSR matrix, in pieces: large temporary arrays cost more than sums."""
    n = matrix.shape[0]
    step = max(1, CHUNK * n // max(matrix.nnz, 1))
    for start in range(0, n, step):
        pointer = matrix.indptr[start : start + step + 1]
        where = slice(int(pointer[0]), int(pointer[-1]))
        rows = np.repeat(
            np.arange(start, start + len(pointer) - 1, dtype=matrix.indices.dtype), np.diff(pointer)
        )
        yield where, rows, matrix.indices[where]


def _solved(triangle: Any, right: Array) -> Array:
    from pyamg.amg_core import gauss_seidel

    x = np.zeros_like(right)
    gauss_seidel(triangle.indptr, triangle.indices, triangle.data, x, right, 0, len(x), 1)
    return x


@dataclass(eq=False)
class Residual:
    """Relative residual of the original system from a preconditioned one.

    While it is far from the tolerance, it is estimated by the last ratio between both.
    """

    lower: Any
    unscale: Array
    tolerance: float
    ratio: float = 0.0

    def __call__(self, remainder: Array) -> float:
        """Of a preconditioned remainder."""
        size = float(np.linalg.norm(remainder))
        if size and not self.ratio * size > NEAR * self.tolerance:
            self.ratio = float(np.linalg.norm(self.unscale * (self.lower @ remainder))) / size
        return self.ratio * size
