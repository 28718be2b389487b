"""The spline bases: sparse, of any domain, order p + 1 (:mod:`solvers.web`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.bases.basis import Finer, Points, require_degree, require_shape
from solvers.evaluation import evaluate
from solvers.grid import Grid
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.splines import MAX_DEGREE

if TYPE_CHECKING:
    from solvers.classify import Classification
    from solvers.web import SplineSpace


@dataclass(frozen=True)
class Spline:
    """A spline on the background grid (:class:`solvers.bases.basis.Psi`).

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
        return evaluate(self.coefficients, self.grid, self.degree, batch, order)

    def plus(self, constant: float) -> Spline:
        """The spline with a constant added: B-splines add up to 1."""
        return replace(self, coefficients=self.coefficients + constant)


@dataclass(frozen=True)
class SplineBasis:
    """B-splines of degree p, all or those with a whole cell inside (:class:`solvers.bases.basis.Basis`)."""

    name: str
    meaning: str
    degrees: tuple[int, int] = (1, MAX_DEGREE)
    local: bool = True

    def smoothness(self, degree: int) -> float:
        """p: the splines of degree p have p - 1 continuous derivatives."""
        return float(degree)

    def require(self, degree: int, dimension: int) -> None:
        """Refuse a degree out of range."""
        require_degree(self, degree)

    def points(self, degree: int, cells: int) -> Points:
        """Gauss points: p + 1 in inner cells, p + 3 in cut ones, and 2p (2p + 2 for p <= 4) where these are folded.

        Measured on a smooth solution in an annulus: 2p reproduce the full rule to two digits for p > 4, 2p + 2
        are needed below (docs/architecture.md).
        """
        return Points(degree + 1, degree + 3, 2 * degree if degree > 4 else 2 * degree + 2)

    def unknowns(self, degree: int, cells: Sequence[float]) -> float:
        """All B-splines of the grid."""
        total = 1.0
        for n in cells:
            total *= n + degree
        return total

    def row(self, degree: int, cells: Sequence[float]) -> float:
        """Half the stencil of the neighbours."""
        return (float(2 * degree + 1) ** len(cells) + 1) / 2

    def build(
        self,
        grid: Grid,
        degree: int,
        classification: Classification,
        cut_cells: NDArray[np.integer[Any]] | None = None,
        finer: Finer | None = None,
    ) -> SplineSpace:
        """See :meth:`solvers.web.SplineSpace.build`."""
        from solvers.web import SplineSpace

        require_degree(self, degree)
        return SplineSpace.build(grid, degree, classification, self.name, cut_cells, finer)

    def load(self, grid: Grid, degree: int, coefficients: Array) -> Spline:
        """The spline that was stored with these coefficients."""
        return Spline(grid, degree, require_shape(coefficients, tuple(n + degree for n in grid.shape)))


WEB_SPLINE = SplineBasis(
    "web-spline", "splines with little support inside are attached to inner ones: stable on any cut"
)
B_SPLINE = SplineBasis(
    "b-spline", "all splines that meet the domain: ill-conditioned where the boundary cuts off slivers"
)
