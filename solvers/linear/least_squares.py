r"""Overdetermined systems, ``|A x - b|`` as small as possible, by orthogonal transformations.

The normal equations :math:`A^T A x = A^T b` square the condition number; a QR factorisation of A does not.  Rows come
in *slabs* (the layers of cells along one direction), and a column lives in few of them.  So the factorisation moves
through the slabs with a *front*: the triangle of the columns that later slabs still meet.  Each slab is put below the
front and a dense QR made of both; the columns that no later slab meets are finished and leave.  That is
Lawson and Hanson's sequential accumulation for banded problems (*Solving Least Squares Problems*, 1974, chapter 27),
with columns that come and go as in a multifrontal QR (Davis, ACM TOMS 38, 2011).  It works with dense blocks, needs
memory for one front, and no products of A with itself are ever formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.linear import LinearSolution

EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Overdetermined:
    """Rows ``A x = b`` that can be satisfied only in the mean.

    Attributes
    ----------
    matrix
        CSR matrix A, shape (m, n).
    right
        Right-hand side b (m,).
    slabs
        Slab of each row (m,), any integers; rows are processed in their order.
    """

    matrix: Any
    right: Array
    slabs: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class _Finished:
    """Rows of R that are final: the columns they eliminate, the later ones they still meet, and Q^T b."""

    own: NDArray[np.intp]
    later: NDArray[np.intp]
    triangle: Array
    coupling: Array
    right: Array


def solve_by_qr(system: Overdetermined, reason: str, redundant: bool = False) -> LinearSolution:
    """Minimise ``|A x - b|``.

    Parameters
    ----------
    system
        The rows.
    reason
        Why this method.
    redundant
        The unknowns may depend on each other to rounding; then of all minima a small one is chosen.

    Raises
    ------
    NumericsError
        The columns of A are dependent to rounding, there are fewer rows than columns, or numbers are not finite.
    """
    count = system.matrix.shape[1]
    if system.matrix.shape[0] < count and not redundant:
        raise NumericsError(
            f"there are {system.matrix.shape[0]} equations for {count} unknowns: use more points, or basis: web-spline"
        )
    if not (np.isfinite(system.matrix.data).all() and np.isfinite(system.right).all()):
        raise NumericsError("the equations have entries that are not finite: check the data of the problem")
    norms = np.sqrt(np.bincount(system.matrix.indices, system.matrix.data**2, minlength=count))
    if not (norms > 0).all():
        raise NumericsError(_dependent(f"unknown {int(norms.argmin())} of {count} is in no equation"))
    if redundant:
        return _result(system, _truncated(system, norms) / norms, reason)
    finished = _factorise(system, norms)
    diagonal = np.abs(np.concatenate([np.diag(block.triangle) for block in finished]))
    if not diagonal.min() > 10 * EPSILON * np.sqrt(count) * diagonal.max():
        raise NumericsError(_dependent(f"smallest pivot {diagonal.min():.1e} of columns of length one"))
    return _result(system, _substitute(finished, count) / norms, reason)


def _result(system: Overdetermined, x: Array, reason: str) -> LinearSolution:
    """Solution with the size of the gradient that is left, relative to that at zero."""
    gradient = system.matrix.T @ (system.right - system.matrix @ x)
    size = float(np.linalg.norm(system.matrix.T @ system.right))
    residual = float(np.linalg.norm(gradient) / size) if size else 0.0
    return LinearSolution(x, residual, 0, "qr", reason)


def work_of_qr(system: Overdetermined) -> float:
    """Floating point operations of :func:`solve_by_qr`, from the widths of the fronts."""
    order, starts, last = _schedule(system)
    first = np.full(system.matrix.shape[1], len(starts))
    slab_of_row = np.empty(len(order), dtype=np.intp)
    slab_of_row[order] = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    entries = np.repeat(slab_of_row, np.diff(system.matrix.indptr))
    np.minimum.at(first, system.matrix.indices, entries)
    steps = np.arange(len(starts) - 1)
    widths = np.array([np.count_nonzero((first <= s) & (last >= s)) for s in steps], dtype=float)
    return float(np.sum(2 * (np.diff(starts) + widths) * widths**2))


def _schedule(system: Overdetermined) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Rows in the order of their slabs, where each slab starts in it, and the last slab of each column."""
    order = np.argsort(system.slabs, kind="stable")
    ranks = np.unique(system.slabs, return_inverse=True)[1]
    starts = np.searchsorted(ranks[order], np.arange(ranks.max() + 2))
    last = np.zeros(system.matrix.shape[1], dtype=np.intp)
    entries = np.repeat(ranks, np.diff(system.matrix.indptr))
    np.maximum.at(last, system.matrix.indices, entries)
    return order, starts, last


def _factorise(system: Overdetermined, norms: Array) -> list[_Finished]:
    """Move the front through the slabs; columns are scaled to length one."""
    order, starts, last = _schedule(system)
    front = np.zeros(0, dtype=np.intp)
    carried, carried_right = np.zeros((0, 0)), np.zeros(0)
    finished = []
    for slab in range(len(starts) - 1):
        rows = order[starts[slab] : starts[slab + 1]]
        block = system.matrix[rows]
        met = np.unique(block.indices)
        active = np.union1d(front, met)
        active = active[np.argsort(last[active], kind="stable")]
        stacked = np.zeros((len(carried) + len(rows), len(active)), order="F")
        stacked[: len(carried), _positions(active, front)] = carried
        stacked[len(carried) :, _positions(active, met)] = block[:, met].toarray() / norms[met]
        triangle, right = _triangularise(stacked, np.concatenate([carried_right, system.right[rows]]))
        done = int(np.count_nonzero(last[active] == slab))
        if done:
            if len(triangle) < done:
                raise NumericsError(_dependent("fewer equations than unknowns in a part of the domain"))
            finished.append(
                _Finished(
                    active[:done], active[done:], triangle[:done, :done], triangle[:done, done:], right[:done]
                )
            )
        front, carried, carried_right = active[done:], triangle[done:, done:], right[done:]
    return finished


def _truncated(system: Overdetermined, norms: Array) -> Array:
    """Solution without the combinations of unknowns that vanish to rounding: R from slab to slab, then its rank."""
    from scipy.linalg import lstsq

    triangle, turned = np.zeros((0, len(norms))), np.zeros(0)
    for start in range(0, len(system.right), 4 * len(norms)):
        piece = slice(start, start + 4 * len(norms))
        rows = np.asfortranarray(np.vstack([triangle, system.matrix[piece].toarray() / norms]))
        triangle, turned = _triangularise(rows, np.concatenate([turned, system.right[piece]]))
    found: Array = lstsq(triangle, turned, cond=10 * EPSILON, lapack_driver="gelsy")[0]
    return found


def _triangularise(block: Array, right: Array) -> tuple[Array, Array]:
    """R and Q^T b of a dense block, at most as many rows as columns."""
    from scipy.linalg.lapack import dgeqrf, dormqr

    factor, tau, _, info = dgeqrf(block, overwrite_a=1)
    if info != 0:
        raise NumericsError(f"the QR factorisation failed (code {info})")
    height = min(block.shape)
    reflectors = factor[:, :height]
    work = dormqr("L", "T", reflectors, tau, right[:, None], lwork=-1)[1]
    turned = dormqr("L", "T", reflectors, tau, right[:, None], lwork=int(work[0]))[0][:, 0]
    return np.triu(factor[:height]), turned[:height]


def _positions(active: NDArray[np.intp], columns: NDArray[np.intp]) -> NDArray[np.intp]:
    """Where `columns` stand in `active`."""
    order = np.argsort(active)
    return np.asarray(order[np.searchsorted(active, columns, sorter=order)])


def _substitute(finished: list[_Finished], count: int) -> Array:
    """Back substitution, last slab first."""
    from scipy.linalg import solve_triangular

    x = np.zeros(count)
    for block in reversed(finished):
        x[block.own] = solve_triangular(block.triangle, block.right - block.coupling @ x[block.later])
    return x


def _dependent(why: str) -> str:
    return (
        f"the equations do not determine the unknowns ({why}): fix the solution with a Dirichlet or Robin condition, "
        "use more points, basis: web-spline, or a lower degree"
    )
