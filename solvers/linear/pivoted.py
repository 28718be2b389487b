r"""Factorisations that choose among unknowns that depend on each other to rounding.

Global functions on a domain that is smaller than their box form a *frame*: the matrix is singular to rounding although
the field is determined. A factorisation with pivoting takes the functions one after the other, each time the one that
those taken represent worst, and stops when what is left is rounding; the others get the unknown zero (Higham, *Accuracy
and Stability of Numerical Algorithms*, SIAM 2002, section 10.3; Adcock and Huybrechs, SIAM Review 61, 2019).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.types import Array
from solvers.linear.direct import refine
from solvers.linear.system import INDEFINITE, ScaledSystem, refusal

if TYPE_CHECKING:
    from solvers.linear.nonsymmetric import Equilibrated

DEPENDENT = 1e-14
"""A function is dropped when the part of it that the others do not represent has less energy, relative to its own."""
NEGATIVE = 1e-9
"""Negative energy, relative to its own, that is more than rounding."""


@dataclass(frozen=True)
class PivotedCholesky:
    """Cholesky factorisation with complete pivoting, stopped at the numerical rank (LAPACK pstrf)."""

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve in the leading unknowns.

        Raises
        ------
        NumericsError
            Some function has negative energy.
        """
        from scipy.linalg.lapack import dpotrs, dpstrf

        array = system.scaled_array()
        pins = system.pins()
        array[pins, pins] += 1.0
        factor, pivots, rank, _ = dpstrf(array.T, lower=1, tol=DEPENDENT)
        chosen, dropped = pivots[:rank] - 1, pivots[rank:] - 1
        rest = np.diag(array)[dropped] - (np.tril(factor)[rank:, :rank] ** 2).sum(axis=1)
        if rest.min(initial=0.0) < -NEGATIVE:
            raise refusal(INDEFINITE, f"a function has {rest.min():.1e} of its energy")
        triangle = np.asfortranarray(factor[:rank, :rank])

        def apply(load: Array) -> Array:
            x = np.zeros(len(load))
            x[chosen] = dpotrs(triangle, load[chosen], lower=1)[0]
            return x

        return refine(system, apply, tolerance)


@dataclass(frozen=True)
class PivotedQR:
    """QR factorisation with column pivoting, stopped at the numerical rank (LAPACK geqp3), of any square matrix."""

    def solve(self, system: Equilibrated, tolerance: float) -> tuple[Array, int]:
        """Solve in the leading unknowns."""
        from scipy.linalg import qr, solve_triangular

        orthogonal, triangle, pivots = qr(system.scaled_array(), pivoting=True)
        size = np.abs(np.diag(triangle))
        rank = int(np.count_nonzero(size > DEPENDENT * size[0]))
        x = np.zeros(len(system.load))
        image = orthogonal[:, :rank].T @ (system.rows * system.load)
        x[pivots[:rank]] = solve_triangular(triangle[:rank, :rank], image)
        return x, 0
