r"""What a basis for psi is, so that structures, equations and methods work with any.

A *basis* (:class:`Basis`) is a name with what must be known before a grid exists: its degrees, how many quadrature
points it needs, how to build its space over a classified grid, and how to read a function that was stored. A *space*
(:class:`Space`) holds the unknowns over one grid and gives an assembler; a *function* (:class:`Psi`) is a member of
the space, all that is needed to evaluate it.

Local bases (splines) couple neighbours only and have a sparse assembly of their own
(:mod:`solvers.assembly`); global ones (polynomials, trigonometric, radial) are assembled from dense tables
(:mod:`solvers.bases.tensor_assembly`, :mod:`solvers.bases.dense_assembly`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.grid import Grid

if TYPE_CHECKING:
    from solvers.classify import Classification
    from solvers.quadrature.batch import PointBatch, TensorBatch

Mask = NDArray[np.bool_]
Finer: TypeAlias = "Callable[[int], Classification]"
Blocks = Mapping[tuple[int, int], Array]
Loads = Mapping[int, Array]


class Psi(Protocol):
    """A function of a space.

    Attributes
    ----------
    grid, degree
        Background grid and degree, as the basis counts it.
    coefficients
        What has to be stored, with grid and degree, to have the function again (:meth:`Basis.load`).
    """

    @property
    def grid(self) -> Grid: ...  # noqa: D102
    @property
    def degree(self) -> int: ...  # noqa: D102
    @property
    def coefficients(self) -> Array: ...  # noqa: D102

    def jet(self, batch: TensorBatch | PointBatch, order: int) -> Array:
        """Partial derivatives up to `order` at the nodes of `batch`, shape (n_alpha, n, q)."""
        ...

    def plus(self, constant: float) -> Psi:
        """The function with a constant added."""
        ...


class Accumulator(Protocol):
    """Matrix and load of one space, summed over batches."""

    def add(self, batch: TensorBatch | PointBatch, blocks: Blocks, loads: Loads) -> None:
        """Add the integrals over `batch`; see :meth:`solvers.assembly.Assembler.add`."""
        ...

    def finish(self) -> tuple[Any, Array]:
        """Matrix (array or CSR) and load of the unknowns."""
        ...


class Space(Protocol):
    """The unknowns of psi over one grid.

    Attributes
    ----------
    grid, degree
        Background grid and degree.
    n_dofs
        Number of unknowns.
    delicate_cells
        Cells where only a rule with positive weights keeps the energy of every function positive.
    constant
        Unknowns of the function 1.
    redundant
        Whether the functions may depend on each other to rounding on the domain, so that the linear solver has
        to choose among them.
    """

    @property
    def grid(self) -> Grid: ...  # noqa: D102
    @property
    def degree(self) -> int: ...  # noqa: D102
    @property
    def n_dofs(self) -> int: ...  # noqa: D102
    @property
    def delicate_cells(self) -> Mask: ...  # noqa: D102
    @property
    def constant(self) -> Array: ...  # noqa: D102
    @property
    def redundant(self) -> bool: ...  # noqa: D102

    def affine(self, shift: float, slope: Array) -> Array | None:
        """Unknowns of the function ``shift + slope . x``, None where the space does not hold it."""
        ...

    def assembler(self, symmetric: bool = True) -> Accumulator:
        """Accumulate a form of functions of this space; see :class:`solvers.assembly.Assembler`."""
        ...

    def function(self, unknowns: Array) -> Psi:
        """The function with the given unknowns (n_dofs,)."""
        ...


@dataclass(frozen=True)
class Points:
    """Gauss points a direction: in inner cells, on pieces of cut cells, and of the rule a cut cell is folded into.

    ``folded`` is None where a basis is not smooth inside the cells, so that cut cells have to keep their own rule.
    """

    inner: int
    cut: int
    folded: int | None


class Basis(Protocol):
    """A kind of space.

    Attributes
    ----------
    name
        Name in a case file.
    meaning
        One line for ``rfm list bases``.
    degrees
        Lowest and highest degree.
    local
        Whether functions have neighbours only (splines): what restricts them to a part of the cells needs that.
    """

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def meaning(self) -> str: ...  # noqa: D102
    @property
    def degrees(self) -> tuple[int, int]: ...  # noqa: D102
    @property
    def local(self) -> bool: ...  # noqa: D102

    def smoothness(self, degree: int) -> float:
        """Highest derivative that can be integrated and tabulated; infinite for analytic functions."""
        ...

    def require(self, degree: int, dimension: int) -> None:
        """Refuse, before anything is computed, a degree that the basis does not have.

        Raises
        ------
        DiscretizationError
            The degree is out of range, or gives more unknowns than can be dealt with.
        """
        ...

    def points(self, degree: int, cells: int) -> Points:
        """Quadrature points that `degree` needs on `cells` cells a direction."""
        ...

    def unknowns(self, degree: int, cells: Sequence[float]) -> float:
        """Upper estimate of the number of unknowns."""
        ...

    def row(self, degree: int, cells: Sequence[float]) -> float:
        """Entries that are stored for a row of the matrix."""
        ...

    def build(
        self,
        grid: Grid,
        degree: int,
        classification: Classification,
        cut_cells: NDArray[np.integer[Any]] | None = None,
        finer: Finer | None = None,
    ) -> Space:
        """Space over a classified grid; the arguments are those of :meth:`solvers.web.SplineSpace.build`.

        Raises
        ------
        DiscretizationError
            The degree is out of range or the grid does not suit the basis.
        """
        ...

    def load(self, grid: Grid, degree: int, coefficients: Array) -> Psi:
        """The function that was stored with these coefficients.

        Raises
        ------
        DiscretizationError
            The coefficients do not fit the grid and the degree.
        """
        ...


def require_degree(basis: Basis, degree: int) -> None:
    """Check that a basis has the degree.

    Raises
    ------
    DiscretizationError
        It has not.
    """
    lowest, highest = basis.degrees
    if not lowest <= degree <= highest:
        raise DiscretizationError(
            f"degree must be between {lowest} and {highest} for basis: {basis.name}, got {degree}"
        )


def require_shape(coefficients: Array, expected: tuple[int, ...]) -> Array:
    """Check the shape of stored coefficients.

    Raises
    ------
    DiscretizationError
        It is another one.
    """
    if coefficients.shape != expected:
        raise DiscretizationError(f"coefficients have the shape {coefficients.shape}, expected {expected}")
    return coefficients
