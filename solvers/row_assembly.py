r"""Assembly of the rows of an overdetermined system: one row for each point and each equation.

A row ``entries . z = right`` in the jets z of the splines becomes
:math:`\sqrt{\omega} \sum_{m,\alpha} e_{m\alpha}(x)\, \partial^\alpha B_{m,i}(x)` in their coefficients.  The rows are
made of the *positive* rules: their squares are the functional, and a root of a negative weight there is none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.background import Background
from solvers.bases.basis import Space
from solvers.equations.density import Density
from solvers.equations.squares import PulledRow, SquaredDensity
from solvers.linear.least_squares import Overdetermined
from solvers.point_tables import local_indices, node_table, order_of, spline_table
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.web import SplineSpace
from structures.jet_matrix import JetMatrix, stacked

if TYPE_CHECKING:
    from solvers.pipeline import Assembly

CHUNK = 20_000
"""Points evaluated at a time."""


class RowAssembler:
    """Collects weighted rows over batches of points.

    Parameters
    ----------
    spaces
        Space of each spline.
    """

    def __init__(self, spaces: Sequence[Space]) -> None:
        self.spaces = tuple(spaces)
        self._matrices: list[Any] = []
        self._rights: list[Array] = []
        self._slabs: list[NDArray[np.int64]] = []
        self._axis = int(np.argmax(self.spaces[0].grid.cells))

    def add(self, batch: TensorBatch | PointBatch, rows: Sequence[PulledRow]) -> None:
        """Add one row for each of `rows` and each point of `batch` with a positive weight."""
        from scipy.sparse import hstack

        counted = np.flatnonzero(batch.weights.ravel() > 0)
        if not len(counted):
            return
        tables = [table_of(space, batch, rows, m) for m, space in enumerate(self.spaces)]
        slab = np.repeat(batch.cells[:, self._axis], batch.weights.shape[1])[counted]
        for row in rows:
            scale = np.sqrt(batch.weights * row.weight)
            pieces = [table.matrix(row, scale, counted) for table in tables]
            self._matrices.append(pieces[0] if len(pieces) == 1 else hstack(pieces, format="csr"))
            self._rights.append((scale * row.right).ravel()[counted])
            self._slabs.append(slab)

    def add_density(self, batch: TensorBatch | PointBatch, density: Density, jet: JetMatrix) -> None:
        """Add the rows of a density.

        Raises
        ------
        TypeError
            It is not a sum of squares.
        """
        if not isinstance(density, SquaredDensity):
            raise TypeError("only a sum of squares has rows")
        self.add(batch, density.rows(jet))

    def finish(self) -> Overdetermined:
        """Return the system in the unknowns of all splines, spline after spline."""
        from scipy.sparse import vstack

        return Overdetermined(
            vstack(self._matrices, format="csr"), np.concatenate(self._rights), np.concatenate(self._slabs)
        )


class _SplineTables:
    """Derivatives of the splines of one space at the points of a batch, cell by cell."""

    def __init__(self, space: SplineSpace, batch: TensorBatch | PointBatch, order: int, psi: int) -> None:
        self.space, self.psi = space, psi
        self.values = spline_table(space, node_table(batch), order)
        self.indices = local_indices(space, batch.cells)

    def matrix(self, row: PulledRow, scale: Array, counted: NDArray[np.intp]) -> Any:
        """Rows of the chosen points, as CSR in the unknowns of the space."""
        from scipy.sparse import csr_array

        cells, points = scale.shape
        width = self.indices.shape[1]
        element = np.zeros((cells, points, width))
        for (m, alpha), entry in row.entries.items():
            if m == self.psi:
                element += (entry * scale)[:, :, None] * self.values[alpha]
        columns = np.repeat(self.indices, points, axis=0)[counted]
        pointer = np.arange(len(counted) + 1) * width
        shape = (len(counted), int(np.prod(self.space.shape)))
        full = csr_array((element.reshape(-1, width)[counted].ravel(), columns.ravel(), pointer), shape=shape)
        return full @ self.space.extension.T


class _GlobalTables:
    """Derivatives of the functions of a space that all overlap, at the points of a batch."""

    def __init__(self, space: Any, batch: TensorBatch | PointBatch, order: int, psi: int) -> None:
        nodes = np.broadcast_to(node_table(batch), (*batch.weights.shape, batch.cells.shape[1]))
        self.psi, self.values = psi, space.table(batch.cells, nodes, order)

    def matrix(self, row: PulledRow, scale: Array, counted: NDArray[np.intp]) -> Any:
        """Rows of the chosen points, as CSR in the unknowns of the space."""
        from scipy.sparse import csr_array

        total = np.zeros((len(counted), self.values.shape[2]))
        for (m, alpha), entry in row.entries.items():
            if m == self.psi:
                factor = np.broadcast_to(entry * scale, scale.shape).ravel()[counted]
                total += factor[:, None] * self.values[alpha][counted]
        return csr_array(total)


def table_of(
    space: Space, batch: TensorBatch | PointBatch, rows: Sequence[PulledRow], psi: int
) -> _SplineTables | _GlobalTables:
    """Table of the derivatives that `rows` take of the spline number `psi`.

    Raises
    ------
    DiscretizationError
        The functions of the space cannot be tabulated at points.
    """
    keys = {(0, alpha): np.zeros(0) for row in rows for m, alpha in row.entries if m == psi}
    order = order_of(keys, batch.cells.shape[1]) if keys else 0
    if isinstance(space, SplineSpace):
        return _SplineTables(space, batch, order, psi)
    if hasattr(space, "table"):
        return _GlobalTables(space, batch, order, psi)
    raise DiscretizationError(
        f"{type(space).__name__} has no rows for a QR factorisation: use basis: web-spline"
    )


def assemble_rows(assembly: Assembly) -> Overdetermined:
    """Rows of a method that squares residuals, at the points of the positive rules of domain and boundary."""
    rows = RowAssembler(assembly.assembler.spaces)
    method = assembly.method
    for part in assembly.parts():
        problem = part.problem
        for batch in positive_batches(part.background):
            coords = batch.points(part.background.grid)
            jet = stacked(part.structure, coords, method.order(problem))
            rows.add_density(batch, method.volume(problem, coords), jet)
        for piece, density, jet in part.boundary_densities():
            rows.add_density(piece, density, jet)
    return rows.finish()


def positive_batches(background: Background) -> Iterator[TensorBatch | PointBatch]:
    """Rules of the inner and of the cut cells, in chunks."""
    rules = background.rules
    yield from chain(rules.inner.chunks(CHUNK), rules.cut.chunks(CHUNK))
