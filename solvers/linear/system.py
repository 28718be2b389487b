"""A linear system scaled to a unit diagonal, checked before any method sees it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rfm.calculus.types import Array
from rfm.errors import NumericsError

if TYPE_CHECKING:
    from solvers.linear.lattice import Lattice

INDEFINITE = (
    "the matrix is not positive definite ({why}): the energy of some field is negative or not resolved; raise "
    "quadrature_points, turn moment fitting off, use basis: web-spline, or check the signs of conductivity and reaction"
)
SINGULAR = (
    "the matrix is singular ({why}): the solution is not unique; if there are only flux conditions, fix the solution "
    "with a Dirichlet or Robin condition, otherwise raise quadrature_points, use basis: web-spline, or lower the degree"
)


class Indefinite(NumericsError):  # noqa: N818 - reads as what happened
    """The energy of some field is negative."""


def refusal(problem: str, why: str) -> NumericsError:
    """Error for :data:`INDEFINITE` or :data:`SINGULAR` with its reason."""
    return (Indefinite if problem is INDEFINITE else NumericsError)(problem.format(why=why))


class NotConverged(NumericsError):  # noqa: N818 - reads as what happened
    """A method gave up on a matrix that another one may still solve."""


def nbytes(*matrices: Any) -> int:
    """Memory of arrays and of CSR matrices."""
    parts = [getattr(m, name, None) for m in matrices for name in ("data", "indices", "indptr")]
    return sum(int(part.nbytes) for part in parts if part is not None)


@dataclass(frozen=True, eq=False)
class ScaledSystem:
    """``D^-1/2 A D^-1/2 y = D^-1/2 b`` with ``x = D^-1/2 y``.

    Attributes
    ----------
    original
        The matrix A.
    load
        The load b, projected if there is a null space.
    scale
        The diagonal of ``D^-1/2``.
    null
        Orthonormal null vectors of the scaled matrix, shape (n, k); k may be 0.
    null_original
        Orthonormal null vectors of A.
    lattice
        Where the unknowns of each component sit, if they are coefficients of splines on a grid.
    kept
        Bytes of what methods keep besides the matrix, factors or preconditioners; they enter it.
    """

    original: Any
    load: Array
    scale: Array
    null: Array
    null_original: Array
    lattice: Lattice | None = None
    kept: dict[str, int] = field(default_factory=dict)

    @staticmethod
    def of(
        matrix: Any, load: Array, null_space: ArrayLike | None = None, lattice: Lattice | None = None
    ) -> ScaledSystem:
        """Check and scale a system.

        Raises
        ------
        NumericsError
            Numbers are not finite, or a diagonal entry is not positive.
        """
        n = len(load)
        if matrix.shape != (n, n):
            raise NumericsError(f"the matrix has shape {matrix.shape}, but the load has {n} entries")
        if not n:
            raise NumericsError("the linear system has no unknowns: refine the grid")
        entries = matrix if isinstance(matrix, np.ndarray) else matrix.data
        for name, array in (("matrix", entries), ("load", load)):
            with np.errstate(over="ignore", invalid="ignore"):
                total = array.sum()  # not finite when an entry is not; one pass without a temporary array
            if not np.isfinite(total) and not np.isfinite(array).all():
                raise NumericsError(
                    f"the {name} has entries that are not finite: a datum, the weight or a coefficient is not "
                    "finite somewhere in the domain; check them, or turn moment fitting off when a formula is "
                    "undefined just outside the domain"
                )
        vectors = (
            np.zeros((n, 0)) if null_space is None else np.asarray(null_space, dtype=float).reshape(n, -1)
        )
        # an unknown that is itself a null vector, as the first one of polynomials, has nothing on its diagonal
        diagonal = matrix.diagonal()
        diagonal = np.where((diagonal == 0) & vectors.any(axis=1), 1.0, diagonal)
        if not (diagonal > 0).all():
            worst = int(diagonal.argmin())
            problem, why = (INDEFINITE, "is negative") if diagonal[worst] < 0 else (SINGULAR, "is zero")
            raise refusal(problem, f"diagonal entry {worst} of {n} {why}")
        scale = 1.0 / np.sqrt(diagonal)
        null_original = np.linalg.qr(vectors)[0]
        null = np.linalg.qr(vectors / scale[:, None])[0]
        projected = load - null_original @ (null_original.T @ load)
        return ScaledSystem(matrix, projected, scale, null, null_original, lattice)

    @property
    def sparse(self) -> bool:
        """Whether the matrix is stored sparse."""
        return not isinstance(self.original, np.ndarray)

    @property
    def scaled_load(self) -> Array:
        """The load ``D^-1/2 b``."""
        return self.scale * self.load

    def scaled_array(self) -> Array:
        """Scaled matrix as a new array."""
        array = self.original.toarray() if self.sparse else self.original
        result: Array = array * self.scale[:, None]
        result *= self.scale
        return result

    def scaled_sparse(self) -> Any:
        """Scaled matrix as a new CSR matrix."""
        from scipy.sparse import csr_array

        matrix = csr_array(self.original, copy=True)
        matrix.data *= np.repeat(self.scale, np.diff(matrix.indptr))
        matrix.data *= self.scale[matrix.indices]
        return matrix

    def apply(self, scaled: Array) -> Array:
        """Scaled matrix times a vector, without a copy of the matrix."""
        product: Array = self.scale * (self.original @ (self.scale * scaled))
        return product

    def pins(self) -> NDArray[np.intp]:
        """Unknowns that fix the part along the null space.

        Adding 1 to their diagonal entries makes the matrix definite and, the load being orthogonal to the null space,
        leaves a solution of the singular system: one that vanishes there.
        """
        count = self.null.shape[1]
        if not count:
            return np.zeros(0, dtype=np.intp)
        from scipy.linalg import qr

        pivots = qr(self.null.T, mode="r", pivoting=True)[1]
        return np.asarray(pivots[:count], dtype=np.intp)

    def project(self, vector: Array) -> Array:
        """Remove the part of a scaled vector along the null space."""
        if not self.null.shape[1]:
            return vector
        projected: Array = vector - self.null @ (self.null.T @ vector)
        return projected

    def residual(self, scaled: Array) -> tuple[Array, float]:
        """Residual of a scaled solution, scaled, and the relative residual of the original system."""
        difference = self.load - self.original @ (self.scale * scaled)
        return self.scale * difference, float(np.linalg.norm(difference) / np.linalg.norm(self.load))

    def backward_error(self, scaled: Array) -> float:
        """Bound ``|r| / (|y| + |b|)`` of the relative change to the scaled system that `scaled` solves exactly."""
        remainder, _ = self.residual(scaled)
        return float(np.linalg.norm(remainder) / (np.linalg.norm(scaled) + np.linalg.norm(self.scaled_load)))

    def unscale(self, scaled: Array) -> tuple[Array, float]:
        """Solution of the original system, orthogonal to the null space, and its relative residual."""
        x = self.scale * scaled
        x = x - self.null_original @ (self.null_original.T @ x)
        difference = self.load - self.original @ x
        return x, float(np.linalg.norm(difference) / np.linalg.norm(self.load))
