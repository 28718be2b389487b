"""All corners of a plane shape.

Candidates are the common zeros of two surfaces; those stay at which the boundary of the *final* shape has a corner
(:mod:`rfm.geometry.singular.sectors`).  Boxes that hold fewer than two surfaces that matter are dropped by interval
bounds, zeros in the others are isolated and certified (:mod:`rfm.geometry.singular.roots`), so none is missed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.box import Box
from rfm.geometry.logic import Logic, Mask
from rfm.geometry.shape import Shape
from rfm.geometry.singular.boxes import crowded, search_box, signs_on, tuples_in
from rfm.geometry.singular.roots import common_zeros, distinct
from rfm.geometry.singular.sectors import PARALLEL, sectors
from rfm.geometry.surface import Surface

DEPTH = 8
"""Halvings of the box before zeros are isolated."""
VANISHES = 1e-11
"""A surface passes through a point when it vanishes within this fraction of the shape's size."""
VANISHES_AT_CONTACT = 1e-5
"""The same where surfaces touch, whose common point is known less accurately."""


@dataclass(frozen=True)
class Corner:
    """A point of the boundary without a tangent.

    Attributes
    ----------
    point
        Its coordinates.
    surfaces
        The surfaces that meet there.
    angles
        Interior angles in radians: one at an ordinary corner, several where the shape touches itself, none at a cusp.
    contact
        Whether surfaces touch instead of crossing; the point is then accurate to some 1e-6 of the size only.
    """

    point: tuple[float, ...]
    surfaces: tuple[Surface, ...]
    angles: tuple[float, ...]
    contact: bool = False

    @property
    def convex(self) -> bool:
        """Whether there is one interior angle, below 180 degrees."""
        return len(self.angles) == 1 and self.angles[0] < math.pi


def corners(shape: Shape, box: Box | None = None) -> tuple[Corner, ...]:
    """Find every corner of a plane shape.

    Parameters
    ----------
    shape
        The shape.
    box
        Where to search; the shape's box by default.

    Returns
    -------
    tuple of Corner
        In lexicographic order of their points, which are accurate to rounding.

    Raises
    ------
    GeometryError
        The shape is not plane, or is unbounded and no box is given.
    """
    if shape.dimension != 2:
        raise GeometryError(
            f"corners are for plane shapes, this one has dimension {shape.dimension}: use edges"
        )
    logic = Logic(shape.expression, shape.surfaces)
    lower, upper = search_box(shape, box)
    size = float((upper - lower).max())
    boxes_lower, boxes_upper, mask = crowded(logic, lower, upper, 2, DEPTH)
    points, contacts = [np.empty((0, 2))], [np.empty((0, 2))]
    coincident: set[frozenset[int]] = set()
    for (i, j), rows in tuples_in(mask, 2).items():
        pair = (logic.surfaces[i], logic.surfaces[j])
        zeros = common_zeros([s.function for s in pair], boxes_lower[rows], boxes_upper[rows])
        if not zeros.isolated:  # the same line twice
            coincident.add(frozenset((i, j)))
        points.append(zeros.points)
        contacts.append(zeros.contacts)
    found = [
        corner
        for crossing, contact in ((points, False), (contacts, True))
        for corner in _corners(
            logic, distinct(np.concatenate(crossing), 1e-9 * size), size, contact, coincident
        )
    ]
    return tuple(sorted(found, key=lambda corner: corner.point))


def _corners(
    logic: Logic, points: Array, size: float, contact: bool, coincident: set[frozenset[int]]
) -> list[Corner]:
    """Corners among common zeros (n, 2): where the final boundary passes and is not smooth."""
    reach, parallel = (VANISHES_AT_CONTACT, 1e-3) if contact else (VANISHES, PARALLEL)
    active, gradients = passing(logic, points, reach * size)
    signs = signs_on(logic, points, points)
    found = []
    for row, point in enumerate(points):
        here = np.flatnonzero(active[row])
        once = [i for k, i in enumerate(here) if not any({i, j} in coincident for j in here[:k])]
        around = sectors(logic, signs[row], here, gradients[row, here], parallel, len(once))
        if around.smooth or not (around.angles or around.tangent):
            continue
        surfaces = tuple(logic.surfaces[i] for i in here)
        found.append(Corner(tuple(point.tolist()), surfaces, around.angles, contact))
    return found


def passing(logic: Logic, points: Array, reach: float) -> tuple[Mask, Array]:
    """Which surfaces pass points (n, d) within `reach`, shape (n, S), and all gradients, shape (n, S, d)."""
    jets = np.stack([partials(s.function, tuple(points.T), 1) for s in logic.surfaces], axis=1)
    slopes = np.linalg.norm(jets[1:], axis=0)
    with np.errstate(all="ignore"):
        active = np.abs(jets[0]) <= reach * np.maximum(slopes, 1e-12)
    return active.T, np.moveaxis(jets[1:], 0, 2).swapaxes(0, 1)
