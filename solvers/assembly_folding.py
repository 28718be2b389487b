r"""Scattered points turned into tensor nodes, without an error.

On a cell a product :math:`\partial^\alpha B_i\, \partial^{\alpha'} B_j` of splines is a polynomial of degree P at most
in each direction, P the sum of the two degrees.  It equals its interpolant at ``P + 1`` Gauss nodes a direction, so

.. math:: \sum_q C(x_q)\, \partial^\alpha B_i(x_q)\, \partial^{\alpha'} B_j(x_q)
          = \sum_k C_k\, \partial^\alpha B_i(t_k)\, \partial^{\alpha'} B_j(t_k), \qquad
          C_k = \sum_q C(x_q)\, L_k(x_q)

whatever the coefficient C, weights included, does between the points (L_k: Lagrange basis at the nodes).  The
:math:`C_k` are one matrix product a cell (:func:`solvers.quadrature.moments.nodal_moments`); the rest is done by
sum factorisation.

Only rounding differs: it is relative to the sum of the coefficients, not to the entry.  Where a spline is nearly
zero on its whole part of the domain (:attr:`solvers.web.SplineSpace.delicate_cells`) its energy would be lost in
it, so such cells keep their points.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.quadrature.moments import nodal_moments
from solvers.quadrature.pieces import gauss

Coefficients: TypeAlias = Mapping[Any, Array]
Part: TypeAlias = tuple[NDArray[np.integer[Any]], Array, Coefficients, Coefficients]


def parts(
    batch: TensorBatch | PointBatch,
    matrix: Coefficients,
    load: Coefficients,
    delicate: NDArray[np.bool_],
    degree: int,
) -> Iterator[Part]:
    """Split a batch into cells on tensor nodes and cells on points.

    Parameters
    ----------
    batch
        n cells with q points each.
    matrix, load
        Coefficients by key, each of shape (n, q), weights included.
    delicate
        Cells of the grid that keep their points.
    degree
        Sum P of the degrees of the splines that are multiplied.

    Yields
    ------
    tuple
        Cells (m, d); their nodes, (k,) in each direction or (m, q, d) for points; and the coefficients there.
    """
    if not matrix and not load:
        return
    if isinstance(batch, TensorBatch):
        yield batch.cells, batch.nodes, matrix, load
        return
    kept = delicate[tuple(batch.cells.T)]
    if kept.any():
        rows = np.flatnonzero(kept)
        yield batch.cells[rows], batch.nodes[rows], _take(matrix, rows), _take(load, rows)
    if not kept.all():
        rows = np.flatnonzero(~kept)
        chosen = {**_take(matrix, rows), **{("load", k): a for k, a in _take(load, rows).items()}}
        moments = nodal_moments(batch.nodes[rows], list(chosen.values()), degree + 1)
        found = {key: moments[:, i] for i, key in enumerate(chosen)}
        yield (
            batch.cells[rows],
            gauss(degree + 1)[0],
            {key: found[key] for key in matrix},
            {key: found["load", key] for key in load},
        )


def _take(arrays: Coefficients, rows: NDArray[np.intp]) -> dict[Any, Array]:
    """Some cells of each array."""
    return {key: array[rows] for key, array in arrays.items()}
