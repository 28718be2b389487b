r"""The extension of WEB-splines and its transpose as gathers: nothing is scattered.

``full = E^T c`` reads every coefficient of the grid from the list (unknowns, dependent coefficients, zero).
``E f`` adds to each unknown what the dependent coefficients that follow from it carry: unknowns are sorted into
classes by how many these are, up to a power of two, so that rows of one class have one length.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.extension import Extension

Arrays = dict[str, Any]


def extension_arrays(free: Extension, size: int) -> Arrays:
    """Index and weight arrays of E for a coefficient array of `size` numbers."""
    unknowns, outer = len(free.dofs), len(free.outer)
    position = np.full(size, unknowns + outer, dtype=np.int32)
    position[free.dofs] = np.arange(unknowns, dtype=np.int32)
    position[free.outer] = np.arange(unknowns, unknowns + outer, dtype=np.int32)
    width = free.sources.shape[1]
    rows, numbers = free.sources.ravel(), np.repeat(free.outer, width)
    used = free.coefficients.ravel() != 0
    classes, where = by_length(rows[used], numbers[used], free.coefficients.ravel()[used], unknowns)
    return {
        "position": position,
        "dofs": free.dofs.astype(np.int32),
        "sources": free.sources.astype(np.int32),
        "coefficients": free.coefficients,
        "classes": classes,
        "where": where,
    }


def by_length(
    rows: NDArray[np.intp], columns: NDArray[np.intp], entries: Array, count: int
) -> tuple[list[tuple[Any, Any]], NDArray[np.int32]]:
    """Sparse rows in padded classes of equal length, and the place of each row in them (the last one: no row)."""
    order = np.argsort(rows, kind="stable")
    rows, columns, entries = rows[order], columns[order], entries[order]
    lengths = np.bincount(rows, minlength=count)
    starts = np.concatenate([[0], np.cumsum(lengths)])[:-1]
    widths = 2 ** np.ceil(np.log2(np.maximum(lengths, 1))).astype(int)
    where = np.full(count, -1, dtype=np.int32)
    classes, done = [], 0
    for width in np.unique(widths[lengths > 0]):
        members = np.flatnonzero((widths == width) & (lengths > 0))
        column = np.arange(width)
        valid = column < lengths[members, None]
        at = np.where(valid, starts[members, None] + column, 0)
        classes.append((columns[at].astype(np.int32), np.where(valid, entries[at], 0.0)))
        where[members] = done + np.arange(len(members), dtype=np.int32)
        done += len(members)
    where[where < 0] = done
    return classes, where


def extended(arrays: Arrays, unknowns: Any) -> Any:
    """All coefficients (M, size) from the unknowns (M, n)."""
    import jax.numpy as jnp

    outer = (arrays["coefficients"] * unknowns[:, arrays["sources"]]).sum(axis=-1)
    listed = jnp.concatenate([unknowns, outer, jnp.zeros((len(unknowns), 1))], axis=1)
    return listed[:, arrays["position"]]


def restricted(arrays: Arrays, full: Any) -> Any:
    """Sums (M, n) for the unknowns of numbers (M, size) of all coefficients: the transpose of :func:`extended`."""
    import jax.numpy as jnp

    carried = [(entries * full[:, columns]).sum(axis=-1) for columns, entries in arrays["classes"]]
    listed = jnp.concatenate([*carried, jnp.zeros((len(full), 1))], axis=1)
    return full[:, arrays["dofs"]] + listed[:, arrays["where"]]
