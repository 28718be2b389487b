"""Cells with their coefficients, sorted into groups of one shape each and padded to chunks.

A *group* has tensor nodes common to its cells, or lists of points of one length, and the same nonzero coefficients
everywhere.  A chunk of a group is what is computed at a time: its size bounds the memory, and the shapes are fixed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.device.blocks import Blocks
from solvers.device.contraction import LOCAL
from solvers.device.team import Team
from solvers.equations.density import Column
from solvers.point_tables import order_of
from solvers.splines import tables
from solvers.web import SplineSpace

Key = tuple[Column, Column]
Part = tuple[NDArray[np.intp], Array, Array]
WORK = {"cpu": 2**18, "gpu": 2**24}
"""Numbers at the nodes of a chunk: they fit the cache of a processor, or keep a GPU busy."""


@dataclass(frozen=True)
class GroupPlan:
    """What is the same for all cells of a group.

    Attributes
    ----------
    keys
        The coefficients: pairs of columns (component, number of the derivative).
    order
        Highest derivative along one direction.
    nodes
        The shared nodes (q,) of one direction; None where each cell has points of its own.
    count
        Nodes of a direction, or points of a cell.
    """

    keys: tuple[Key, ...]
    order: int
    nodes: tuple[float, ...] | None
    count: int


class Groups:
    """Cells by group as they come, and the diagonal of the matrix of all B-splines.

    Parameters
    ----------
    space
        Space of every spline.
    components
        Number of splines.
    blocks
        Boxes of cells, one for each device.
    """

    def __init__(self, space: SplineSpace, components: int, blocks: Blocks) -> None:
        self.space, self.components, self.blocks = space, components, blocks
        self.moduli = 0.0
        """Sum of the moduli of the coefficients."""
        self._parts: dict[GroupPlan, list[Part]] = {}
        self._squares = np.zeros((components, int(np.prod(space.shape))))

    def add(self, cells: NDArray[np.integer[Any]], nodes: Array, blocks: Mapping[Key, Array]) -> None:
        """Add cells (n, d), nodes (q,) or (n, q, d), and coefficients (n, nodes)."""
        keys, dimension = tuple(sorted(blocks)), self.space.grid.dimension
        order = order_of([(first[1], second[1]) for first, second in keys], dimension)
        stacked = np.stack([blocks[key] for key in keys])
        if nodes.ndim == 1:
            plan = GroupPlan(keys, order, tuple(nodes.tolist()), len(nodes))
        else:
            count = 1 << (nodes.shape[1] - 1).bit_length()
            extra = count - nodes.shape[1]
            nodes = np.pad(nodes, ((0, 0), (0, extra), (0, 0)), constant_values=0.5)
            stacked = np.pad(stacked, ((0, 0), (0, 0), (0, extra)))
            plan = GroupPlan(keys, order, None, count)
        flat = np.ravel_multi_index(tuple(np.asarray(cells).T), self.space.shape)
        self.moduli += float(np.abs(stacked).sum())
        self._add_squares(plan, flat, nodes, stacked)
        self._parts.setdefault(plan, []).append((flat, nodes, stacked))

    def diagonal(self, team: Team) -> Array:
        """Diagonal of ``E D E^T``, D the diagonal of the B-splines' matrix: shape (components * unknowns,)."""
        carried = self.space.extension.power(2) @ np.abs(team.total(self._squares)).T
        return np.asarray(carried.T.ravel())

    def boxes(self, numbers: Sequence[int]) -> list[dict[GroupPlan, Part]]:
        """Cells, nodes and coefficients of each group in some boxes; given up on the way.

        Cells are known by the flat index of their first coefficient in the box.
        """
        found: list[dict[GroupPlan, Part]] = [{} for _ in numbers]
        shape = tuple(n + self.space.degree for n in self.blocks.thickness)
        for plan in list(self._parts):
            parts = self._parts.pop(plan)
            cells = np.concatenate([part[0] for part in parts])
            nodes = parts[0][1] if plan.nodes is not None else np.concatenate([part[1] for part in parts])
            stacked = np.concatenate([part[2] for part in parts], axis=1)
            holders = self._holders(cells)
            for box, number in zip(found, numbers, strict=True):
                rows = np.flatnonzero(holders == number)
                lower = np.array([low for low, _ in self.blocks.box(number)])
                index = np.stack(np.unravel_index(cells[rows], self.space.shape)) - lower[:, None]
                own = nodes if plan.nodes is not None else nodes[rows]
                box[plan] = np.ravel_multi_index(tuple(index), shape), own, stacked[:, rows]
        return found

    def arrays(self, plan: GroupPlan, part: Part | None, most: int, kind: str) -> dict[str, Any]:
        """Arrays of the cells of a box in a group, in chunks for a kind of device, as many as of `most` cells."""
        cells, nodes, coefficients = part or self._nothing(plan)
        columns = len({column for key in plan.keys for column in key})
        size = chunk_size(most, columns * coefficients.shape[2], kind)
        count = -(-most // size)
        blocks = chunked(coefficients.transpose(1, 0, 2), size, count)
        chunks = {
            "base": chunked(cells.astype(np.int32), size, count),
            "coefficients": np.ascontiguousarray(blocks.transpose(0, 2, 3, 1)),
        }
        if plan.nodes is not None:
            return {"chunks": chunks, "lines": self._lines(np.array(plan.nodes), plan.order)}
        for axis, line in enumerate(self._lines(nodes, plan.order)):
            pieces = chunked(line.transpose(1, 0, 2, 3), size, count)
            chunks[f"lines{axis}"] = np.ascontiguousarray(pieces.transpose(0, 2, 3, 4, 1))
        return {"chunks": chunks, "lines": ()}

    def _holders(self, cells: NDArray[np.intp]) -> NDArray[np.int32]:
        return self.blocks.holders(np.stack(np.unravel_index(cells, self.space.shape)))

    def _nothing(self, plan: GroupPlan) -> Part:
        """No cells of a group."""
        dimension = self.space.grid.dimension
        count = plan.count**dimension if plan.nodes is not None else plan.count
        return (
            np.zeros(0, dtype=np.intp),
            np.zeros((0, plan.count, dimension)),
            np.zeros((len(plan.keys), 0, count)),
        )

    def _lines(self, nodes: Array, order: int) -> tuple[Array, ...]:
        """Derivatives along each direction: (R, q, p+1) at common nodes, (R, n, q, p+1) at points."""
        found = tables(self.space.degree, nodes, order)
        spacing = self.space.grid.spacing
        shared = nodes.ndim == 1
        lines = [found if shared else found[:, :, :, axis] for axis in range(len(spacing))]
        powers = np.arange(order + 1).reshape(-1, *[1] * (lines[0].ndim - 1))
        return tuple(line / float(h) ** powers for line, h in zip(lines, spacing, strict=True))

    def _add_squares(self, plan: GroupPlan, flat: NDArray[np.intp], nodes: Array, stacked: Array) -> None:
        """Add the energies of single B-splines."""
        degree, dimension = self.space.degree, self.space.grid.dimension
        derivatives = multi_indices(dimension, plan.order)
        lines = self._lines(nodes, plan.order)
        local = np.indices((degree + 1,) * dimension).reshape(dimension, -1)
        where = (flat[:, None] + np.ravel_multi_index(tuple(local), self.space.shape)).ravel()
        for ((m, alpha), (other, beta)), values in zip(plan.keys, stacked, strict=True):
            if m != other:
                continue
            pairs = zip(lines, derivatives[alpha], derivatives[beta], strict=True)
            squares = [line[r] * line[s] for line, r, s in pairs]
            if plan.nodes is not None:
                energies = values.reshape(-1, *[plan.count] * dimension)
                for square in squares:
                    energies = np.tensordot(energies, square, axes=(1, 0))
            else:
                spell = ",".join(f"nq{letter}" for letter in LOCAL[:dimension])
                energies = np.einsum(f"nq,{spell}->n{LOCAL[:dimension]}", values, *squares, optimize=True)
            times = 1.0 if alpha == beta else 2.0
            self._squares[m] += times * np.bincount(where, energies.ravel(), self._squares.shape[1])


def chunk_size(cells: int, numbers: int, kind: str) -> int:
    """Cells of a chunk: a power of two (16 at least) within the bound of the device, no more than there are."""
    bound = max(16, WORK.get(kind, WORK["gpu"]) // numbers)
    return int(2 ** min(bound.bit_length() - 1, max(4, (cells - 1).bit_length())))


def chunked(array: Array, size: int, count: int) -> Array:
    """Rows padded with zeros and cut into chunks (count, size, ...)."""
    rows = count * size - len(array)
    padded = np.pad(array, [(0, rows), *[(0, 0)] * (array.ndim - 1)])
    return padded.reshape(-1, size, *array.shape[1:])
