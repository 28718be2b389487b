r"""Evaluation of a spline and its partial derivatives at quadrature points.

.. math:: \partial^\alpha \psi(x) = \sum_i c_i \prod_{\nu=1}^d h_\nu^{-\alpha_\nu} \varphi^{(\alpha_\nu)}_{i_\nu}(t_\nu)

with :math:`\alpha` over :func:`rfm.calculus.jets.multi_indices`. On the nodes of a tensor batch the sum is done one
direction at a time with constant tables; on scattered points every point has its own tables.
"""

from __future__ import annotations

import math

import numpy as np

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.splines import tables

WORK = 4_000_000
"""Numbers in the working arrays of one chunk of scattered points."""


def evaluate(
    coefficients: Array, grid: Grid, degree: int, batch: TensorBatch | PointBatch, order: int = 0
) -> Array:
    """Partial derivatives of a spline at the points of `batch`.

    Parameters
    ----------
    coefficients
        Full tensor array of B-spline coefficients, shape ``cells + degree``.
    grid, degree
        Background grid and degree.
    batch
        Points, n cells with q points each.
    order
        Highest total order of the derivatives.

    Returns
    -------
    ndarray, shape (n_alpha, n, q)
    """
    local = _local(coefficients, batch.cells, degree)
    powers = np.asarray(grid.spacing, dtype=float)
    dimension = len(powers)
    alphas = multi_indices(dimension, order)
    if isinstance(batch, TensorBatch):
        table = tables(degree, batch.nodes, order)
        values = _on_tensor_nodes(local, table, dimension, order)
        result = np.stack([values[alpha] for alpha in alphas])
    else:
        n, q = batch.nodes.shape[:2]
        result = np.empty((len(alphas), n, q))
        step = max(1, WORK // (q * (degree + 1) ** dimension))
        for start in range(0, n, step):
            piece = slice(start, start + step)
            table = tables(degree, batch.nodes[piece], order)
            values = _on_points(local[piece], table, dimension, order)
            for k, alpha in enumerate(alphas):
                result[k, piece] = values[alpha]
    for k, alpha in enumerate(alphas):
        if any(alpha):
            result[k] /= math.prod(float(h) ** a for h, a in zip(powers, alpha, strict=True))
    return result


def _local(coefficients: Array, cells: Integers, degree: int) -> Array:
    """Coefficients of the B-splines on each cell, shape (n, p+1, ..., p+1)."""
    windows = np.lib.stride_tricks.sliding_window_view(coefficients, (degree + 1,) * coefficients.ndim)
    found: Array = windows[tuple(np.asarray(cells).T)]
    return found


def _on_tensor_nodes(local: Array, table: Array, dimension: int, order: int) -> dict[tuple[int, ...], Array]:
    """Derivatives at tensor nodes (n, m^d), by contraction of one direction after the other."""
    n = len(local)
    stage: dict[tuple[int, ...], Array] = {(): local}
    for _ in range(dimension):
        following: dict[tuple[int, ...], Array] = {}
        for alpha, values in stage.items():
            rest = np.moveaxis(values, 1, -1)  # the contracted direction goes last, behind those already done
            for r in range(order + 1 - sum(alpha)):
                following[*alpha, r] = rest @ table[r].T
        stage = following
    return {alpha: values.reshape(n, -1) for alpha, values in stage.items()}


def _on_points(local: Array, table: Array, dimension: int, order: int) -> dict[tuple[int, ...], Array]:
    """Derivatives at scattered points (n, q); `table` has shape (order + 1, n, q, d, p + 1)."""
    n, q, width = *table.shape[1:3], table.shape[-1]
    stage: dict[tuple[int, ...], Array] = {}
    flat = local.reshape(n, -1, width)
    for r in range(order + 1):  # last direction, one matrix product a cell
        stage[(r,)] = np.matmul(table[r, :, :, -1], flat.transpose(0, 2, 1))
    for axis in range(dimension - 2, -1, -1):
        following: dict[tuple[int, ...], Array] = {}
        for alpha, values in stage.items():
            grouped = values.reshape(n, q, -1, width)
            for r in range(order + 1 - sum(alpha)):
                following[r, *alpha] = np.matmul(grouped, table[r, :, :, axis, :, None])[..., 0]
        stage = following
    return {alpha: values.reshape(n, q) for alpha, values in stage.items()}
