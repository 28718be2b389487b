r"""Assembly of a form between two different spline spaces on one grid.

.. math:: A_{ij} = \sum_k \sum_{\alpha\alpha'} C_{\alpha\alpha'}(x_k)\,
          \partial^\alpha B_i(x_k)\, \partial^{\alpha'} B'_j(x_k)

The second space is a small one (a collar near part of the boundary), so the cells that neither space uses are
skipped.  Elements come as for one space: factorised on tensor nodes, which scattered points are turned into
(:mod:`solvers.assembly_folding`).  They are added in place to an array indexed by the offset ``j - i`` and by the
number of i among the splines that live on the used cells.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.assembly_folding import parts
from solvers.assembly_parity import Form, Kind
from solvers.assembly_tensor import TensorPlan, plan, workspace
from solvers.extension import touched
from solvers.point_tables import order_of, spline_table
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.splines import tables
from solvers.web import SplineSpace

ELEMENTS = 200_000
"""Numbers in the elements of one chunk of cells on tensor nodes."""

Blocks = Mapping[tuple[int, int], Array]


class CrossAssembler:
    """Accumulates the matrix between two spaces.

    Parameters
    ----------
    rows, columns
        The spaces; both on the same grid.
    """

    def __init__(self, rows: SplineSpace, columns: SplineSpace) -> None:
        self.rows, self.columns = rows, columns
        self._used = used_cells(rows) & used_cells(columns)
        self._delicate = rows.delicate_cells | columns.delicate_cells
        self._dofs = np.flatnonzero(touched(self._used, rows.degree))
        self._number = np.zeros(int(np.prod(rows.shape)), dtype=np.intp)
        self._number[self._dofs] = np.arange(len(self._dofs))
        local = [np.indices((space.degree + 1,) * len(rows.shape)) for space in (rows, columns)]
        self._first = np.ravel_multi_index(tuple(local[0]), rows.shape).ravel()
        self._offsets = (rows.degree + columns.degree + 1,) * len(rows.shape)
        offset = [b.ravel() - a.ravel()[:, None] + rows.degree for a, b in zip(*local, strict=True)]
        self._offset = np.ravel_multi_index(tuple(offset), self._offsets)
        self._band = np.zeros(int(np.prod(self._offsets)) * len(self._dofs))
        self._work = workspace(len(rows.shape))

    def add(self, batch: TensorBatch | PointBatch, blocks: Blocks, loads: Mapping[int, Array]) -> None:
        """Add the integrals over `batch`; there are no loads between two spaces.

        Raises
        ------
        ValueError
            A load is given.
        """
        if loads:
            raise ValueError("a form between two spaces has no load")
        chosen = np.flatnonzero(self._used[tuple(batch.cells.T)])
        if not len(chosen) or not blocks:
            return
        near = {key: values[chosen] for key, values in blocks.items()}
        degree = self.rows.degree + self.columns.degree
        for cells, nodes, matrix, _ in parts(batch.take(chosen), near, {}, self._delicate, degree):
            run = self._on_nodes if nodes.ndim == 1 else self._on_points
            first = np.ravel_multi_index(tuple(cells.T), self.rows.shape)
            size = len(self._first) * self._offset.shape[1]
            step = max(1, ELEMENTS // size)
            for start in range(0, len(cells), step):
                piece = slice(start, start + step)
                element = run(
                    nodes if nodes.ndim == 1 else nodes[piece], {k: a[piece] for k, a in matrix.items()}
                )
                number = self._number[self._first[:, None] + first[piece]]
                where = number[:, None] + len(self._dofs) * self._offset[:, :, None]
                np.add.at(self._band, where.ravel(), element.ravel())

    def finish(self) -> tuple[Any, Array]:
        """Matrix (n_dofs of rows, n_dofs of columns) as CSR, and an empty load."""
        from scipy.sparse import coo_array

        nonzero = np.flatnonzero(self._band)
        offset, number = np.divmod(nonzero, max(1, len(self._dofs)))
        i = self._dofs[number]
        index = np.stack(np.unravel_index(i, self.rows.shape))
        index += np.stack(np.unravel_index(offset, self._offsets)) - self.rows.degree
        j = np.ravel_multi_index(tuple(index), self.columns.shape)
        shape = (int(np.prod(self.rows.shape)), int(np.prod(self.columns.shape)))
        full = coo_array((self._band[nonzero], (i, j)), shape=shape).tocsr()
        return (self.rows.extension @ full @ self.columns.extension.T).tocsr(), np.zeros(0)

    def _on_nodes(self, nodes: Array, blocks: Blocks) -> Array:
        """Elements (splines of rows, splines of columns, cells) on tensor nodes."""
        form = cross_form(tuple(sorted(blocks)), tuple(float(h) for h in self.rows.grid.spacing))
        dimension, first, second = len(self.rows.shape), self.rows.degree + 1, self.columns.degree + 1
        steps = cross_plan(form, self.rows.degree, self.columns.degree, nodes.tobytes())
        cells = len(next(iter(blocks.values())))
        element = steps.run(blocks, cells, self._work)
        # one pair of numbers a direction: first all of the rows, then all of the columns
        split = element.reshape(*(first, second) * dimension, cells)
        axes = (*range(0, 2 * dimension, 2), *range(1, 2 * dimension, 2), 2 * dimension)
        ordered: Array = split.transpose(axes).reshape(first**dimension, second**dimension, cells)
        return ordered

    def _on_points(self, nodes: Array, blocks: Blocks) -> Array:
        """Elements (splines of rows, splines of columns, cells) on points of each cell's own."""
        order = order_of(blocks, len(self.rows.shape))
        left, right = (spline_table(space, nodes, order) for space in (self.rows, self.columns))
        element: Array = np.zeros(())
        for alpha in {a for a, _ in blocks}:
            image = sum(values[:, :, None] * right[b] for (a, b), values in blocks.items() if a == alpha)
            element = element + np.matmul(left[alpha].swapaxes(1, 2), np.asarray(image))
        return np.moveaxis(element, 0, -1)


@lru_cache(maxsize=256)
def cross_form(keys: tuple[tuple[int, int], ...], spacing: tuple[float, ...]) -> Form:
    """Form with a table ``(r, s)`` of all pairs of splines in each direction."""
    indices = multi_indices(len(spacing), order_of(keys, len(spacing)))
    terms = []
    for a, b in keys:
        kinds = tuple(zip(indices[a], indices[b], strict=True))
        scale = float(np.prod([h ** -(r + s) for h, (r, s) in zip(spacing, kinds, strict=True)]))
        terms.append((kinds, (((a, b), scale),)))
    order = max(max(kind) for kinds, _ in terms for kind in kinds)
    return Form((), tuple(sorted(terms)), order)


@lru_cache(maxsize=128)
def cross_plan(form: Form, first: int, second: int, nodes: bytes) -> TensorPlan:
    """Contractions of a form of splines of two degrees on tensor nodes, given as the bytes of their array."""
    points = np.frombuffer(nodes)
    left, right = (tables(degree, points, form.order) for degree in (first, second))

    def table(kind: Kind) -> Array:
        pairs: Array = left[kind[0]][:, :, None] * right[kind[1]][:, None, :]
        return pairs.reshape(len(points), -1)

    return plan(form, table)


def used_cells(space: SplineSpace) -> NDArray[np.bool_]:
    """Cells on which some relevant spline of the space lives."""
    relevant = np.zeros(int(np.prod(space.shape)), dtype=bool)
    relevant[space.free.dofs] = True
    relevant[space.free.outer] = True
    relevant = relevant.reshape(space.shape)
    for axis in range(relevant.ndim):
        view = np.moveaxis(relevant, axis, 0)
        cells = view.shape[0] - space.degree
        relevant = np.moveaxis(
            reduce(np.logical_or, [view[s : s + cells] for s in range(space.degree + 1)]), 0, axis
        )
    return relevant
