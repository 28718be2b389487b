"""How smooth a function is at a point, told from its derivatives around it.

A function has k continuous derivatives at a point when those of order k, taken on a small circle (in space on a small
circle across an edge) around it, agree ever better as the circle shrinks.  Beside an R-function of degree one the
slopes never agree; beside an analytic function the spread of every derivative falls in proportion to the radius.

Notation: s_k(r) the largest spread of a derivative of order k over a circle of radius r.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field

HIGHEST = 4
"""Derivatives that are looked at."""
RADII = (1e-3, 2.5e-4)
DIRECTIONS = 24
FALLS = 0.6
"""s_k(r/4) below this times s_k(r): the derivatives have a limit."""
ROUNDING = 1e-7


def continuous_derivatives(
    field: Field, inside: Field, point: Sequence[float], size: float, plane: Array | None = None
) -> int:
    """Number of continuous derivatives of a field at a point, within a domain.

    Parameters
    ----------
    field
        The function.
    inside
        Not negative in the closed domain; what is outside does not count.
    point
        Coordinates (d,).
    size
        Length scale of the domain.
    plane
        Two orthonormal directions (2, d) that span the circle; the plane itself by default.

    Returns
    -------
    int
        0 to :data:`HIGHEST`; the latter means at least so many.
    """
    d = len(point)
    axes = np.eye(2) if plane is None else plane
    turns = 2 * np.pi * (np.arange(DIRECTIONS) + 0.37) / DIRECTIONS
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1) @ axes
    orders = np.array([sum(alpha) for alpha in multi_indices(d, HIGHEST)])
    spreads, unit = [], 0.0
    for radius in RADII:
        points = np.asarray(point) + radius * size * ring
        counted = partials(inside, tuple(points.T), 0)[0] >= 0
        jets = partials(field, tuple(points[counted].T), HIGHEST)
        scale = size ** orders.astype(float)
        scaled = jets * scale[:, None]
        spread = np.nan_to_num(np.ptp(scaled, axis=1), nan=np.inf) if counted.any() else np.zeros(len(orders))
        spreads.append(np.array([spread[orders == k].max() for k in range(1, HIGHEST + 1)]))
        unit = max(unit, float(np.nan_to_num(np.abs(scaled[orders <= 2])).max(initial=0.0)))
    wide, narrow = spreads
    agrees = (narrow < FALLS * wide) | (narrow <= ROUNDING * unit)
    return int(np.argmin(agrees)) if not agrees.all() else HIGHEST
