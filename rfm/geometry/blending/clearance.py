"""A box around a set that is known by its function only: its faces are proved to lie outside.

Operations that add material (blends, offsets) give a function, not a support function.  The box of what
they started from is widened until interval arithmetic proves the function negative on all of its faces; what
lies beyond the box, if anything, is not connected to what is inside and does not belong to the shape.
"""

from __future__ import annotations

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.types import Array, Field
from rfm.errors import GeometryError
from rfm.geometry.box import Box

MARGINS = (0.06, 0.12, 0.25, 0.5, 1.02, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0)
"""Multiples of the expected margin that are tried, the tightest first."""

_FINEST = 1e-3
"""Least margin in terms of the box: bounds that are finer than that cost too many cells."""

_START = 8
_DEPTH = 6
_MOST = 60_000


def cleared(field: Field, box: Box, margin: float, what: str) -> Box:
    """Widen a finite box by about ``margin``, as little as makes the field negative on all of its faces.

    Raises
    ------
    GeometryError
        When that does not come to an end; ``what`` names the operation.
    """
    margin = max(margin, _FINEST * max(box.size))
    for multiple in MARGINS:
        widened = box.padded(margin * multiple)
        if all(_negative(field, *face) for face in _faces(widened)):
            return widened
    raise GeometryError(
        f"no box can be found around {what}: its function does not become negative; use less of it"
    )


def _faces(box: Box) -> list[tuple[Array, Array]]:
    """Cells of every face, as lower and upper corners ``(n, d)``."""
    d = box.dimension
    found = []
    for axis in range(d):
        for bound in (box.lower[axis], box.upper[axis]):
            counts = [1 if j == axis else _START for j in range(d)]
            edges = [np.linspace(box.lower[j], box.upper[j], counts[j] + 1) for j in range(d)]
            lows = [edge[:-1] for edge in edges]
            highs = [edge[1:] for edge in edges]
            lows[axis] = highs[axis] = np.array([bound])
            lower, upper = (
                np.stack(np.meshgrid(*ends, indexing="ij"), axis=-1).reshape(-1, d) for ends in (lows, highs)
            )
            found.append((lower, upper))
    return found


def _negative(field: Field, lower: Array, upper: Array) -> bool:
    """Whether the field is certainly negative on all of the cells, which are split where it is not certain."""
    for _ in range(_DEPTH):
        with np.errstate(all="ignore"):
            values = Interval.of(field(*(Interval(lower[:, j], upper[:, j]) for j in range(lower.shape[1]))))
        open_ = np.broadcast_to(~(np.asarray(values.hi) < 0.0), len(lower))
        if not open_.any():
            return True
        if np.any(np.broadcast_to(np.asarray(values.lo), len(lower)) > 0.0) or open_.sum() > _MOST:
            return False
        lower, upper = _halved(lower[open_], upper[open_])
    return False


def _halved(lower: Array, upper: Array) -> tuple[Array, Array]:
    """Split boxes in the middle of every side that has a length."""
    for j in range(lower.shape[1]):
        if (upper[:, j] == lower[:, j]).all():
            continue
        middle = 0.5 * (lower[:, j] + upper[:, j])
        low, high = lower.copy(), upper.copy()
        low[:, j], high[:, j] = middle, middle
        lower, upper = np.concatenate([lower, low]), np.concatenate([high, upper])
    return lower, upper
