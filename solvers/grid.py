"""The uniform background grid.

Notation: the grid has ``N_j`` cells of width ``h_j`` in direction ``j`` and its lower corner at ``l``.  Cell ``k``
(a multi-index) is the box ``l + h*[k, k + 1]``; *unit coordinates* of a cell run over ``[0, 1]^d``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rfm.errors import DiscretizationError, GeometryError

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.box import Box

Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Grid:
    """Uniform cells on an axis-aligned box.

    Parameters
    ----------
    lower
        Lower corner, shape ``(d,)``.
    spacing
        Cell widths, shape ``(d,)``.
    cells
        Number of cells in each direction, shape ``(d,)``.
    """

    lower: Array
    spacing: Array
    cells: Integers

    def __post_init__(self) -> None:
        """Normalise to arrays and refuse what is not a grid."""
        object.__setattr__(self, "lower", np.atleast_1d(np.asarray(self.lower, dtype=np.float64)))
        object.__setattr__(self, "spacing", np.atleast_1d(np.asarray(self.spacing, dtype=np.float64)))
        object.__setattr__(self, "cells", np.atleast_1d(np.asarray(self.cells, dtype=np.int64)))
        if not self.lower.shape == self.spacing.shape == self.cells.shape or self.lower.ndim != 1:
            raise DiscretizationError("a grid needs a lower corner, a spacing and a cell count per direction")
        if not (np.all(np.isfinite(self.lower)) and np.all(self.spacing > 0) and np.all(self.cells >= 1)):
            raise DiscretizationError(
                f"a grid needs finite corners, positive spacings and at least one cell per direction, "
                f"got spacing {self.spacing.tolist()} and cells {self.cells.tolist()}"
            )

    @property
    def dimension(self) -> int:
        """Number of space dimensions."""
        return len(self.lower)

    @property
    def upper(self) -> Array:
        """Upper corner, shape ``(d,)``."""
        return np.asarray(self.lower + self.spacing * self.cells)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of cells in each direction as a tuple."""
        return tuple(int(n) for n in self.cells)

    @property
    def cell_volume(self) -> float:
        """Volume (area in 2D) of one cell."""
        return float(np.prod(self.spacing))

    @classmethod
    def cover(cls, box: Box, cells_longest: int, padding: float = 0.0) -> Grid:
        """Cover a box with cells, aligned with all its sides.

        ``n`` cells along the longest side fix ``h``; every direction gets ``max(1, ceil(L_j/h))`` cells of width
        ``L_j/n_j``.

        Parameters
        ----------
        box
            The box to cover; it must be bounded.
        cells_longest
            Cells along the longest side.
        padding
            Length added on every side before the cells are laid.

        Raises
        ------
        GeometryError
            If the box is unbounded or empty.
        DiscretizationError
            If there is not at least one cell.
        """
        lower, length = _bounded(box, padding)
        if cells_longest < 1:
            raise DiscretizationError(f"grid must have at least one cell, got {cells_longest}")
        h = length.max() / cells_longest
        cells = np.maximum(1, np.ceil(length / h - 1e-9)).astype(np.int64)
        return cls(lower, length / cells, cells)

    @classmethod
    def with_spacing(cls, box: Box, h: float) -> Grid:
        """Cover a box with cells of a given width from its lower corner (the last cells may stick out).

        Raises
        ------
        GeometryError
            If the box is unbounded or empty.
        DiscretizationError
            If ``h`` is not positive.
        """
        lower, length = _bounded(box, 0.0)
        if not (h > 0 and math.isfinite(h)):
            raise DiscretizationError(f"spacing must be positive, got {h:g}")
        cells = np.maximum(1, np.ceil(length / h - 1e-9)).astype(np.int64)
        return cls(lower, np.full(len(lower), float(h)), cells)

    def refined(self, factor: int = 2) -> Grid:
        """Return the grid with every cell cut into ``factor^d``."""
        return Grid(self.lower, self.spacing / factor, self.cells * factor)

    def corners(self, cells: Integers) -> Array:
        """Return the lower corners of cells ``(n, d)``, shape ``(n, d)``."""
        return np.asarray(self.lower + self.spacing * cells)

    def points(self, cells: Integers, unit: Array) -> tuple[Array, ...]:
        """Return physical coordinates of points given in unit coordinates of cells.

        Parameters
        ----------
        cells
            Cell indices, shape ``(n, d)``.
        unit
            Unit coordinates, shape ``(q, d)`` (the same in each cell) or ``(n, q, d)``.

        Returns
        -------
        tuple of arrays
            One array ``(n, q)`` per direction.
        """
        return tuple(
            self.lower[j] + self.spacing[j] * (cells[:, j, None] + unit[..., j])
            for j in range(self.dimension)
        )

    def locate(self, points: Array) -> tuple[Integers, Array]:
        """Return the cells ``(n, d)`` that hold points ``(n, d)`` and their unit coordinates ``(n, d)``.

        Points outside the grid are attributed to the nearest cell (their unit coordinates leave ``[0, 1]``).
        """
        scaled = (np.asarray(points, dtype=np.float64) - self.lower) / self.spacing
        cells = np.clip(np.floor(scaled), 0, self.cells - 1).astype(np.int64)
        return cells, scaled - cells


def _bounded(box: Any, padding: float) -> tuple[Array, Array]:
    lower = np.asarray(box.lower, dtype=np.float64) - padding
    upper = np.asarray(box.upper, dtype=np.float64) + padding
    if not (np.all(np.isfinite(lower)) and np.all(np.isfinite(upper))):
        raise GeometryError(
            "the domain is unbounded: intersect it with a bounded shape or give the grid a box"
        )
    if not np.all(upper > lower):
        raise GeometryError(f"the box {lower.tolist()} .. {upper.tolist()} is empty")
    return lower, upper - lower
