"""Which cells lie inside the domain, outside, or are cut by its boundary.

Three tests, each on the cells the one before left open: interval bounds of the surface functions (first on blocks of
cells); bounds by Bernstein coefficients and signs at some nodes (a cell with nodes inside and outside is cut); and
bounds on ever smaller boxes.  What stays undecided counts as cut, so nothing thin is missed (for surfaces that are not
polynomials the Bernstein bounds include a sampled interpolation error).  The coefficients are kept for the quadrature.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.errors import GeometryError
from rfm.geometry.logic import Logic, Mask, Signs
from solvers.quadrature import bernstein
from solvers.quadrature.boxes import Boxes, children, initial_boxes, merged, strict_signs
from solvers.quadrature.sampling import degree_of, relative_noise

if TYPE_CHECKING:
    from rfm.geometry.shape import Shape
    from solvers.grid import Grid, Integers

INNER, CUT, OUTER = 1, 0, -1
BLOCK = 8
HALVINGS = 3
SAMPLES = (0.0, 1.0), (0.0, 0.5, 1.0)
"""Where signs are looked at: corners, then the middles of edges and faces too (where holes bulge into a cell)."""
CHUNK = 32768


@dataclass(frozen=True, eq=False)
class Classification:
    """State of every cell of a grid.

    Attributes
    ----------
    grid
        The grid.
    state
        int8 array of shape ``grid.shape``: 1 inner (the whole cell lies in the closed domain), 0 cut, -1 outer.
    touching
        bool array of shape ``grid.shape``: inner cells with a surface of the domain on their faces.
    signs
        Sign of every surface, shape ``(n_cut + n_touching, n_surfaces)``: first the cut cells, then the touching ones;
        0 where the surface meets the closed cell.
    active
        Same shape: which surfaces meet the cell and matter for its state.
    boxes
        These cells with the polynomials of the surfaces that may matter there; rows are those of ``signs``.
    """

    grid: Grid
    state: Signs
    touching: Mask
    signs: Signs
    active: Mask
    boxes: tuple[Boxes, ...]

    @property
    def cut_cells(self) -> Integers:
        """Indices of the cut cells, shape ``(n, d)``."""
        return np.argwhere(self.state == CUT)

    @property
    def inner_cells(self) -> Integers:
        """Indices of the inner cells, shape ``(n, d)``."""
        return np.argwhere(self.state == INNER)

    @property
    def touching_cells(self) -> Integers:
        """Indices of the inner cells that carry boundary on a face, shape ``(n, d)``."""
        return np.argwhere(self.touching)

    def within(self, mask: Mask) -> Classification:
        """Return the same for the marked cells, all others being outer ones."""
        rows = np.concatenate([mask[self.state == CUT], mask[self.touching]])
        place = np.where(rows, np.cumsum(rows) - 1, -1)
        boxes = (replace(group, row=place[group.row]) for group in self.boxes)
        return Classification(
            self.grid,
            np.where(mask, self.state, np.int8(OUTER)),
            self.touching & mask,
            self.signs[rows],
            self.active[rows],
            tuple(group.take(np.flatnonzero(group.row >= 0)) for group in boxes if (group.row >= 0).any()),
        )


def classify(domain: Shape, grid: Grid) -> Classification:
    """Classify the cells of a grid.

    Raises
    ------
    GeometryError
        If the domain has another dimension than the grid, is empty, or does not touch the grid.
    """
    if domain.dimension != grid.dimension:
        raise GeometryError(
            f"a {domain.dimension}D domain needs a {domain.dimension}D grid, got {grid.dimension}D"
        )
    logic = Logic(domain.expression, domain.surfaces)
    state = np.full(grid.shape, OUTER, dtype=np.int8)
    touching = np.zeros(grid.shape, dtype=bool)
    flat, flat_touching = state.reshape(-1), touching.reshape(-1)
    found: list[_Open] = []
    for cells in _candidates(logic, grid, flat):
        signs = _interval_signs(logic, grid, cells, np.ones_like(cells))
        value = logic.value(signs)
        numbers = _numbers(grid, cells)
        flat[numbers] = value
        left = np.flatnonzero(value == 0)
        if left.size:
            boxes = initial_boxes(logic, grid, cells[left], signs[left], logic.relevant(signs[left]))
            verdict, touches, signs = _decide(logic, boxes, len(left))
            flat[numbers[left]] = verdict
            flat_touching[numbers[left]] = touches
            found.append(_Open(numbers[left], signs, boxes))
    if not (state >= 0).any():
        raise GeometryError(
            "the domain is empty or lies outside the grid: check the Boolean expression, and the box if one is given"
        )
    signs, kept = _gather(len(logic.surfaces), flat, flat_touching, found)
    return Classification(grid, state, touching, signs, logic.relevant(signs), kept)


@dataclass(frozen=True, eq=False)
class _Open:
    """Cells that intervals leave open: their numbers ``(n,)``, signs ``(n, S)`` and boxes."""

    numbers: Integers
    signs: Signs
    boxes: list[Boxes]


def _gather(
    surfaces: int, state: Signs, touching: Mask, found: list[_Open]
) -> tuple[Signs, tuple[Boxes, ...]]:
    """Signs and boxes of the cut cells, then of the touching ones, each in the order of their numbers."""
    if not found:
        return np.zeros((0, surfaces), dtype=np.int8), ()
    numbers = np.concatenate([some.numbers for some in found])
    order = np.argsort(numbers, kind="stable")
    chosen = np.concatenate([order[state[numbers[order]] == CUT], order[touching[numbers[order]]]])
    place = np.full(len(numbers), -1)
    place[chosen] = np.arange(len(chosen))
    kept: list[Boxes] = []
    start = 0
    for some in found:
        for boxes in some.boxes:
            row = place[start + boxes.row]
            kept.append(replace(boxes, row=row).take(np.flatnonzero(row >= 0)))
        start += len(some.numbers)
    return np.concatenate([some.signs for some in found])[chosen], tuple(merged(kept))


def _numbers(grid: Grid, cells: Integers) -> Integers:
    return np.asarray(np.ravel_multi_index(tuple(cells.T), grid.shape), dtype=np.int64)


def _candidates(logic: Logic, grid: Grid, state: Signs) -> Iterator[Integers]:
    """Chunks of cells that blocks of cells leave open; decided blocks are written to ``state``."""
    total = int(np.prod(grid.cells))
    if total <= BLOCK**grid.dimension * 8:
        yield np.stack(np.unravel_index(np.arange(total), grid.shape), axis=1).astype(np.int64)
        return
    counts = -(-grid.cells // BLOCK)
    blocks = BLOCK * np.stack(np.unravel_index(np.arange(int(np.prod(counts))), counts), axis=1).astype(
        np.int64
    )
    sizes = np.minimum(BLOCK, grid.cells - blocks)
    values = np.concatenate(
        [
            logic.value(_interval_signs(logic, grid, blocks[i : i + CHUNK], sizes[i : i + CHUNK]))
            for i in range(0, len(blocks), CHUNK)
        ]
    )
    offsets = np.stack(np.unravel_index(np.arange(BLOCK**grid.dimension), (BLOCK,) * grid.dimension), axis=1)
    step = max(1, CHUNK // len(offsets))
    for wanted in (INNER, CUT):
        chosen = blocks[values == wanted]
        for i in range(0, len(chosen), step):
            cells = (chosen[i : i + step, None, :] + offsets).reshape(-1, grid.dimension)
            cells = cells[(cells < grid.cells).all(axis=1)]
            if wanted == INNER:
                state[_numbers(grid, cells)] = INNER
            else:
                yield cells


def _interval_signs(logic: Logic, grid: Grid, first: Integers, size: Integers) -> Signs:
    """Signs of all surfaces on blocks of cells ``[first, first + size)`` by interval arithmetic."""
    low = grid.lower + grid.spacing * first
    high = grid.lower + grid.spacing * (first + size)
    coords = [Interval(low[:, j], high[:, j]) for j in range(grid.dimension)]
    signs = np.zeros((len(first), len(logic.surfaces)), dtype=np.int8)
    with np.errstate(all="ignore"):
        for i, surface in enumerate(logic.surfaces):
            bound = surface.function(*coords)
            lo, hi = (bound.lo, bound.hi) if isinstance(bound, Interval) else (bound, bound)
            # A surface within rounding of a face is left to the test that knows about touching.
            margin = 2.0 * relative_noise(grid, degree_of(surface)) * np.maximum(np.abs(lo), np.abs(hi))
            signs[:, i] = np.where(lo > margin, 1, np.where(hi < -margin, -1, 0))
    return signs


def _decide(logic: Logic, boxes: list[Boxes], count: int) -> tuple[Signs, Mask, Signs]:
    """Decide cells that intervals leave open; also says which touch and returns the signs of all surfaces."""
    inside, outside, unknown, touches = (np.zeros(count, dtype=bool) for _ in range(4))
    lowest = np.ones((count, len(logic.surfaces)), dtype=np.int8)
    highest = -lowest
    pending = []
    for group in boxes:
        strict = strict_signs(group)
        np.minimum.at(lowest, group.row, strict)
        np.maximum.at(highest, group.row, strict)
        value = logic.value(group.all_signs)
        inside[group.row[value > 0]] = True
        outside[group.row[value < 0]] = True
        # Inside, though strictly speaking undecided: some surface lies on a face.
        touches[group.row[(value > 0) & (logic.value(strict) == 0)]] = True
        pending.append(group.take(np.flatnonzero(value == 0)))
    for nodes in SAMPLES:
        pending = _unsettled(pending, inside, outside)
        for left in pending:
            value = _at_nodes(logic, left, nodes)
            inside[left.row[(value > 0).any(axis=1)]] = True
            outside[left.row[(value < 0).any(axis=1)]] = True
    for left in _halved(logic, pending, inside, outside):
        unknown[left.row] = True
    verdict = np.where(
        inside & ~outside & ~unknown, INNER, np.where(outside & ~inside & ~unknown, OUTER, CUT)
    ).astype(np.int8)
    return verdict, touches & (verdict == INNER), np.where(lowest == highest, lowest, np.int8(0))


def _unsettled(pending: list[Boxes], inside: Mask, outside: Mask) -> list[Boxes]:
    """Boxes of the cells that are not known to be cut."""
    pending = [boxes.take(np.flatnonzero(~(inside & outside)[boxes.row])) for boxes in pending]
    return [boxes for boxes in pending if len(boxes)]


def _at_nodes(logic: Logic, boxes: Boxes, nodes: tuple[float, ...]) -> Signs:
    """Value at tensor nodes of boxes, shape ``(n, q)``; 0 where it is not well inside or outside."""
    n, m = boxes.slots.shape
    values, matrix = boxes.c, bernstein.basis(boxes.degree, np.array(nodes))
    for axis in range(2, values.ndim):
        values = bernstein.transform(matrix, values, axis)
    values = values.reshape(n, m, -1)
    noise = 1e-10 * np.abs(values).max(axis=2, keepdims=True)
    slot_signs = (values > noise).astype(np.int8) - (values < -noise)
    count = values.shape[2]
    signs = np.repeat(boxes.signs, count, axis=0)
    slots = np.repeat(boxes.slots, count, axis=0)
    np.put_along_axis(signs, slots, slot_signs.swapaxes(1, 2).reshape(-1, m), axis=1)
    return logic.value(signs).reshape(n, count)


def _halved(logic: Logic, pending: list[Boxes], inside: Mask, outside: Mask) -> list[Boxes]:
    """Look at smaller and smaller boxes, note in which cells some lie inside and outside; what stays undecided."""
    for _ in range(HALVINGS):
        following = []
        for boxes in _unsettled(pending, inside, outside):
            halves = children(boxes, range(boxes.dimension))
            value = logic.value(halves.all_signs)
            inside[halves.row[value > 0]] = True
            outside[halves.row[value < 0]] = True
            following.append(halves.take(np.flatnonzero(value == 0)))
        pending = following
    return _unsettled(pending, inside, outside)
