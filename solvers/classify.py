"""Which cells lie inside the domain, outside, or are cut by its boundary.

Three tests, each on the cells the one before left open: interval bounds of the surface functions (first on blocks of
cells), signs at the corners (a cell with corners inside and outside is cut), and bounds by Bernstein coefficients on
ever smaller boxes.  What stays undecided counts as cut, so nothing thin is missed (for surfaces that are not
polynomials the Bernstein bounds include a sampled interpolation error).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.errors import GeometryError
from rfm.geometry.logic import Logic, Mask, Signs
from solvers.quadrature.boxes import children, initial_boxes, strict_signs
from solvers.quadrature.sampling import corner_points, degree_of, relative_noise, values_at

if TYPE_CHECKING:
    from rfm.geometry.shape import Shape
    from solvers.grid import Grid, Integers

INNER, CUT, OUTER = 1, 0, -1
BLOCK = 8
HALVINGS = 3
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
    """

    grid: Grid
    state: Signs
    touching: Mask
    signs: Signs
    active: Mask

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
    open_numbers, open_signs = [], []
    for cells in _candidates(logic, grid, flat):
        signs = _interval_signs(logic, grid, cells, np.ones_like(cells))
        value = logic.value(signs)
        numbers = _numbers(grid, cells)
        flat[numbers] = value
        left = np.flatnonzero(value == 0)
        if left.size:
            verdict, touches, signs = _decide(logic, grid, cells[left], signs[left])
            flat[numbers[left]] = verdict
            flat_touching[numbers[left]] = touches
            open_numbers.append(numbers[left])
            open_signs.append(signs)
    if not (state >= 0).any():
        raise GeometryError(
            "the domain is empty or lies outside the grid: check the Boolean expression, and the box if one is given"
        )
    signs = _gather(logic, flat, flat_touching, open_numbers, open_signs)
    return Classification(grid, state, touching, signs, logic.relevant(signs))


def _gather(logic: Logic, state: Signs, touching: Mask, numbers: list[Integers], signs: list[Signs]) -> Signs:
    """Signs of the cut cells, then of the touching ones, each in the order of their numbers."""
    if not numbers:
        return np.zeros((0, len(logic.surfaces)), dtype=np.int8)
    where, all_signs = np.concatenate(numbers), np.concatenate(signs)
    order = np.argsort(where, kind="stable")
    where, all_signs = where[order], all_signs[order]
    return np.concatenate([all_signs[state[where] == CUT], all_signs[touching[where]]])


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


def _decide(logic: Logic, grid: Grid, cells: Integers, signs: Signs) -> tuple[Signs, Mask, Signs]:
    """Decide cells that intervals leave open; also says which touch and returns refined signs."""
    verdict = np.zeros(len(cells), dtype=np.int8)
    touches = np.zeros(len(cells), dtype=bool)
    active = logic.relevant(signs)
    rest = np.flatnonzero(~_cut_by_corners(logic, grid, cells, signs, active))
    if not rest.size:
        return verdict, touches, signs
    signs = signs.copy()
    undecided = rest
    for boxes in initial_boxes(logic, grid, cells, signs, active, rest):
        strict = strict_signs(boxes)
        signs[boxes.row] = strict
        value = logic.value(boxes.all_signs)
        verdict[boxes.row] = value
        # Inside, though strictly speaking undecided: some surface lies on a face.
        touches[boxes.row] = (value > 0) & (logic.value(strict) == 0)
    undecided = rest[verdict[rest] == 0]
    if undecided.size:
        verdict[undecided] = _by_subdivision(logic, grid, cells, signs, undecided)
    return verdict, touches, signs


def _cut_by_corners(logic: Logic, grid: Grid, cells: Integers, signs: Signs, active: Mask) -> Mask:
    """Whether cells have a corner well inside and one well outside."""
    corners = 2**grid.dimension
    trial = np.repeat(signs, corners, axis=0)
    for i, surface in enumerate(logic.surfaces):
        rows = np.flatnonzero(active[:, i])
        if not rows.size:
            continue
        values = values_at(surface, corner_points(grid, cells[rows]))
        noise = 1e-10 * np.abs(values).max(axis=1, keepdims=True)
        at = (rows[:, None] * corners + np.arange(corners)).ravel()
        trial[at, i] = (np.where(values > noise, 1, 0) - np.where(values < -noise, 1, 0)).ravel()
    value = logic.value(trial).reshape(len(cells), corners)
    return np.asarray((value > 0).any(axis=1) & (value < 0).any(axis=1))


def _by_subdivision(logic: Logic, grid: Grid, cells: Integers, signs: Signs, rows: Integers) -> Signs:
    """Verdict on rows of cells by bounds on smaller and smaller boxes."""
    inside = np.zeros(len(cells), dtype=bool)
    outside = np.zeros(len(cells), dtype=bool)
    pending = list(initial_boxes(logic, grid, cells, signs, logic.relevant(signs), rows))
    for _ in range(HALVINGS):
        following = []
        for boxes in pending:
            halves = children(boxes, range(grid.dimension))
            value = logic.value(halves.all_signs)
            inside[halves.row[value > 0]] = True
            outside[halves.row[value < 0]] = True
            following.append(halves.take(np.flatnonzero(value == 0)))
        # A cell that is known to be cut needs no further look.
        pending = [b.take(np.flatnonzero(~(inside & outside)[b.row])) for b in following]
        pending = [b for b in pending if len(b)]
    unknown = np.zeros(len(cells), dtype=bool)
    for boxes in pending:
        unknown[boxes.row] = True
    verdict = np.where(
        inside & ~outside & ~unknown, INNER, np.where(outside & ~inside & ~unknown, OUTER, CUT)
    )
    return np.asarray(verdict[rows], dtype=np.int8)
