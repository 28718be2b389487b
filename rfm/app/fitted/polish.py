"""Points moved onto the zero sets of the surfaces they belong to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rfm.app.fitted.simplices import Flags
from rfm.calculus.jets import partials
from rfm.calculus.types import Array

if TYPE_CHECKING:
    from rfm.geometry.surface import Surface

STEPS = 3
"""Newton steps: from a chord of a subcell that is quadratic convergence to rounding, nearly."""

PARALLEL = 0.05
"""Gradients more nearly parallel than this count as one: a tangency, not a corner."""


def polish(x: Array, on: Flags, surfaces: Sequence[Surface], limit: float) -> Array:
    """Move points x (n, d) onto all surfaces of their row in `on` (n, s), by at most `limit`.

    Each step is the shortest one that makes the linearised functions vanish (Gauss-Newton); a point
    that would move farther than `limit` stays where it was.
    """
    moved = x.copy()
    rows = np.flatnonzero(on.any(axis=1))
    patterns, which = np.unique(on[rows], axis=0, return_inverse=True)
    for number, pattern in enumerate(patterns):
        chosen = rows[which == number]
        carriers = [surfaces[int(column)] for column in np.flatnonzero(pattern)]
        moved[chosen] = _newton(x[chosen], carriers)
    far = ~(np.linalg.norm(moved - x, axis=1) <= limit)
    moved[far] = x[far]
    return moved


def _newton(x: Array, carriers: Sequence[Surface]) -> Array:
    for _ in range(STEPS):
        coords = tuple(np.ascontiguousarray(x.T))
        with np.errstate(all="ignore"):
            jets = np.stack([partials(carrier.function, coords, 1) for carrier in carriers])
        jets = np.nan_to_num(jets, nan=0.0, posinf=0.0, neginf=0.0)
        slopes = jets[:, 1:]  # (carriers, d, n)
        lengths = np.sqrt((slopes**2).sum(axis=1))
        lengths = np.where(lengths == 0, 1, lengths)
        matrix = (slopes / lengths[:, None]).transpose(2, 0, 1)
        value = (jets[:, 0] / lengths).T
        if len(carriers) == 1:
            x = x - value * matrix[:, 0]
        else:
            x = x - (np.linalg.pinv(matrix, rcond=PARALLEL) @ value[:, :, None])[:, :, 0]
    return x
