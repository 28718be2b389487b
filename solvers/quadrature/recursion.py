"""Recursion from cells to boxes in which the surfaces are graphs.

A box whose surfaces are graphs over a common base is integrated; any other is halved.  Surfaces that cannot matter in
a box are forgotten there, and boxes that lie inside as a whole get a tensor Gauss rule.  At the greatest depth a box
is integrated by the Gauss points that lie inside, and its volume is reported as unresolved.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import permutations, product
from typing import TYPE_CHECKING

import numpy as np

from rfm.geometry.logic import Logic, Mask, Signs
from solvers.quadrature import bernstein
from solvers.quadrature.boxes import Boxes, children, merged, strict_signs
from solvers.quadrature.directions import Choice, choose
from solvers.quadrature.lines import Lines
from solvers.quadrature.pieces import gauss
from solvers.quadrature.surface import boundary_points
from solvers.quadrature.tensor import tensor_weights
from solvers.quadrature.volume import Graphs, volume_lines

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from solvers.grid import Integers

DEPTH = {2: 20, 3: 7}
"""Halvings of a cell before a box is given up."""

MOST_SLOTS = 5
"""Boxes with more surfaces are halved first."""

MOST_BOXES = 4000
"""Boxes (or eight for each box at the start, if that is more) above which halving ends: memory is bounded."""

POINTS_AT_ONCE = 1_000_000


@dataclass(frozen=True, eq=False)
class VolumePart:
    """Rows of cells and lines in them, weights in units of the cell; unresolved volume."""

    row: Integers
    lines: Lines
    unresolved: float = 0.0


@dataclass(frozen=True, eq=False)
class BoundaryPart:
    """Flat boundary rule over the bases.

    Attributes
    ----------
    row, nodes
        Cell rows ``(N,)`` and unit coordinates ``(N, d)``.
    weights
        Measure of the base per point, in units of the cell's extent across ``axis``.
    axis
        Height direction, shape ``(N,)``.
    inner_sign
        Sign of the surface's function on the side of the domain, shape ``(N,)``.
    surface
        Number of the surface, shape ``(N,)``.
    """

    row: Integers
    nodes: Array
    weights: Array
    axis: Integers
    inner_sign: Array
    surface: Integers


def volume_rule(logic: Logic, boxes: Iterable[Boxes], order: int) -> Iterator[VolumePart]:
    """Integrate over the domain in some boxes, ``order`` points on each piece of a line."""
    pending = merged(boxes)
    limit = _limit(pending)
    while pending:
        open_boxes: list[Boxes] = []
        for group in pending:
            signs = group.all_signs
            value = logic.value(signs)
            full = np.flatnonzero(value > 0)
            if full.size:
                yield _whole(group, full, order)
            rows = np.flatnonzero(value == 0)
            open_boxes.extend(_grouped(logic, group, rows, signs[rows], 0))
        following: list[Boxes] = []
        crowded = sum(map(len, open_boxes)) > limit
        for piece in _chunks(merged(open_boxes), order):
            choice = _choose(piece, piece.slots.shape[1])
            last = (piece.depth >= DEPTH[piece.dimension]) | crowded
            forced = ~choice.valid & choice.height & last
            good = np.flatnonzero(choice.valid | forced)
            if good.size:
                yield _integrate(logic, piece, choice, good, forced, order)
            lost = np.flatnonzero(~choice.valid & ~choice.height & last)
            if lost.size:
                yield _fallback(logic, piece.take(lost), order)
            following.extend(_halved(piece, choice, np.flatnonzero(~choice.valid & ~last)))
        pending = merged(following)


def boundary_rule(logic: Logic, boxes: Iterable[Boxes], order: int) -> Iterator[BoundaryPart]:
    """Integrate over the boundary of the domain in some boxes, ``order`` points on each piece of a base line."""
    pending = merged(target for group in boxes for target in _targets(logic, group))
    limit = _limit(pending)
    while pending:
        open_boxes: list[Boxes] = []
        for group in pending:
            signs = strict_signs(group)
            rows = np.flatnonzero(logic.relevant(signs)[np.arange(len(group)), group.slots[:, 0]])
            open_boxes.extend(_grouped(logic, group, rows, signs[rows], 1))
        following: list[Boxes] = []
        crowded = sum(map(len, open_boxes)) > limit
        for piece in _chunks(merged(open_boxes), order):
            choice = _choose(piece, 1)
            last = (piece.depth >= DEPTH[piece.dimension]) | crowded
            # At the end the best direction has to do.
            good = np.flatnonzero(choice.valid | (last & (piece.slots.shape[1] <= MOST_SLOTS)))
            if good.size:
                yield _integrate_boundary(logic, piece, choice, good, order)
            following.extend(_halved(piece, choice, np.flatnonzero(~choice.valid & ~last)))
        pending = merged(following)


def _limit(boxes: list[Boxes]) -> int:
    return max(MOST_BOXES, 8 * sum(map(len, boxes)))


def _targets(logic: Logic, group: Boxes) -> Iterator[Boxes]:
    """One group for each slot, with that slot first; auxiliary surfaces bear no boundary."""
    m = group.slots.shape[1]
    bears = np.array([not surface.auxiliary for surface in logic.surfaces])
    for a in range(m):
        rows = np.flatnonzero(bears[group.slots[:, a]])
        order = np.array([a, *(b for b in range(m) if b != a)])
        if rows.size:
            yield group.choose(rows, np.broadcast_to(order, (rows.size, m)), group.signs[rows])


def _grouped(logic: Logic, group: Boxes, rows: Integers, signs: Signs, fixed: int) -> Iterator[Boxes]:
    """Split boxes by the number of slots that matter and drop the others; the first ``fixed`` slots stay first."""
    if not rows.size:
        return
    live = np.take_along_axis(logic.relevant(signs), group.slots[rows], axis=1)
    live[:, :fixed] = True
    count = live.sum(axis=1)
    order = np.argsort(~live, axis=1, kind="stable")
    for m in np.flatnonzero(np.bincount(count)):
        chosen = np.flatnonzero(count == m)
        part = group.choose(rows[chosen], order[chosen, :m], signs[chosen])
        np.put_along_axis(part.signs, part.slots, np.int8(0), axis=1)
        yield part


def _chunks(groups: list[Boxes], order: int) -> Iterator[Boxes]:
    for group in groups:
        step = max(1, POINTS_AT_ONCE // (4 * order**group.dimension))
        for start in range(0, len(group), step):
            whole = len(group) <= step
            yield group if whole else group.take(np.arange(start, min(start + step, len(group))))


def _choose(boxes: Boxes, heights: int) -> Choice:
    choice = choose(boxes, heights)
    if boxes.slots.shape[1] > MOST_SLOTS:
        choice.valid[:] = choice.height[:] = False
        choice.base_only[:] = False
    return choice


def _halved(boxes: Boxes, choice: Choice, rows: Integers) -> Iterator[Boxes]:
    """Halve boxes in all directions, or in all but the height direction."""
    d = boxes.dimension
    everywhere = rows[~choice.base_only[rows]]
    if everywhere.size:
        yield children(boxes.take(everywhere), range(d))
    for k in range(d):
        chosen = rows[choice.base_only[rows] & (choice.axes[rows, 0] == k)]
        if chosen.size:
            yield children(boxes.take(chosen), [axis for axis in range(d) if axis != k])


def _graphs(logic: Logic, boxes: Boxes, choice: Choice, rows: Integers) -> Graphs:
    """Coefficients with axes in the chosen order."""
    d = boxes.dimension
    c = boxes.c[rows]
    axes = choice.axes[rows]
    for order in list(permutations(range(d)))[1:]:
        same = np.flatnonzero((axes == order).all(axis=1))
        if same.size:
            c[same] = c[same].transpose(0, 1, *(2 + axis for axis in order))
    table = logic.table(boxes.signs[rows], boxes.slots[rows])
    return Graphs(c, boxes.noise[rows], choice.upright[rows], table)


def _unit(boxes: Boxes, rows: Integers, axes: Integers, at: Array) -> Array:
    """Unit coordinates of the cell from coordinates of boxes in the chosen order of axes."""
    nodes = np.empty_like(at)
    np.put_along_axis(nodes, axes, at, axis=1)
    return np.asarray(boxes.lower[rows] + boxes.width[rows] * nodes)


def _integrate(
    logic: Logic, boxes: Boxes, choice: Choice, rows: Integers, forced: Mask, order: int
) -> VolumePart:
    segments = volume_lines(_graphs(logic, boxes, choice, rows), order)
    owner = rows[segments.owner]
    volume, axis = boxes.width.prod(axis=1), choice.axes[:, 0].astype(np.int8)
    across = boxes.width[np.arange(len(boxes)), axis]
    start = np.empty((len(owner), boxes.dimension))
    for column, at in enumerate((segments.start, *segments.base)):
        # box by box first: there are many lines in each
        k = choice.axes[:, column]
        low, width = (
            np.take_along_axis(side, k[:, None], axis=1)[:, 0] for side in (boxes.lower, boxes.width)
        )
        start[np.arange(len(owner)), k[owner]] = low[owner] + width[owner] * at
    lines = Lines(start, axis[owner], segments.length * across[owner], segments.weight * volume[owner])
    return VolumePart(boxes.row[owner], lines, float(volume[forced].sum()))


def _integrate_boundary(
    logic: Logic, boxes: Boxes, choice: Choice, rows: Integers, order: int
) -> BoundaryPart:
    graphs = _graphs(logic, boxes, choice, rows)
    preceding = boxes.slots[rows] < boxes.slots[rows, :1]
    preceding &= np.array([not surface.auxiliary for surface in logic.surfaces])[boxes.slots[rows]]
    points = boundary_points(graphs, preceding, order)
    owner = rows[points.owner]
    axis = choice.axes[owner, 0]
    weights = points.weight * boxes.width.prod(axis=1)[owner] / boxes.width[owner, axis]
    nodes = _unit(boxes, owner, choice.axes[owner], points.at)
    return BoundaryPart(boxes.row[owner], nodes, weights, axis, points.inner_sign, boxes.slots[owner, 0])


def _whole(boxes: Boxes, rows: Integers, order: int) -> VolumePart:
    """Tensor Gauss rule on whole boxes: lines in the last direction."""
    t, w = gauss(order)
    d = boxes.dimension
    tensor = np.asarray(list(product(*[t] * (d - 1), [0.0])))
    width = boxes.width[rows]
    start = boxes.lower[rows, None, :] + width[:, None, :] * tensor
    weight = width.prod(axis=1)[:, None] * tensor_weights(w, d - 1)
    each = len(tensor)
    axis = np.full(len(rows) * each, d - 1, dtype=np.int8)
    lines = Lines(start.reshape(-1, d), axis, np.repeat(width[:, -1], each), weight.ravel())
    return VolumePart(np.repeat(boxes.row[rows], each), lines)


def _fallback(logic: Logic, boxes: Boxes, order: int) -> VolumePart:
    """Gauss points of the boxes that lie inside, as lines without length; the volume of the boxes is unresolved."""
    d = boxes.dimension
    t, w = gauss(order)
    values = boxes.c
    matrix = bernstein.basis(boxes.degree, t)
    for axis in range(-d, 0):
        values = bernstein.transform(matrix, values, axis)
    n, m = boxes.slots.shape
    positive = values.reshape(n, m, -1) > 0
    each = positive.shape[2]
    signs = np.repeat(boxes.signs, each, axis=0)
    slots = np.repeat(boxes.slots, each, axis=0)
    slot_signs = np.where(positive, 1, -1).astype(np.int8).transpose(0, 2, 1).reshape(-1, m)
    np.put_along_axis(signs, slots, slot_signs, axis=1)
    inside = np.flatnonzero(logic.value(signs) > 0)
    nodes = boxes.lower[:, None, :] + boxes.width[:, None, :] * np.asarray(list(product(t, repeat=d)))
    volume = boxes.width.prod(axis=1)
    points = Lines(
        nodes.reshape(-1, d),
        np.zeros(n * each, dtype=np.int8),
        np.zeros(n * each),
        np.multiply.outer(volume, tensor_weights(w, d)).ravel(),
    )
    return VolumePart(np.repeat(boxes.row, each)[inside], points.take(inside), float(volume.sum()))
