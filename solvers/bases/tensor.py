"""Spaces of tensor products of global functions: Chebyshev and Legendre polynomials, trigonometric functions.

All functions live on the whole box of the grid, whose cells only carry the quadrature. ``degree`` p gives
``count(p)`` functions a direction, hence ``count(p)^d`` unknowns, whatever the grid.

On a domain that is smaller than its box the functions are nearly dependent: some combinations are large in the corners
of the box and tiny in the domain. They form a *frame*; a solver that leaves out what is dependent to rounding still
finds an approximation that converges geometrically (Adcock, Huybrechs, *Frames and numerical approximation*, SIAM
Review 61, 2019).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.bases.basis import Accumulator, Finer, Mask, Points, require_degree, require_shape
from solvers.bases.lines import CHEBYSHEV_LINE, LEGENDRE_LINE, Line, Trigonometric
from solvers.bases.resolution import folded_points, gauss_points
from solvers.bases.tensor_evaluation import on_points, on_tensor_grid, point_tables, slabs
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import PointBatch, TensorBatch

if TYPE_CHECKING:
    from solvers.classify import Classification

WORK = 4_000_000
"""Numbers in the working arrays of one chunk of points."""
MOST_UNKNOWNS = 8000
"""Unknowns up to which a dense factorisation is affordable."""


@dataclass(frozen=True, eq=False)
class TensorFunction:
    """A tensor expansion over the box of a grid (:class:`solvers.bases.basis.Psi`).

    Attributes
    ----------
    line
        The functions of one direction.
    grid, degree
        Background grid and degree.
    coefficients
        Shape ``(count, ..., count)``.
    """

    line: Line
    grid: Grid
    degree: int
    coefficients: Array

    def jet(self, batch: TensorBatch | PointBatch, order: int) -> Array:
        """Partial derivatives up to `order` at the nodes of `batch`, shape (n_alpha, n, q)."""
        alphas = multi_indices(self.grid.dimension, order)
        result = np.empty((len(alphas), *batch.weights.shape))
        if isinstance(batch, TensorBatch):
            for slab in slabs(batch, WORK):
                tables = slab.tables(self.line, self.degree, self.grid, order)
                for k, alpha in enumerate(alphas):
                    result[k, slab.rows] = slab.gather(on_tensor_grid(self.coefficients, tables, alpha))
            return result
        n, q = batch.weights.shape
        step = max(1, WORK // max(1, q * self.coefficients.size // len(self.coefficients)))
        for start in range(0, n, step):
            piece = slice(start, start + step)
            tables = point_tables(
                self.line, self.degree, self.grid, batch.cells[piece], batch.nodes[piece], order
            )
            for k, alpha in enumerate(alphas):
                result[k, piece] = on_points(self.coefficients, tables, alpha).reshape(-1, q)
        return result

    def plus(self, constant: float) -> TensorFunction:
        """The function with a constant added."""
        shifted = self.coefficients.copy()
        shifted.flat[0] += constant
        return TensorFunction(self.line, self.grid, self.degree, shifted)


@dataclass(frozen=True, eq=False)
class TensorSpace:
    """All tensor products of the functions of a line (:class:`solvers.bases.basis.Space`)."""

    line: Line
    grid: Grid
    degree: int

    redundant = True

    @property
    def count(self) -> int:
        """Functions a direction."""
        return self.line.count(self.degree)

    @property
    def n_dofs(self) -> int:
        """Number of unknowns."""
        return int(self.count**self.grid.dimension)

    @property
    def delicate_cells(self) -> Mask:
        """None: what is nearly without energy in the domain is left to the linear solver."""
        return np.zeros(self.grid.shape, dtype=bool)

    @property
    def constant(self) -> Array:
        """Unknowns of the function 1."""
        first = np.zeros(self.n_dofs)
        first[0] = 1.0
        return first

    def affine(self, shift: float, slope: Array) -> Array | None:
        """Unknowns of ``shift + slope . x``; trigonometric functions hold only constants."""
        unknowns = (shift + float(slope @ self.grid.lower)) * self.constant
        line = self.line.coordinate
        if line is None:
            return shift * self.constant if not slope.any() else None
        lengths = self.grid.spacing * self.grid.cells
        for axis, rise in enumerate(slope * lengths):
            unknowns[0] += rise * line[0]
            unknowns[self.count ** (self.grid.dimension - 1 - axis)] += rise * line[1]
        return unknowns

    def assembler(self, symmetric: bool = True) -> Accumulator:
        """Assembler with sum factorisation."""
        from solvers.bases.tensor_assembly import TensorAssembler

        return TensorAssembler(self, symmetric)

    def function(self, unknowns: Array) -> TensorFunction:
        """The function with the given unknowns."""
        shape = (self.count,) * self.grid.dimension
        return TensorFunction(self.line, self.grid, self.degree, unknowns.reshape(shape))

    def table(self, cells: Integers, nodes: Array, order: int) -> Array:
        """Derivatives at the nodes (n, q, d) of cells (n, d), shape (n_alpha, n * q, n_dofs)."""
        tables = point_tables(self.line, self.degree, self.grid, cells, nodes, order)
        alphas = multi_indices(self.grid.dimension, order)
        result = np.empty((len(alphas), tables[0].shape[1], self.n_dofs))
        for k, alpha in enumerate(alphas):
            product = tables[0][alpha[0]]
            for table, r in zip(tables[1:], alpha[1:], strict=True):
                product = (product[:, :, None] * table[r][:, None, :]).reshape(len(product), -1)
            result[k] = product
        return result


@dataclass(frozen=True)
class TensorBasis:
    """Tensor products of one family of functions (:class:`solvers.bases.basis.Basis`)."""

    name: str
    meaning: str
    line: Line
    degrees: tuple[int, int]
    local: bool = False

    def smoothness(self, degree: int) -> float:
        """All of them."""
        return float("inf")

    def require(self, degree: int, dimension: int) -> None:
        """Refuse a degree out of range, or with too many unknowns for a dense matrix."""
        require_degree(self, degree)
        unknowns = self.line.count(degree) ** dimension
        if unknowns > MOST_UNKNOWNS:
            fitting = max(p for p in range(degree) if self.line.count(p) ** dimension <= MOST_UNKNOWNS)
            raise DiscretizationError(
                f"degree {degree} gives {unknowns} unknowns that all couple, more than {MOST_UNKNOWNS}: take at most "
                f"degree {fitting}, or basis: web-spline on a finer grid"
            )

    def points(self, degree: int, cells: int) -> Points:
        """Points that integrate products of two functions, with a few more for weight and data."""
        growth = self.line.growth(degree, cells)
        inner, folded = gauss_points(growth), folded_points(growth)
        exact = self.line.exact_degree(degree)
        if exact is not None:
            inner, folded = min(inner, exact // 2 + 3), min(folded, exact + 4)
        return Points(inner, inner + 2, folded)

    def unknowns(self, degree: int, cells: Sequence[float]) -> float:
        """Number of unknowns; the cells do not matter."""
        return float(self.line.count(degree) ** len(cells))

    def row(self, degree: int, cells: Sequence[float]) -> float:
        """All of them."""
        return self.unknowns(degree, cells)

    def build(
        self,
        grid: Grid,
        degree: int,
        classification: Classification,
        cut_cells: NDArray[np.integer[Any]] | None = None,
        finer: Finer | None = None,
    ) -> TensorSpace:
        """Space over the box of the grid.

        Raises
        ------
        DiscretizationError
            The degree is out of range or gives too many unknowns for a dense matrix.
        """
        self.require(degree, grid.dimension)
        return TensorSpace(self.line, grid, degree)

    def load(self, grid: Grid, degree: int, coefficients: Array) -> TensorFunction:
        """The function that was stored with these coefficients."""
        shape = (self.line.count(degree),) * grid.dimension
        return TensorFunction(self.line, grid, degree, require_shape(coefficients, shape))


CHEBYSHEV = TensorBasis(
    "chebyshev",
    "tensor Chebyshev polynomials on the whole box: geometric convergence in the degree, dense",
    CHEBYSHEV_LINE,
    (1, 40),
)
LEGENDRE = TensorBasis(
    "legendre",
    "tensor Legendre polynomials on the whole box: the same space, better conditioned",
    LEGENDRE_LINE,
    (1, 40),
)
TRIGONOMETRIC = TensorBasis(
    "trigonometric",
    "sines and cosines with twice the period of the box, up to the frequency `degree`: for oscillating fields, dense",
    Trigonometric(),
    (1, 40),
)
