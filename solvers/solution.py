"""The computed field: evaluate it anywhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from rfm.calculus.types import Array
from solvers.background import Background
from solvers.bases.basis import Psi
from solvers.bases.spline import Spline
from solvers.grid import Grid
from solvers.linear import LinearSolution
from solvers.problem import Discretization, Problem
from solvers.quadrature.batch import PointBatch, TensorBatch
from structures.jet_matrix import stacked
from structures.operator import Operator

if TYPE_CHECKING:
    from rfm.geometry.shape import Shape

__all__ = ["Piece", "Solution", "Spline", "Trial"]

CHUNK = 100_000
"""Points evaluated at a time."""


class Inside(Protocol):
    """A region with a structure."""

    @property
    def region(self) -> Shape: ...
    @property
    def structure(self) -> tuple[Operator, ...]: ...


@dataclass(frozen=True)
class Trial:
    """A solution structure with chosen splines: all that is needed to evaluate the field at a point.

    Attributes
    ----------
    structure
        ``u = u0 + B[psi_0, psi_1, ...]``, one operator for each component of u.
    splines
        The functions psi_0, psi_1, ..., splines or of another basis.
    inclusions
        Parts of the domain with a structure of their own; at points both of a part and of its boundary it is that
        of the part which counts.
    """

    structure: tuple[Operator, ...]
    splines: tuple[Psi, ...]
    inclusions: tuple[Inside, ...] = ()

    @property
    def grid(self) -> Grid:
        """Background grid."""
        return self.splines[0].grid

    @property
    def degree(self) -> int:
        """Degree of the leading spline."""
        return self.splines[0].degree

    def jet(self, batch: TensorBatch | PointBatch, order: int = 1) -> Array:
        """Partial derivatives of u up to `order` at the nodes of `batch`; of the matrix, where there are inclusions.

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

    def values(self, points: ArrayLike) -> Array:
        """Values of u at points (n, d), shape (n,); of a vector (n, n_components)."""
        values: Array = self.at(points, 0)
        return values[0] if len(self.structure) == 1 else values.T

    def gradient(self, points: ArrayLike) -> Array:
        """Gradient of u at points (n, d), shape (n, d); of a vector (n, n_components, d), du_c/dx_j."""
        jets = self.at(points, 1)
        gradient: Array = jets.reshape(len(self.structure), -1, jets.shape[1])[:, 1:].transpose(2, 0, 1)
        return gradient[:, 0] if len(self.structure) == 1 else gradient

    def _scattered(self, points: Array, order: int) -> Array:
        cells, unit = self.grid.locate(points)
        batch = PointBatch(cells, unit[:, None, :], np.ones((len(points), 1)))
        jet: Array = self.jet(batch, order)[:, :, 0]
        for inclusion in self.inclusions:
            rows = np.flatnonzero(np.asarray(inclusion.region.membership(*points.T)) >= 0)
            if len(rows):
                there = PointBatch(cells[rows], unit[rows, None, :], np.ones((len(rows), 1)))
                jet[:, rows] = self.within(inclusion.structure).jet(there, order)[:, :, 0]
        return jet

    def within(self, structure: tuple[Operator, ...]) -> Trial:
        """The field of one material, continued everywhere."""
        return Trial(structure, self.splines)


@dataclass(frozen=True)
class Piece:
    """A material, or an interface of two: the problem as it is there, the field, cells and rules."""

    problem: Problem
    trial: Trial
    background: Background


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
    pieces
        The materials and their interfaces; one piece where there is one material.
    notes
        What was done otherwise than asked for.
    intensities
        Of each corner with singular functions: point, angle in degrees, exponent and intensity of the leading one.
    """

    problem: Problem
    discretization: Discretization
    background: Background
    trial: Trial
    linear: LinearSolution
    seconds: Mapping[str, float]
    pieces: tuple[Piece, ...]
    notes: tuple[str, ...] = ()
    intensities: tuple[Mapping[str, Any], ...] = ()

    @property
    def dofs(self) -> int:
        """Number of unknowns."""
        return len(self.linear.x)

    def u(self, points: ArrayLike) -> Array:
        """Values of u at points (n, d), shape (n,); of a vector (n, n_components)."""
        return self.trial.values(points)

    def gradient(self, points: ArrayLike) -> Array:
        """Gradient of u at points (n, d), shape (n, d); of a vector (n, n_components, d)."""
        return self.trial.gradient(points)
