"""Boxes inside cells, with the polynomials of the surfaces that matter there.

A *slot* is one of the ``m`` surfaces that matter in a box; boxes are kept in groups with the same number of slots and
the same polynomial degree, so that every step is one array operation over the group.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rfm.geometry.logic import Logic, Mask, Signs
from solvers.quadrature import bernstein
from solvers.quadrature.sampling import degree_of, sample

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from solvers.grid import Grid, Integers

RESAMPLINGS = 6
"""Halvings of a box in which a surface is not yet well approximated by its interpolant."""

FEW, QUADRATIC = 300, 2
"""So many boxes are not worth steps of their own for planes: these are taken for quadratic where some surface is."""


@dataclass(frozen=True, eq=False)
class Boxes:
    """A group of boxes.

    Attributes
    ----------
    row
        Number of the cell each box lies in, shape ``(n,)``.
    lower, width
        Corner and side lengths in unit coordinates of the cell, shape ``(n, d)``.
    slots
        Surface of each slot, shape ``(n, m)``.
    c
        Bernstein coefficients of the slots, shape ``(n, m, K+1, ..., K+1)``.
    noise
        Rounding (and interpolation) noise of the coefficients, shape ``(n, m)``.
    signs
        Signs of all surfaces, shape ``(n, S)``; those of the slots are 0.
    depth
        Number of halvings, shape ``(n,)``.
    """

    row: Integers
    lower: Array
    width: Array
    slots: Integers
    c: Array
    noise: Array
    signs: Signs
    depth: Integers

    def __len__(self) -> int:
        """Number of boxes."""
        return len(self.row)

    @property
    def dimension(self) -> int:
        """Number of directions."""
        return int(self.lower.shape[1])

    @property
    def degree(self) -> int:
        """Polynomial degree in each direction."""
        return int(self.c.shape[-1]) - 1

    @cached_property
    def range(self) -> tuple[Array, Array]:
        """Bounds of the slots, two arrays of shape ``(n, m)``."""
        return bernstein.bounds(self.c, self.dimension)

    @property
    def all_signs(self) -> Signs:
        """Signs of all surfaces; a surface that only touches the box counts by the side the box is on."""
        low, high = self.range
        return self._with(np.where(low >= -self.noise, 1, np.where(high <= self.noise, -1, 0)))

    def _with(self, slot_signs: Array | Integers) -> Signs:
        signs = self.signs.copy()
        np.put_along_axis(signs, self.slots, slot_signs.astype(np.int8), axis=1)
        return signs

    def take(self, rows: Integers) -> Boxes:
        """Return some of the boxes."""
        return Boxes(
            self.row[rows],
            self.lower[rows],
            self.width[rows],
            self.slots[rows],
            self.c[rows],
            self.noise[rows],
            self.signs[rows],
            self.depth[rows],
        )

    def choose(self, rows: Integers, slots: Integers, signs: Signs) -> Boxes:
        """Return boxes ``rows`` with only the slots ``slots (len(rows), m')`` and new signs of all surfaces."""
        pairs = rows[:, None], slots
        return Boxes(
            self.row[rows],
            self.lower[rows],
            self.width[rows],
            self.slots[pairs],
            self.c[pairs],
            self.noise[pairs],
            signs,
            self.depth[rows],
        )


def strict_signs(boxes: Boxes) -> Signs:
    """Return signs of all surfaces, 0 for one that touches the closed box."""
    low, high = boxes.range
    return boxes._with(np.where(low > boxes.noise, 1, np.where(high < -boxes.noise, -1, 0)))


def initial_boxes(logic: Logic, grid: Grid, cells: Integers, signs: Signs, active: Mask) -> list[Boxes]:
    """Sample the active surfaces of cells; boxes are halved until the interpolants are accurate.

    Parameters
    ----------
    logic
        The domain.
    grid, cells
        The cells ``(n, d)``; every one has an active surface.
    signs, active
        Signs of all surfaces and which of them matter, shape ``(n, S)``.
    """
    whole = np.zeros(cells.shape), np.ones(cells.shape)
    return list(_by_degree(logic, grid, cells, np.arange(len(cells)), *whole, signs, active))


def sampled_boxes(
    logic: Logic, grid: Grid, cells: Integers, rows: Integers, lower: Array, width: Array
) -> list[Boxes]:
    """Sample all surfaces on boxes inside cells.

    Parameters
    ----------
    logic
        The domain.
    grid, cells
        All cells ``(n, d)`` of the job.
    rows, lower, width
        Cell of each box, its corner and side lengths in unit coordinates of the cell.
    """
    signs = np.zeros((len(rows), len(logic.surfaces)), dtype=np.int8)
    return list(_by_degree(logic, grid, cells, rows, lower, width, signs, logic.relevant(signs)))


def _by_degree(
    logic: Logic,
    grid: Grid,
    cells: Integers,
    rows: Integers,
    lower: Array,
    width: Array,
    signs: Signs,
    active: Mask,
) -> Iterator[Boxes]:
    """Split boxes by the highest degree of their active surfaces, and sample them."""
    degrees = np.array([degree_of(surface) for surface in logic.surfaces])
    degree = np.where(active, degrees, 1).max(axis=1, initial=1)
    if len(rows) <= FEW and degree.max(initial=1) == QUADRATIC:
        degree[:] = QUADRATIC
    for k in np.flatnonzero(np.bincount(degree)):
        chosen = np.flatnonzero(degree == k)
        yield from _sampled(
            logic,
            grid,
            cells,
            rows[chosen],
            lower[chosen],
            width[chosen],
            signs[chosen],
            active[chosen],
            int(k),
        )


def _sampled(
    logic: Logic,
    grid: Grid,
    cells: Integers,
    rows: Integers,
    lower: Array,
    width: Array,
    signs: Signs,
    active: Mask,
    degree: int,
) -> Iterator[Boxes]:
    """Sample all surfaces at once, then group boxes by the number of active ones."""
    for depth in range(RESAMPLINGS + 1):
        box, surface = np.nonzero(active)
        samples = sample(logic.surfaces, surface, box, grid, cells[rows], lower, width, degree)
        good = np.ones(len(rows), dtype=bool)
        if depth < RESAMPLINGS:
            good[box[~samples.good]] = False
        count = active.sum(axis=1)
        first = np.cumsum(count) - count
        base = np.where(active, np.int8(0), signs)
        for m in np.flatnonzero(np.bincount(count[good])):
            keep = np.flatnonzero(good & (count == m))
            slots = first[keep, None] + np.arange(m)
            yield Boxes(
                rows[keep],
                lower[keep],
                width[keep],
                surface[slots],
                samples.coefficients[slots],
                samples.noise[slots],
                base[keep],
                np.full(len(keep), depth),
            )
        bad = np.flatnonzero(~good)
        if not bad.size:
            return
        # all halves of a level at once
        corners = np.array(list(np.ndindex(*[2] * grid.dimension)))
        every = np.tile(bad, len(corners))
        width = 0.5 * width[every]
        lower = lower[every] + width * np.repeat(corners, len(bad), axis=0)
        rows, signs, active = rows[every], signs[every], active[every]


def children(boxes: Boxes, axes: Iterable[int]) -> Boxes:
    """Halve boxes along some directions."""
    parts, corners = [boxes.c], [np.zeros(boxes.dimension)]
    size = np.ones(boxes.dimension)
    for axis in axes:
        parts = [half for c in parts for half in bernstein.bisect(c, 2 + axis)]
        size[axis] = 0.5
        shift = np.zeros(boxes.dimension)
        shift[axis] = 0.5
        corners = [corner + move for corner in corners for move in (0.0, shift)]
    every = np.tile(np.arange(len(boxes)), len(parts))
    corner = np.repeat(corners, len(boxes), axis=0)
    width = boxes.width[every]
    return Boxes(
        boxes.row[every],
        boxes.lower[every] + width * corner,
        width * size,
        boxes.slots[every],
        np.concatenate(parts),
        boxes.noise[every],
        boxes.signs[every],
        boxes.depth[every] + 1,
    )


def joined(groups: list[Boxes]) -> Boxes:
    """Join groups with the same number of slots and the same degree."""
    if len(groups) == 1:
        return groups[0]
    return Boxes(*(np.concatenate([getattr(group, name) for group in groups]) for name in _FIELDS))


def merged(groups: Iterable[Boxes]) -> list[Boxes]:
    """Join whatever groups can be joined."""
    kinds: dict[tuple[int, int], list[Boxes]] = {}
    for group in groups:
        if len(group):
            kinds.setdefault((group.slots.shape[1], group.degree), []).append(group)
    return [joined(kind) for kind in kinds.values()]


_FIELDS = tuple(field.name for field in fields(Boxes))
