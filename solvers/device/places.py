"""Sums over the cells around a coefficient as gathers: where the products of each cell are, and their collection."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.device.plan import Plan

Arrays = dict[str, Any]


def repeats(cells: NDArray[np.integer[Any]]) -> tuple[int, int]:
    """How often the most frequent cell occurs, and how many occur more than once."""
    times = np.unique(cells, return_counts=True)[1]
    return int(times.max(initial=1)), int((times > 1).sum())


@dataclass(frozen=True)
class Occupied:
    """Cells of a group in chunks, and which of them are no padding, both (chunks, n)."""

    base: NDArray[np.int32]
    real: NDArray[np.bool_]

    @staticmethod
    def of(chunks: Arrays) -> Occupied:
        """The cells of a group's arrays."""
        return Occupied(chunks["base"], np.any(chunks["coefficients"] != 0, axis=(1, 2)))


def places(plan: Plan, groups: Sequence[Occupied], several: tuple[int, int]) -> Arrays:
    """Where the products of each cell are found in the list of all of them.

    The list is a zero, the groups' arrays (chunks, M, K, n) one after the other, and the sums of the cells that occur
    more than once, as (M, K, n).  ``start`` is the place of component 0, coefficient 0 of a cell, ``stride`` the
    distance to the next coefficient; both on the grid of cells with a margin of p, zero where there is nothing.

    Parameters
    ----------
    plan, groups
        The box, and the cells of each group.
    several
        How often a cell occurs, and how many occur more than once, as many as in any box.
    """
    block, total = plan.components * (plan.degree + 1) ** len(plan.shape), 1
    cells, starts, strides = [], [], []
    for data in groups:
        chunks, size = data.base.shape
        at = np.arange(chunks)[:, None] * (block * size) + np.arange(size) + total
        cells.append(data.base[data.real])
        starts.append(at[data.real])
        strides.append(np.full(int(data.real.sum()), size))
        total += chunks * block * size
    cell, start, stride = (np.concatenate(found) for found in (cells, starts, strides))
    order = np.argsort(cell, kind="stable")
    cell, start, stride = cell[order], start[order], stride[order]
    unique, first, times = np.unique(cell, return_index=True, return_counts=True)
    repeated = times > 1
    column = np.arange(several[0])
    valid = column[:, None] < times[repeated]
    at = np.where(valid, first[repeated] + column[:, None], 0)
    found_start, found_stride = start[first], stride[first]
    found_start[repeated] = total + np.arange(int(repeated.sum()))
    found_stride[repeated] = several[1]
    margin = tuple(n + plan.degree for n in plan.shape)  # cells + 2 p
    where = np.stack(np.unravel_index(unique, plan.shape)) + plan.degree
    kind = np.int32 if total < 2**31 - 2**24 else np.int64
    grids = [np.zeros(margin, dtype=kind) for _ in range(2)]
    for grid, found in zip(grids, (found_start, found_stride), strict=True):
        grid[tuple(where)] = found
    spare = ((0, 0), (0, several[1] - at.shape[1]))
    return {
        "start": grids[0],
        "stride": grids[1],
        "several_start": np.pad(np.where(valid, start[at], 0), spare).astype(kind),
        "several_stride": np.pad(np.where(valid, stride[at], 0), spare).astype(kind),
    }


def gathered(plan: Plan, where: Arrays, sums: list[Any]) -> Any:
    """Sums over the cells around each coefficient: (M, size)."""
    import jax
    import jax.numpy as jnp

    kept = (plan.degree + 1) ** len(plan.shape)
    listed = jnp.concatenate([jnp.zeros(1), *(s.ravel() for s in sums)])
    if where["several_start"].shape[1]:
        number = jnp.arange(plan.components * kept)[:, None]
        start, stride = where["several_start"][:, None], where["several_stride"][:, None]
        again = listed[start + number * stride].sum(axis=0)
        listed = jnp.concatenate([listed, again.ravel()])
    corners = jnp.array([[plan.degree - a for a in index] for index in product(*map(range, plan.local))])

    def add(number: Any, total: Any) -> Any:
        corner = corners[number]
        start, stride = (
            jax.lax.dynamic_slice(where[name], corner, plan.shape).ravel() for name in ("start", "stride")
        )
        parts = [listed[start + (m * kept + number) * stride] for m in range(plan.components)]
        return total + jnp.stack(parts)

    empty = jnp.zeros((plan.components, int(np.prod(plan.shape))))
    return jax.lax.fori_loop(0, kept, add, empty)
