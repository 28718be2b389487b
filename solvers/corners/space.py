r"""The space of the functions of all corners: few functions, known in closed form, that live on all of the domain.

Its unknowns stand behind those of the spline.  Pairs of a spline and a corner function, and of two corner functions,
are summed at points; the table of a batch is made once for both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.bases.basis import Mask
from solvers.corners.enrichment import Enriched
from solvers.grid import Grid
from solvers.point_tables import local_indices, node_table, order_of, spline_table
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.web import SplineSpace

Batch = TensorBatch | PointBatch
Blocks = Mapping[tuple[int, int], Array]


@dataclass(frozen=True, eq=False)
class CornerSpace:
    """Functions of corners on the background grid of a domain (:class:`solvers.bases.basis.Space`)."""

    grid: Grid
    corners: tuple[Enriched, ...]
    _latest: list[Any] = field(default_factory=list)

    degree = 0
    """They are no splines."""
    redundant = False
    """They come last, and the solver drops those that splines represent (:mod:`solvers.linear.bordered`)."""

    @property
    def n_dofs(self) -> int:
        """Number of functions."""
        return sum(corner.functions.count for corner in self.corners)

    @property
    def delicate_cells(self) -> Mask:
        """None: no function lives on a sliver."""
        return np.zeros(self.grid.shape, dtype=bool)

    @property
    def constant(self) -> Array:
        """They are not needed for constants."""
        return np.zeros(self.n_dofs)

    def affine(self, shift: float, slope: Array) -> Array:
        """They are not needed for affine functions."""
        return np.zeros(self.n_dofs)

    def table(self, batch: Batch, order: int) -> Array:
        """Derivatives of all functions at the nodes of a batch, shape (n_alpha, n_dofs, n, q)."""
        if self._latest and self._latest[0] is batch and self._latest[1] == order:
            known: Array = self._latest[2]
            return known
        x, y = batch.points(self.grid)
        with np.errstate(all="ignore"):
            tables = [corner.table(x.ravel(), y.ravel(), order) for corner in self.corners]
        joined = tables[0] if len(tables) == 1 else np.concatenate(tables, axis=1)
        found = joined.reshape(*joined.shape[:2], *x.shape)
        self._latest[:] = [batch, order, found]
        return found

    def assembler(self, symmetric: bool = True) -> CornerAssembler:
        """Accumulate a form of two corner functions."""
        return CornerAssembler(self, symmetric)

    def function(self, unknowns: Array) -> CornerField:
        """The function with the given coefficients."""
        return CornerField(self, np.asarray(unknowns, dtype=float))

    def load(self, coefficients: Array) -> CornerField:
        """The function that was stored with these coefficients.

        Raises
        ------
        DiscretizationError
            Their number is wrong.
        """
        if coefficients.shape != (self.n_dofs,):
            raise DiscretizationError(
                f"coefficients of corner functions have the shape {coefficients.shape}, expected ({self.n_dofs},)"
            )
        return self.function(coefficients)

    def intensities(self, unknowns: Array) -> tuple[dict[str, Any], ...]:
        """Point, angle in degrees, exponent and intensity of the leading singular function of each corner."""
        first = np.cumsum([0, *(c.functions.count for c in self.corners[:-1])])
        return tuple(
            {
                "point": list(c.corner.point),
                "angle": float(np.degrees(c.corner.angle)),
                "exponent": c.functions.exponents[0],
                "intensity": float(unknowns[k]) * c.functions.intensity_factor,
            }
            for k, c in zip(first, self.corners, strict=True)
        )


@dataclass(frozen=True, eq=False)
class CornerField:
    """A sum of corner functions (:class:`solvers.bases.basis.Psi`)."""

    space: CornerSpace
    coefficients: Array

    @property
    def grid(self) -> Grid:
        """Background grid."""
        return self.space.grid

    @property
    def degree(self) -> int:
        """Not a spline's."""
        return self.space.degree

    def jet(self, batch: Batch, order: int) -> Array:
        """Partial derivatives up to `order` at the nodes of `batch`, shape (n_alpha, n, q)."""
        found: Array = np.einsum("aknq,k->anq", self.space.table(batch, order), self.coefficients)
        return found

    def plus(self, constant: float) -> CornerField:
        """The same: a constant is added to the spline.

        Raises
        ------
        DiscretizationError
            Always: with corner functions a value is prescribed somewhere.
        """
        raise DiscretizationError(f"corner functions hold no constant, {constant} cannot be added")


class CornerAssembler:
    """Matrix and load of the corner functions."""

    def __init__(self, space: CornerSpace, symmetric: bool) -> None:
        self.space, self.symmetric = space, symmetric
        self._matrix = np.zeros((space.n_dofs, space.n_dofs))
        self._load = np.zeros(space.n_dofs)

    def add(self, batch: Batch, blocks: Blocks, loads: Mapping[int, Array]) -> None:
        """Add the integrals over `batch`."""
        if not len(batch.cells) or not (blocks or loads):
            return
        table = self.space.table(batch, order_of([*blocks, *((a, a) for a in loads)], 2))
        flat = table.reshape(*table.shape[:2], -1)
        for (alpha, beta), values in blocks.items():
            part = flat[alpha] @ (values.ravel() * flat[beta]).T
            self._matrix += part if alpha == beta or not self.symmetric else part + part.T
        for alpha, values in loads.items():
            self._load += flat[alpha] @ values.ravel()

    def finish(self) -> tuple[Any, Array]:
        """Matrix and load."""
        return self._matrix, self._load


class SplineCornerAssembler:
    """Matrix between splines (rows) and corner functions (columns)."""

    def __init__(self, rows: SplineSpace, columns: CornerSpace) -> None:
        self.rows, self.columns = rows, columns
        self._full = np.zeros((int(np.prod(rows.shape)), columns.n_dofs))

    def add(self, batch: Batch, blocks: Blocks, loads: Mapping[int, Array]) -> None:
        """Add the integrals over `batch`; there are no loads between two spaces.

        Raises
        ------
        ValueError
            A load is given.
        """
        if loads:
            raise ValueError("a form between two spaces has no load")
        if not len(batch.cells) or not blocks:
            return
        from scipy.sparse import csc_array

        order = order_of(blocks, 2)
        left, right = spline_table(self.rows, node_table(batch), order), self.columns.table(batch, order)
        element = np.zeros(())
        for alpha in {a for a, _ in blocks}:
            image = sum(values * right[b] for (a, b), values in blocks.items() if a == alpha)
            # (k, n, q) times (q, splines), the same for all cells of a tensor rule
            element = element + (
                image @ left[alpha][0]
                if len(left[alpha]) == 1
                else np.matmul(image.swapaxes(0, 1), left[alpha]).swapaxes(0, 1)
            )
        index = local_indices(self.rows, np.asarray(batch.cells))
        entries = index.size  # a matrix with a one in each column adds up what belongs to a spline
        columns = csc_array(
            (np.ones(entries), index.ravel(), np.arange(entries + 1)), (len(self._full), entries)
        )
        self._full += columns @ element.reshape(len(element), -1).T

    def finish(self) -> tuple[Any, Array]:
        """Matrix (n_dofs of the splines, n_dofs of the corner functions), and an empty load."""
        return np.asarray(self.rows.extension @ self._full), np.zeros(0)
