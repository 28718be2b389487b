r"""Radial functions about the nodes of the grid, for comparison.

The space is spanned by the constant 1 and by one Wendland function of smoothness :math:`C^{2k}`, ``degree`` k = 1, 2,
3, about each node of a cell that meets the domain or lies within k cells of one that does: without those outside the
error is that of the boundary, 10 to 1000 times larger. The radius of the supports is the longest side of the box: with
radii that shrink with the grid the error would stall (Wendland, *Scattered Data Approximation*, Cambridge 2005,
section 15.4). So the matrix is dense, and its condition number grows like :math:`h^{-(d+2k+1)}`.
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
from solvers.bases.wendland import derivatives
from solvers.extension import touched
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import PointBatch, TensorBatch

if TYPE_CHECKING:
    from solvers.classify import Classification

REACH = 1.0
"""Radius of a support in lengths of the longest side of the box."""
WORK = 400_000
"""Numbers in the tables of one chunk of points."""
MOST_UNKNOWNS = 4000
"""Unknowns up to which a dense matrix is assembled in reasonable time."""


@dataclass(frozen=True, eq=False)
class RadialSpace:
    """The constant and the radial functions about some nodes (:class:`solvers.bases.basis.Space`).

    Attributes
    ----------
    grid, degree
        Background grid and smoothness k.
    centres
        Nodes, shape (n, d), integers; those outside the grid have negative numbers or large ones.
    """

    grid: Grid
    degree: int
    centres: Integers

    redundant = True

    @property
    def n_dofs(self) -> int:
        """Number of unknowns."""
        return 1 + len(self.centres)

    @property
    def delicate_cells(self) -> Mask:
        """All: the functions are not smooth inside the cells."""
        return np.ones(self.grid.shape, dtype=bool)

    @property
    def constant(self) -> Array:
        """Unknowns of the function 1."""
        first = np.zeros(self.n_dofs)
        first[0] = 1.0
        return first

    def affine(self, shift: float, slope: Array) -> Array | None:
        """Unknowns of ``shift + slope . x``: only constants are held."""
        return None if slope.any() else shift * self.constant

    @property
    def radius(self) -> float:
        """Radius of the supports."""
        return REACH * float((self.grid.spacing * self.grid.cells).max())

    def assembler(self, symmetric: bool = True) -> Accumulator:
        """Assembler with points as rows."""
        from solvers.bases.dense_assembly import DenseAssembler

        return DenseAssembler(self, symmetric)

    def function(self, unknowns: Array) -> RadialFunction:
        """The function with the given unknowns."""
        return RadialFunction(self, unknowns)

    def table(self, cells: Integers, nodes: Array, order: int) -> Array:
        """Derivatives at the nodes (n, q, d) of cells (n, d), shape (n_alpha, n * q, n_dofs).

        Raises
        ------
        DiscretizationError
            More derivatives are asked for than the functions have.
        """
        if order > self.degree:
            raise DiscretizationError(
                f"basis: radial with degree {self.degree} has no derivatives of order {order} at every point: "
                f"take degree {order} or basis: web-spline"
            )
        d = self.grid.dimension
        points = (cells[:, None, :] + nodes).reshape(-1, 1, d)
        result = np.zeros((len(multi_indices(d, order)), len(points), self.n_dofs))
        result[0, :, 0] = 1.0
        offsets = (points - self.centres) * self.grid.spacing
        result[:, :, 1:] = derivatives(offsets, self.radius, self.degree, order)
        return result


@dataclass(frozen=True, eq=False)
class RadialFunction:
    """A sum of radial functions and a constant (:class:`solvers.bases.basis.Psi`)."""

    space: RadialSpace
    unknowns: Array

    @property
    def grid(self) -> Grid:
        """Background grid."""
        return self.space.grid

    @property
    def degree(self) -> int:
        """Smoothness k."""
        return self.space.degree

    @property
    def coefficients(self) -> Array:
        """The constant, then those of all nodes and of the margin in C order, zero where there is no centre."""
        nodes = np.zeros(node_shape(self.grid, self.degree))
        nodes[tuple((self.space.centres + margin(self.grid, self.degree)).T)] = self.unknowns[1:]
        return np.concatenate([self.unknowns[:1], nodes.ravel()])

    def jet(self, batch: TensorBatch | PointBatch, order: int) -> Array:
        """Partial derivatives up to `order` at the nodes of `batch`, shape (n_alpha, n, q)."""
        n, q = batch.weights.shape
        alphas = multi_indices(self.grid.dimension, order)
        result = np.empty((len(alphas), n, q))
        step = max(1, WORK // max(1, len(alphas) * q * self.space.n_dofs))
        for start in range(0, n, step):
            piece = slice(start, start + step)
            nodes = (
                np.broadcast_to(batch.unit_points(), (len(batch.cells[piece]), q, self.grid.dimension))
                if isinstance(batch, TensorBatch)
                else batch.nodes[piece]
            )
            table = self.space.table(batch.cells[piece], nodes, order)
            result[:, piece] = (table @ self.unknowns).reshape(len(alphas), -1, q)
        return result

    def plus(self, constant: float) -> RadialFunction:
        """The function with a constant added."""
        shifted = self.unknowns.copy()
        shifted[0] += constant
        return RadialFunction(self.space, shifted)


@dataclass(frozen=True)
class RadialBasis:
    """Wendland functions about the nodes of the grid (:class:`solvers.bases.basis.Basis`)."""

    name: str = "radial"
    meaning: str = (
        "Wendland functions about the grid's nodes, degree k: 2k derivatives; for comparison, dense"
    )
    degrees: tuple[int, int] = (1, 3)
    local: bool = False

    def smoothness(self, degree: int) -> float:
        """Order k: of the 2k continuous derivatives, k are tabulated."""
        return float(degree)

    def require(self, degree: int, dimension: int) -> None:
        """Refuse a degree out of range."""
        require_degree(self, degree)

    def points(self, degree: int, cells: int) -> Points:
        """Many, for the functions have finite smoothness at the nodes and at the ends of their supports."""
        return Points(7, 7, None)

    def unknowns(self, degree: int, cells: Sequence[float]) -> float:
        """All nodes, those of the margin too, and the constant."""
        total = 1.0
        for n in cells:
            total *= n + 1 + 2 * degree
        return 1.0 + total

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
    ) -> RadialSpace:
        """Centres at the nodes of all cells that meet the domain.

        Raises
        ------
        DiscretizationError
            The degree is out of range or there are too many nodes for a dense matrix.
        """
        require_degree(self, degree)
        active = classification.state > 0
        if cut_cells is None:
            active = classification.state >= 0
        else:
            active[tuple(np.asarray(cut_cells).T)] = True
        outside = margin(grid, degree)
        space = RadialSpace(grid, degree, np.argwhere(touched(active, 1 + 2 * outside)) - outside)
        if space.n_dofs > MOST_UNKNOWNS:
            raise DiscretizationError(
                f"{space.n_dofs} radial functions all couple, more than {MOST_UNKNOWNS}: take a coarser grid, or "
                "basis: web-spline"
            )
        return space

    def load(self, grid: Grid, degree: int, coefficients: Array) -> RadialFunction:
        """The function that was stored with these coefficients."""
        shape = node_shape(grid, degree)
        require_shape(coefficients, (1 + int(np.prod(shape)),))
        nodes = coefficients[1:].reshape(shape)
        used = np.argwhere(nodes != 0.0)
        unknowns = np.concatenate([coefficients[:1], nodes[tuple(used.T)]])
        return RadialFunction(RadialSpace(grid, degree, used - margin(grid, degree)), unknowns)


def margin(grid: Grid, degree: int) -> int:
    """Cells outside the domain that carry centres; few enough for all supports to reach the domain."""
    return min(degree, max(grid.shape) // 2)


def node_shape(grid: Grid, degree: int) -> tuple[int, ...]:
    """Nodes of a grid with its margin in each direction."""
    return tuple(n + 1 + 2 * margin(grid, degree) for n in grid.shape)


RADIAL = RadialBasis()
