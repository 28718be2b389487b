"""Cells with their coefficients, sorted into groups of one shape each and padded to chunks.

A *group* has tensor nodes common to its cells, or lists of points of one length, and the same nonzero coefficients
everywhere.  A chunk of a group is what is computed at a time: its size bounds the memory, and the shapes are fixed.
"""

from __future__ import annotations

from collections.abc import Mapping
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


@dataclass(frozen=True)
class Part:
    """Some cells of a group: their boxes, first coefficients in them, nodes, and coefficients (keys, n, nodes)."""

    holder: NDArray[np.int32]
    base: NDArray[np.int32]
    nodes: Array
    coefficients: Array


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
        self._lower = np.array([blocks.box(k) for k in range(blocks.count)])[..., 0].T
        self._shape = tuple(n + space.degree for n in blocks.thickness)
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
        index = np.asarray(cells).T
        flat = np.ravel_multi_index(tuple(index), self.space.shape)
        self.moduli += float(np.abs(stacked).sum())
        self._add_squares(plan, flat, nodes, stacked)
        holder = self.blocks.holders(index)
        base = np.ravel_multi_index(tuple(index - self._lower[:, holder]), self._shape).astype(np.int32)
        self._parts.setdefault(plan, []).append(Part(holder, base, nodes, stacked))

    def diagonal(self, team: Team) -> Array:
        """Diagonal of ``E D E^T``, D the diagonal of the B-splines' matrix: shape (components * unknowns,)."""
        carried = self.space.extension.power(2) @ np.abs(team.total(self._squares)).T
        return np.asarray(carried.T.ravel())

    def cells(self, number: int) -> dict[GroupPlan, NDArray[np.int32]]:
        """Cells of each group in a box, by the flat index of their first coefficient in the box."""
        return {
            plan: np.concatenate([part.base[part.holder == number] for part in parts])
            for plan, parts in self._parts.items()
        }

    def arrays(self, plan: GroupPlan, number: int, most: int, kind: str) -> dict[str, Any]:
        """Arrays of the cells of a group in a box, in chunks for a kind of device, as many as of `most` cells."""
        dimension, keys = self.space.grid.dimension, len(plan.keys)
        nodes = plan.count**dimension if plan.nodes is not None else plan.count
        size = chunk_size(most, len({column for key in plan.keys for column in key}) * nodes, kind)
        count, width = -(-most // size), (plan.order + 1, plan.count, self.space.degree + 1)
        chunks = {
            "base": np.zeros((count, size), dtype=np.int32),
            "coefficients": np.zeros((count, keys, nodes, size)),
        }
        if plan.nodes is None:
            chunks.update({f"lines{axis}": np.zeros((count, *width, size)) for axis in range(dimension)})
        start = 0
        for part in self._parts.get(
            plan, ()
        ):  # each is copied to its place, so that nothing else is held twice
            rows = np.flatnonzero(part.holder == number)
            chunk, at = np.divmod(np.arange(start, start + len(rows)), size)
            chunks["base"][chunk, at] = part.base[rows]
            chunks["coefficients"][chunk, :, :, at] = part.coefficients[:, rows].transpose(1, 0, 2)
            if plan.nodes is None:
                for axis, line in enumerate(self._lines(part.nodes[rows], plan.order)):
                    chunks[f"lines{axis}"][chunk, :, :, :, at] = line.transpose(1, 0, 2, 3)
            start += len(rows)
        lines = () if plan.nodes is None else self._lines(np.array(plan.nodes), plan.order)
        return {"chunks": chunks, "lines": lines, "used": np.array(-(-start // size), dtype=np.int32)}

    def drop(self, plan: GroupPlan) -> None:
        """Give up the cells of a group."""
        self._parts.pop(plan, None)

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
    """Cells of a chunk: chunks of one size within the bound of the device, in eights, with little room left over."""
    count = -(-cells // max(16, WORK.get(kind, WORK["gpu"]) // numbers))
    return -(-cells // (8 * count)) * 8
