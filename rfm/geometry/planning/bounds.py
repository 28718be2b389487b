"""How large an objective can be where a function is not negative: a proof by intervals.

Boxes in which the function is certainly negative, or the objective certainly below what is known to be reached, are
dropped; the others are halved (branch and bound: Moore, Kearfott, Cloud, *Introduction to Interval Analysis*, SIAM
2009, chapter 11).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.types import Array, Field
from rfm.errors import GeometryError
from rfm.geometry.box import Box
from rfm.geometry.logic import Mask
from rfm.geometry.singular.roots import halved

MOST_BOXES = 200_000
MOST_HALVINGS = 200


@dataclass(frozen=True)
class Bound:
    """Result of a proof.

    Attributes
    ----------
    value
        Nothing feasible is larger; -inf when nothing is feasible at all.
    boxes
        How many boxes were looked at.
    """

    value: float
    boxes: int


def upper_bound(
    feasible: Field, objective: Field, box: Box, reached: float = -np.inf, tolerance: float = 1e-3
) -> Bound:
    """Prove an upper bound of an objective where a function is not negative.

    Parameters
    ----------
    feasible, objective
        omega and F.
    box
        Where.
    reached
        A value that is known to be feasible, from a search; it saves most of the work.
    tolerance
        The bound is wanted to be within this of the largest value.

    Raises
    ------
    GeometryError
        The box is not finite, or the tolerance is not positive.
    """
    if not box.finite or box.empty:
        raise GeometryError(f"a bound needs a finite box, got {box.lower} to {box.upper}")
    if not tolerance > 0:
        raise GeometryError(f"the tolerance of a bound must be positive, got {tolerance:g}")
    lower, upper = np.array([box.lower]), np.array([box.upper])
    top, seen, size = -np.inf, 0, np.array(box.size)
    for _ in range(MOST_HALVINGS):
        seen += len(lower)
        possible, high, low = _on_boxes(feasible, objective, lower, upper)
        wanted = possible & (high > reached + tolerance)
        top = max(top, float(high[possible & ~wanted].max(initial=-np.inf)))
        narrow = wanted & (high - low <= tolerance)
        top = max(top, float(high[narrow].max(initial=-np.inf)))
        wanted &= ~narrow
        if not wanted.any():
            break
        lower, upper = _halved(lower[wanted], upper[wanted], size)
        if len(lower) > MOST_BOXES:
            top = max(top, float(high[wanted].max()))
            break
    else:
        top = max(top, float(high[wanted].max()))
    return Bound(max(top, reached), seen)


def _on_boxes(feasible: Field, objective: Field, lower: Array, upper: Array) -> tuple[Mask, Array, Array]:
    """Whether boxes can be feasible, and the bounds of the objective there."""
    coords = [Interval(lower[:, j], upper[:, j]) for j in range(lower.shape[1])]
    with np.errstate(all="ignore"):
        inside, value = Interval.of(feasible(*coords)), Interval.of(objective(*coords))
    shape = (len(lower),)
    possible = ~(np.broadcast_to(inside.hi, shape) < 0)
    high = np.nan_to_num(np.broadcast_to(value.hi, shape), nan=np.inf)
    low = np.nan_to_num(np.broadcast_to(value.lo, shape), nan=-np.inf)
    return possible, high, low


def _halved(lower: Array, upper: Array, size: Array) -> tuple[Array, Array]:
    """Halves across the side that is longest in units of the whole box."""
    low, high = halved(lower / size, upper / size)
    return low * size, high * size
