r"""Spaces of splines on the background grid of a domain: plain B-splines and WEB-splines.

Notation. The grid has ``cells`` = n cells in each of d directions, and the tensor-product B-splines of degree p carry
indices of the *full* shape ``n + p``; index ``i`` lives on the cells ``i - p, ..., i``. An index is

- *relevant* when its support meets the domain, in an inner cell or in a cut cell with quadrature points,
- *inner* when its support contains an inner cell,
- *outer* when it is relevant and not inner.

The basis ``web-spline`` has one unknown for each inner index and extends it to the outer ones within reach
(:mod:`solvers.extension`); its condition number does not depend on how the boundary cuts the cells, and it
reproduces every polynomial of degree p. The basis ``b-spline`` has one unknown for each relevant index. The weight
of a WEB-spline is part of the solution structure, hence not here.

Sources: Hoellig, Reif, Wipper, *Weighted extended B-spline approximation of Dirichlet problems*, SINUM 39 (2001);
Hoellig, *Finite Element Methods with B-Splines*, SIAM 2003, chapter 4.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.bases.spline import Spline
from solvers.evaluation import evaluate
from solvers.extension import Extension, Mask, full_arrays, touched
from solvers.grid import Grid
from solvers.splines import require_degree
from solvers.wrapping import EXTENSIONS, Wraps, wrapped

if TYPE_CHECKING:
    from solvers.assembly import Assembler
    from solvers.classify import Classification

__all__ = ["SplineSpace", "evaluate"]

Finer: TypeAlias = "Callable[[int], Classification]"
INNER = 1
TRIAL_CELLS = 2_000_000
"""Largest grid, in cells, that is tried in search of a remedy."""


@dataclass(frozen=True, eq=False)
class SplineSpace:
    """Splines of degree p on a grid, restricted to what a domain needs.

    Attributes
    ----------
    grid, degree
        Background grid and degree p.
    free
        Which coefficients are unknowns, and how the other relevant ones follow from them.
    periodic
        Whether coefficients one period apart are one unknown.
    """

    grid: Grid
    degree: int
    free: Extension
    periodic: bool = False

    @staticmethod
    def build(
        grid: Grid,
        degree: int,
        classification: Classification,
        basis: str = "web-spline",
        cut_cells: NDArray[np.integer[Any]] | None = None,
        finer: Finer | None = None,
        wraps: Wraps | None = None,
    ) -> SplineSpace:
        """Space of splines over a classified grid.

        Parameters
        ----------
        grid, degree
            Background grid and degree.
        classification
            Its ``state`` says which cells are inner (1) and cut (0).
        basis
            One of :data:`solvers.wrapping.EXTENSIONS`.
        cut_cells
            The cut cells with quadrature points, shape (n, d), rows may repeat; all cut cells when omitted.
        finer
            Classification of the domain for another number of cells along the longest side: used to name a grid that
            would do in the error message.
        wraps
            Axes along which the splines are periodic, the grid covering one period, with their factors.

        Raises
        ------
        DiscretizationError
            The degree is out of range, the basis unknown, or the grid too coarse for the degree.
        """
        require_degree(degree)
        if basis not in EXTENSIONS:
            raise DiscretizationError(
                f"unknown basis {basis!r}: choose one of {', '.join(sorted(EXTENSIONS))}"
            )
        inside = classification.state == INNER
        if cut_cells is None:
            active = classification.state >= 0
        else:
            active = inside.copy()
            active[tuple(np.asarray(cut_cells).T)] = True
        if not inside.any() and basis == "web-spline":
            raise DiscretizationError(_too_coarse(inside.shape, degree, finer))
        if wraps:
            return SplineSpace(grid, degree, wrapped(inside, active, degree, wraps, basis), True)
        relevant = touched(active, degree)
        return SplineSpace(grid, degree, EXTENSIONS[basis](touched(inside, degree), relevant, degree))

    @property
    def shape(self) -> tuple[int, ...]:
        """Full shape ``cells + degree`` of the coefficient array."""
        return tuple(int(n) + self.degree for n in self.grid.cells)

    @property
    def n_dofs(self) -> int:
        """Number of unknowns."""
        return len(self.free.dofs)

    redundant = False

    @property
    def constant(self) -> Array:
        """Unknowns of the function 1."""
        return np.ones(self.n_dofs)

    def affine(self, shift: float, slope: Array) -> Array:
        """Unknowns of ``shift + slope . x``: its values at the middles of the supports (Marsden's identity)."""
        value = np.full(self.shape, shift)
        for axis, size in enumerate(self.shape):
            middle = np.arange(size) + (1 - self.degree) / 2
            position = self.grid.lower[axis] + self.grid.spacing[axis] * middle
            value += slope[axis] * position.reshape((-1,) + (1,) * (len(self.shape) - 1 - axis))
        unknowns: Array = value.ravel()[self.free.dofs]
        return unknowns

    def assembler(self, symmetric: bool = True) -> Assembler:
        """Sparse assembler of a form of splines of this space."""
        from solvers.assembly import Assembler

        return Assembler(self, symmetric)

    def function(self, unknowns: Array) -> Spline:
        """The spline with the given unknowns."""
        return Spline(self.grid, self.degree, self.full_coefficients(unknowns))

    @cached_property
    def delicate_cells(self) -> Mask:
        """Cells with a B-spline that is free although no whole cell of its support lies in the domain.

        Its energy may be as small as its part in the domain. So these cells need a quadrature rule with positive
        weights; a moment-fitted one may make the energy negative. All cut cells are delicate for ``b-spline``, few or
        none for ``web-spline``.
        """
        sheltered = np.ones(self.shape, dtype=bool)
        sheltered.ravel()[self.free.exposed] = False
        return ~full_arrays(sheltered, self.degree)

    @cached_property
    def extension(self) -> Any:
        """The extension as a sparse matrix E, shape (n_dofs, size of the full array): full = E^T c."""
        return self.free.matrix(int(np.prod(self.shape)))

    def full_coefficients(self, coefficients: Array) -> Array:
        """Full tensor array of B-spline coefficients of the spline with the given unknowns."""
        full = np.zeros(int(np.prod(self.shape)))
        full[self.free.dofs] = coefficients
        full[self.free.outer] = (self.free.coefficients * coefficients[self.free.sources]).sum(axis=1)
        return full.reshape(self.shape)


def _too_coarse(cells: tuple[int, ...], degree: int, finer: Finer | None) -> str:
    """Say why WEB-splines cannot be built, and what would do."""
    array = "x".join([str(degree + 1)] * len(cells))
    needed = _grid_that_does(max(cells), len(cells), finer)
    remedy = f"use grid: {needed}" if needed else "use a finer grid"
    return (
        f"the grid of {'x'.join(map(str, cells))} cells is too coarse for WEB-splines: no whole cell lies in the "
        f"domain, so there is no {array} array of inner splines to extend from; {remedy}, or basis: b-spline"
    )


def _grid_that_does(cells: int, dimension: int, finer: Finer | None) -> int | None:
    """Number of cells along the longest side, found in steps of a quarter, at which a whole cell lies inside."""
    if finer is None:
        return None
    while True:
        cells = max(cells + 1, int(np.ceil(1.25 * cells)))
        if cells**dimension > TRIAL_CELLS:
            return None
        if (finer(cells).state == INNER).any():
            return cells
