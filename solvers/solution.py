"""The computed field: evaluate it anywhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rfm.calculus.types import Array
from solvers.background import Background
from solvers.grid import Grid
from solvers.linear import LinearSolution
from solvers.problem import Discretization, Problem
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.web import evaluate as evaluate_spline
from structures.jet_matrix import stacked
from structures.operator import Operator

CHUNK = 100_000
"""Points evaluated at a time."""


@dataclass(frozen=True)
class Spline:
    """A spline on the background grid.

    Attributes
    ----------
    grid, degree
        Background grid and degree.
    coefficients
        B-spline coefficients on the full grid, shape ``cells + degree``.
    """

    grid: Grid
    degree: int
    coefficients: Array

    def jet(self, batch: TensorBatch | PointBatch, order: int) -> Array:
        """Partial derivatives up to `order` at the nodes of `batch`, shape (n_alpha, n, q)."""
        return evaluate_spline(self.coefficients, self.grid, self.degree, batch, order)


@dataclass(frozen=True)
class Trial:
    """A solution structure with chosen splines: all that is needed to evaluate the field at a point.

    Attributes
    ----------
    structure
        ``u = u0 + B[psi_0, psi_1, ...]``, one operator for each component of u.
    splines
        The splines psi_0, psi_1, ...
    """

    structure: tuple[Operator, ...]
    splines: tuple[Spline, ...]

    @property
    def grid(self) -> Grid:
        """Background grid."""
        return self.splines[0].grid

    @property
    def degree(self) -> int:
        """Degree of the leading spline."""
        return self.splines[0].degree

    def jet(self, batch: TensorBatch | PointBatch, order: int = 1) -> Array:
        """Partial derivatives of u up to `order` at the nodes of `batch`.

        Returns
        -------
        ndarray, shape (n_components * n_alpha, n, q)
            The jets of the components one below the other.
        """
        matrix = stacked(self.structure, batch.points(self.grid), order)
        total = order + matrix.operator_order
        return matrix.apply({m: spline.jet(batch, total) for m, spline in enumerate(self.splines)})

    def at(self, points: ArrayLike, order: int = 1) -> Array:
        """Partial derivatives of u at arbitrary points (n, d), shape (n_components * n_alpha, n).

        Outside the grid the splines are continued by their nearest polynomial pieces.

        Raises
        ------
        ValueError
            The points do not have d columns.
        """
        where = np.atleast_2d(np.asarray(points, dtype=float))
        dimension = self.grid.dimension
        if where.ndim != 2 or where.shape[1] != dimension:
            raise ValueError(f"points must have shape (n, {dimension}), got {where.shape}")
        starts = range(0, max(len(where), 1), CHUNK)
        joined: Array = np.concatenate([self._scattered(where[s : s + CHUNK], order) for s in starts], axis=1)
        return joined

    def _scattered(self, points: Array, order: int) -> Array:
        cells, unit = self.grid.locate(points)
        batch = PointBatch(cells, unit[:, None, :], np.ones((len(points), 1)))
        return self.jet(batch, order)[:, :, 0]


@dataclass(frozen=True)
class Solution:
    """What a solver returns.

    Attributes
    ----------
    problem, discretization
        What was asked for.
    background
        Grid, cells, rules and space it was solved on.
    trial
        The field.
    linear
        Residual, iterations and choice of the linear solver.
    seconds
        Wall seconds of the phases geometry, quadrature, assembly, solve.
    """

    problem: Problem
    discretization: Discretization
    background: Background
    trial: Trial
    linear: LinearSolution
    seconds: Mapping[str, float]

    @property
    def dofs(self) -> int:
        """Number of unknowns."""
        return self.background.space.n_dofs

    def u(self, points: ArrayLike) -> Array:
        """Values of u at points (n, d), shape (n,)."""
        values: Array = self.trial.at(points, 0)[0]
        return values

    def gradient(self, points: ArrayLike) -> Array:
        """Gradient of u at points (n, d), shape (n, d)."""
        gradient: Array = self.trial.at(points, 1)[1:].T
        return gradient
