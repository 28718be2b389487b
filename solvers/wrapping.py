r"""Periodic splines: coefficients one period apart are one unknown, up to a factor.

On a grid of n cells along a period the B-splines i and i + n are translates of each other, so a spline with
:math:`\psi(x + T) = c\,\psi(x)` has :math:`c_{i + n} = c\, c_i`, and all its derivatives follow suit.  The
unknowns are those of the indices 0, ..., n - 1 along the axis.

The cells are unrolled: continued periodically beyond both faces, so far that whatever an index of the period may be
attached to lies in them.  There outer indices are extended to inner ones as ever (:mod:`solvers.extension`), across the
seam too, and the indices are then folded back, each fold with the factor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.extension import Extension, Indices, Mask, extend, no_extension, touched

Wraps = Mapping[int, float]
"""Factor c of each axis along which the splines are periodic."""

EXTENSIONS: dict[str, Callable[[Mask, Mask, int], Extension]] = {
    "web-spline": extend,
    "b-spline": no_extension,
}
"""What becomes of outer indices, by the name of the basis."""


def wrapped(inside: Mask, active: Mask, degree: int, wraps: Wraps, basis: str) -> Extension:
    """Return which coefficients of periodic splines are free, and how the others follow.

    Parameters
    ----------
    inside, active
        Cells that lie in the domain, and those with quadrature points, of the grid's shape.
    degree
        Degree p.
    wraps
        The periodic axes; the grid covers one period along each of them.
    basis
        A name in :data:`EXTENSIONS`.

    Raises
    ------
    DiscretizationError
        A period has too few cells for its splines not to overlap themselves.
    """
    for axis in wraps:
        if inside.shape[axis] <= degree:
            raise DiscretizationError(
                f"periodic splines of degree {degree} need {degree + 1} cells or more in a period, got "
                f"{inside.shape[axis]} along {'xyz'[axis]}: refine `grid`"
            )
    margin = 2 * degree + inside.ndim + 1
    unrolled = [_unrolled(cells, wraps, margin) for cells in (inside, active)]
    inner, relevant = (touched(cells, degree) for cells in unrolled)
    found = EXTENSIONS[basis](inner, relevant, degree)
    torus = _Torus(inside.shape, degree, wraps, margin)

    dofs = torus.inside(found.dofs, inner.shape)
    position = np.full(torus.size, -1, dtype=np.intp)
    position[dofs] = np.arange(len(dofs))
    exposed = torus.inside(found.exposed, inner.shape)

    kept = torus.holds(found.outer, inner.shape)
    homes, factors = torus.folded(found.dofs[found.sources[kept]], inner.shape)
    sources, coefficients = position[homes], found.coefficients[kept] * factors
    outer = torus.inside(found.outer, inner.shape)

    copies, originals, powers = torus.copies()
    free = position[originals] >= 0
    width = (degree + 1) ** inside.ndim
    of_free = np.zeros((int(free.sum()), width), dtype=np.intp)
    of_free[:, 0] = position[originals[free]]
    weights = np.zeros(of_free.shape)
    weights[:, 0] = powers[free]
    row = np.full(torus.size, -1, dtype=np.intp)
    row[outer] = np.arange(len(outer))
    tied = row[originals] >= 0
    targets = np.concatenate([outer, copies[free], copies[tied]])
    order = np.argsort(targets, kind="stable")
    again = np.isin(originals, exposed)
    return Extension(
        dofs,
        np.sort(np.concatenate([exposed, copies[again]])),
        targets[order],
        np.concatenate([sources, of_free, sources[row[originals[tied]]]])[order],
        np.concatenate([coefficients, weights, coefficients[row[originals[tied]]] * powers[tied, None]])[
            order
        ],
    )


def _unrolled(cells: Mask, wraps: Wraps, margin: int) -> Mask:
    for axis in wraps:
        count = cells.shape[axis]
        cells = cells.take(np.arange(-margin, count + margin) % count, axis=axis)
    return cells


@dataclass(frozen=True, eq=False)
class _Torus:
    """Bookkeeping between unrolled indices, those of the full array, and those of one period."""

    cells: tuple[int, ...]
    degree: int
    wraps: Wraps
    margin: int

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(n + self.degree for n in self.cells)

    @property
    def size(self) -> int:
        return int(np.prod(self.shape))

    def where(self, flat: Indices, unrolled: tuple[int, ...]) -> Indices:
        """Multi-indices of unrolled ones, shape (d, *flat.shape); outside of one period too."""
        index = np.stack(np.unravel_index(flat, unrolled))
        for axis in self.wraps:
            index[axis] -= self.margin
        return index

    def holds(self, flat: Indices, unrolled: tuple[int, ...]) -> Mask:
        """Which unrolled indices lie in the period."""
        index = self.where(flat, unrolled)
        within = [(index[axis] >= 0) & (index[axis] < self.cells[axis]) for axis in self.wraps]
        return np.asarray(np.logical_and.reduce(within))

    def inside(self, flat: Indices, unrolled: tuple[int, ...]) -> Indices:
        """Flat indices in the full array of those that lie in the period."""
        index = self.where(flat[self.holds(flat, unrolled)], unrolled)
        return np.asarray(np.ravel_multi_index(tuple(index), self.shape), dtype=np.intp)

    def folded(self, flat: Indices, unrolled: tuple[int, ...]) -> tuple[Indices, Array]:
        """Flat indices of the period that unrolled ones stand for, and their factors."""
        return self._fold(self.where(flat, unrolled))

    def copies(self) -> tuple[Indices, Indices, Array]:
        """Flat indices of the full array beyond the period, those that they repeat, and the factors."""
        index = np.indices(self.shape).reshape(len(self.shape), -1)
        beyond = np.logical_or.reduce([index[axis] >= self.cells[axis] for axis in self.wraps])
        index = index[:, beyond]
        home, factor = self._fold(index)
        return np.flatnonzero(beyond), home, factor

    def _fold(self, index: Indices) -> tuple[Indices, Array]:
        index, factor = index.copy(), np.ones(index.shape[1:])
        for axis, c in self.wraps.items():
            turns = index[axis] // self.cells[axis]
            index[axis] -= turns * self.cells[axis]
            factor *= np.where(turns % 2, c, 1.0)  # c is 1 or -1
        return np.asarray(np.ravel_multi_index(tuple(index), self.shape), dtype=np.intp), factor
