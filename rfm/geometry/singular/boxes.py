"""Boxes in which several surfaces of a shape meet and matter.

The box of a shape is halved in all directions; a part of it is dropped as soon as interval bounds show that fewer than
`count` surfaces can both vanish there and decide what belongs to the shape (:class:`rfm.geometry.logic.Logic`).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.box import Box
from rfm.geometry.logic import Logic, Mask, Signs
from rfm.geometry.shape import Shape

MOST_BOXES = 60_000
"""Boxes above which halving ends: memory is bounded."""
SLACK = 1e-9
"""Enlargement of a box so that what lies on its faces is inside."""


def signs_on(logic: Logic, lower: Array, upper: Array) -> Signs:
    """Signs of all surfaces on boxes (n, d), 0 where a surface may vanish; shape (n, S)."""
    signs = np.zeros((len(lower), len(logic.surfaces)), dtype=np.int8)
    coords = [Interval(lower[:, j], upper[:, j]) for j in range(lower.shape[1])]
    with np.errstate(all="ignore"):
        for i, surface in enumerate(logic.surfaces):
            bound = Interval.of(surface.function(*coords))
            signs[:, i] = np.where(bound.lo > 0, 1, np.where(bound.hi < 0, -1, 0))
    return signs


def search_box(shape: Shape, box: Box | None) -> tuple[Array, Array]:
    """Corners (1, d) of the box to search: the one given, or that of the shape, slightly enlarged.

    Raises
    ------
    GeometryError
        The shape is unbounded and no box was given.
    """
    found = box or shape.box
    if not found.finite or found.empty:
        raise GeometryError(
            f"the shape has the box {found.lower} to {found.upper}: give a finite box in which to search"
        )
    lower, upper = np.array([found.lower]), np.array([found.upper])
    margin = 1e-3 * (upper - lower).max()
    return lower - margin, upper + 1.01 * margin  # not symmetric: halving must not hit planes of symmetry


def crowded(logic: Logic, lower: Array, upper: Array, count: int, depth: int) -> tuple[Array, Array, Mask]:
    """Boxes in which at least `count` surfaces meet and matter.

    Parameters
    ----------
    logic
        Expression and surfaces of the shape.
    lower, upper
        Corners of the boxes to begin with, shape (n, d).
    count
        Number of surfaces.
    depth
        Halvings at most.

    Returns
    -------
    tuple
        Corners (m, d) of what is left and which surfaces are active there, shape (m, S).
    """
    mask = np.ones((len(lower), len(logic.surfaces)), dtype=bool)
    for level in range(depth + 1):
        margin = SLACK * (upper - lower)
        mask = logic.relevant(signs_on(logic, lower - margin, upper + margin))
        busy = mask.sum(axis=1) >= count
        lower, upper, mask = lower[busy], upper[busy], mask[busy]
        if level == depth or len(lower) * 2 ** lower.shape[1] > MOST_BOXES:
            break
        lower, upper = split(lower, upper)
    return lower, upper, mask


def split(lower: Array, upper: Array) -> tuple[Array, Array]:
    """All 2^d parts of boxes (n, d)."""
    middle = 0.5 * (lower + upper)
    lows, highs = [], []
    for side in product((False, True), repeat=lower.shape[1]):
        lows.append(np.where(side, middle, lower))
        highs.append(np.where(side, upper, middle))
    return np.concatenate(lows), np.concatenate(highs)


def tuples_in(mask: Mask, count: int) -> dict[tuple[int, ...], Sequence[int]]:
    """Boxes in which each `count` surfaces are active together, by the numbers of the surfaces."""
    from itertools import combinations

    found: dict[tuple[int, ...], list[int]] = {}
    for row, active in enumerate(mask):
        for chosen in combinations(np.flatnonzero(active).tolist(), count):
            found.setdefault(chosen, []).append(row)
    return {key: found[key] for key in sorted(found)}
