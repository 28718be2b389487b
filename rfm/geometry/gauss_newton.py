"""The nearest common zeros of fewer fields than coordinates, by Gauss-Newton steps.

Notation: F = (f_1, ..., f_k) fields, J = dF/dx; the step -J^T (J J^T)^{-1} F is the shortest one that solves the
linearised equations, so that starts go to nearby points of {F = 0}.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field

Mask = NDArray[np.bool_]

STEPS = 12
CONVERGED = 1e-10
"""Steps this short, relative to the size, count as converged."""
DONE = 1e-15


def nearest_zeros(functions: Sequence[Field], starts: Array, size: float) -> Array:
    """Return the limits ``(m, d)`` of the iteration, without the starts that did not converge.

    The arguments are those of :func:`iterated`.
    """
    points, converged = iterated(functions, starts, size)
    return points[converged]


def iterated(functions: Sequence[Field], starts: Array, size: float) -> tuple[Array, Mask]:
    """Return the last iterates ``(n, d)`` and whether they are common zeros.

    Parameters
    ----------
    functions
        Fields, at most as many as coordinates.
    starts
        ``(n, d)``.
    size
        Length scale: steps are shorter than half of it.
    """
    x = starts.T.copy()
    with np.errstate(all="ignore"):  # starts may leave the formulas' domain; they do not count as converged
        for _ in range(STEPS):
            step, _ = _step(functions, x)
            length = np.nan_to_num(np.sqrt((step**2).sum(axis=0)))
            x += step * np.minimum(1.0, 0.5 * size / np.maximum(length, 1e-300))
            if length.max(initial=0.0) < DONE * size:
                break
        step, values = _step(functions, x)
        small = np.sqrt((step**2).sum(axis=0)) < CONVERGED * size
        small &= np.abs(values).max(axis=0) < 1e-6 * size
    return x.T, small & np.isfinite(x).all(axis=0)


def _step(functions: Sequence[Field], x: Array) -> tuple[Array, Array]:
    """Return the Gauss-Newton step ``(d, n)`` and the values ``(k, n)``."""
    jets = np.stack([partials(f, tuple(x), 1) for f in functions])
    values, slopes = jets[:, 0], jets[:, 1:]
    gram = np.nan_to_num(np.einsum("ikn,jkn->nij", slopes, slopes))
    diagonal = np.arange(len(functions))
    # parallel gradients (tangent surfaces) and vanishing ones stay solvable
    gram[:, diagonal, diagonal] += 1e-14 * np.trace(gram, axis1=1, axis2=2)[:, None] + 1e-200
    multipliers = np.linalg.solve(gram, values.T[:, :, None])[:, :, 0]
    return -np.einsum("ni,ikn->kn", multipliers, slopes), values
