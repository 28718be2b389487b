r"""Factorisations that say how well conditioned they are.

The condition number of the matrix scaled to a unit diagonal is estimated by a few steps of inverse iteration from a
random vector (Higham, *Accuracy and Stability of Numerical Algorithms*, SIAM 2002, chapter 15): its 1-norm, which
bounds the largest eigenvalue, over the smallest eigenvalue that the steps have found.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.linear.choice import SPARSE_LIMIT
from solvers.linear.system import ScaledSystem

DENSE = 2500
"""Unknowns up to which the matrix is factorised as a dense one."""
STEPS = 6
"""Steps of inverse iteration."""


@dataclass(frozen=True, eq=False)
class Factors:
    """A factorisation of the scaled matrix.

    Attributes
    ----------
    apply
        Solves with the scaled matrix.
    condition
        Estimate of its condition number; infinite when it is not positive definite to rounding.
    method
        What it is.
    """

    apply: Callable[[Array], Array]
    condition: float
    method: str


def condition_number(matrix: Any, load: Array) -> float | None:
    """Estimate the condition number of a symmetric positive definite matrix scaled to a unit diagonal.

    Infinite when the matrix is not positive definite to rounding, None when its factors would be too large.
    """
    factors = factorise(ScaledSystem.of(matrix, load))
    return None if factors is None else factors.condition


def factorise(system: ScaledSystem) -> Factors | None:
    """Factorise a system, or return None when the factors would be too large."""
    if not system.sparse or len(system.load) <= DENSE:
        return _cholesky(system)
    if system.original.nnz <= SPARSE_LIMIT:
        return _superlu(system)
    return None


def _cholesky(system: ScaledSystem) -> Factors:
    from scipy.linalg.lapack import dpotrf, dpotrs

    array = system.scaled_array()
    norm = float(np.abs(array).sum(axis=0).max())
    factor, info = dpotrf(array.T, lower=1, clean=0)

    def apply(b: Array) -> Array:
        return np.asarray(dpotrs(factor, b, lower=1)[0])

    return Factors(apply, norm * _norm_of_inverse(apply, len(array)) if info == 0 else np.inf, "dense")


def _superlu(system: ScaledSystem) -> Factors | None:
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    matrix = system.scaled_sparse()
    # the matrix is symmetric: its CSR arrays are the CSC arrays
    columns = csc_array((matrix.data, matrix.indices, matrix.indptr), shape=matrix.shape)
    try:
        factors = splu(
            columns, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except MemoryError:
        return None
    except RuntimeError:  # exactly singular
        return Factors(lambda b: b, np.inf, "superlu")
    definite = factors.U.diagonal().min() > 0
    norm = float(abs(matrix).sum(axis=0).max())
    condition = norm * _norm_of_inverse(factors.solve, len(system.load)) if definite else np.inf
    return Factors(factors.solve, condition, "superlu")


def _norm_of_inverse(apply: Callable[[Array], Array], size: int) -> float:
    """Estimate, from below, of the norm of the symmetric inverse that `apply` multiplies with."""
    vector = np.random.default_rng(0).standard_normal(size)
    growth = 0.0
    for _ in range(STEPS):
        vector = apply(vector / np.linalg.norm(vector))
        growth = float(np.linalg.norm(vector))
    return growth
