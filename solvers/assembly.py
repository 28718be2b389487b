r"""Assembly of quadratic functionals of a spline: matrix and load of a space.

For coefficients :math:`C_{\alpha\alpha'}` and :math:`b_\alpha` at quadrature points, weights included, the assembler
adds

.. math::

    A_{ij} \mathrel{+}= \sum_k \sum_{\alpha\alpha'} C_{\alpha\alpha'}(x_k)\,
        \partial^\alpha B_i(x_k)\, \partial^{\alpha'} B_j(x_k), \qquad
    f_i \mathrel{+}= \sum_k \sum_\alpha b_\alpha(x_k)\, \partial^\alpha B_i(x_k)

over all B-splines, and finally passes to the unknowns of the space, :math:`E A E^T` and :math:`E f` with the
extension E of :mod:`solvers.extension`. The multi-indices are numbered as in
:func:`rfm.calculus.jets.multi_indices`.

Scattered points become tensor nodes without an error (:mod:`solvers.assembly_folding`), but for a few cells.  Each
kind of nodes has its own element integrals (:mod:`solvers.assembly_tensor`, :mod:`solvers.assembly_points`); both use
the parities of :mod:`solvers.assembly_parity` and add to the stencil of :mod:`solvers.assembly_stencil`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.assembly_folding import parts
from solvers.assembly_parity import Form, Key, entry_shifts, load_form, matrix_forms, table
from solvers.assembly_points import element_entries
from solvers.assembly_reduction import reduce_load, reduce_matrix
from solvers.assembly_stencil import Stencil
from solvers.assembly_tensor import TensorPlan, plan, workspace
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.splines import tables
from solvers.web import SplineSpace

ELEMENTS = 200_000
"""Numbers in the elements of one chunk of cells on tensor nodes: the working set stays in the cache."""
PRODUCTS = 1_000_000
"""Numbers in the largest intermediate array of one chunk of cells on scattered points."""

Blocks = Mapping[tuple[int, int], Array] | Array
Loads = Mapping[int, Array] | Array


class Assembler:
    """Accumulates matrix and load over batches of cells.

    Parameters
    ----------
    space
        Space of the unknown.
    symmetric
        The form is symmetric; blocks are then given for ``alpha <= alpha'`` only. A form that is not symmetric
        (advection) needs all its blocks.
    """

    def __init__(self, space: SplineSpace, symmetric: bool = True) -> None:
        self.space, self.symmetric = space, symmetric
        self.stencil = Stencil(space.shape, space.degree)
        self.load = np.zeros(self.stencil.size)
        self._spacing = tuple(float(h) for h in space.grid.spacing)
        self._work = workspace(len(space.shape))

    def add(self, batch: TensorBatch | PointBatch, blocks: Blocks, loads: Loads) -> None:
        """Add the integrals over `batch`.

        Parameters
        ----------
        batch
            n cells with q points each.
        blocks
            C by ``(alpha, alpha')``, each of shape (n, q) and weights included; what is absent is zero. Or an array
            (n_alpha, n_alpha, n, q).
        loads
            b by ``alpha``, likewise, or an array (n_alpha, n, q).
        """
        if not len(batch.cells):
            return
        matrix = _present(blocks, 2, self.symmetric)
        vector = _present(loads, 1)
        degree = 2 * self.space.degree
        for where, nodes, quadratic, linear in parts(
            batch, matrix, vector, self.space.delicate_cells, degree
        ):
            cells = np.ravel_multi_index(tuple(np.asarray(where).T), self.space.shape)
            add = self._add_tensor if nodes.ndim == 1 else self._add_points
            if quadratic:
                for form in matrix_forms(tuple(sorted(quadratic)), self._spacing, self.symmetric):
                    add(nodes, cells, form, quadratic, self.stencil.array(form.parity))
            if linear:
                add(nodes, cells, load_form(tuple(sorted(linear)), self._spacing), linear, self.load)

    def finish(self) -> tuple[Any, Array]:
        """Matrix and load of the unknowns.

        Returns
        -------
        tuple
            The matrix, a CSR matrix or, for a small or densely coupled space, an array, of shape (n_dofs, n_dofs);
            and the load (n_dofs,).
        """
        free = self.space.free
        return reduce_matrix(self.stencil, free, self.symmetric), reduce_load(self.load, free)

    def _add_tensor(
        self, nodes: Array, cells: NDArray[np.intp], form: Form, arrays: Mapping[Key, Array], target: Array
    ) -> None:
        steps = tensor_plan(form, self.space.degree, nodes.tobytes())
        shifts = entry_shifts(form.parity, self.space.degree, self.space.shape)
        chunk = max(16, ELEMENTS // steps.rows)
        for start in range(0, len(cells), chunk):
            piece = slice(start, start + chunk)
            elements = steps.run({k: a[piece] for k, a in arrays.items()}, len(cells[piece]), self._work)
            np.add.at(target, (shifts[:, None] + cells[piece]).ravel(), elements.ravel())

    def _add_points(
        self, nodes: Array, cells: NDArray[np.intp], form: Form, arrays: Mapping[Key, Array], target: Array
    ) -> None:
        shifts = entry_shifts(form.parity, self.space.degree, self.space.shape)
        widest = nodes.shape[1] * len(shifts) ** (1 - 1 / nodes.shape[2]) * 3
        chunk = max(1, int(PRODUCTS / widest))
        for start in range(0, len(cells), chunk):
            piece = slice(start, start + chunk)
            elements = element_entries(
                form, self.space.degree, nodes[piece], {k: a[piece] for k, a in arrays.items()}
            )
            np.add.at(target, (cells[piece, None] + shifts).ravel(), elements.ravel())


@lru_cache(maxsize=128)
def tensor_plan(form: Form, degree: int, nodes: bytes) -> TensorPlan:
    """Contractions of a form of splines of a degree on tensor nodes, given as the bytes of their array."""
    phi = tables(degree, np.frombuffer(nodes), form.order)
    return plan(form, lambda kind: table(phi, kind))


def _present(arrays: Any, rank: int, symmetric: bool = False) -> dict[Any, Array]:
    """Coefficient arrays by key; of a full array those that are not zero, the upper triangle if symmetric."""
    if isinstance(arrays, Mapping):
        return dict(arrays)
    found: dict[Any, Array] = {}
    for index in np.ndindex(arrays.shape[:rank]):
        if symmetric and index[0] > index[1]:
            continue
        if np.any(arrays[index]):
            found[index if rank > 1 else index[0]] = arrays[index]
    return found
