r"""The extension of WEB-splines and its transpose as gathers: nothing is scattered.

``full = E^T c`` reads every coefficient of the grid from the list (unknowns, dependent coefficients, zero).
``E f`` adds to each unknown what the dependent coefficients that follow from it carry: rows of a sparse matrix are
sorted into classes by their number of entries, up to a power of two, so that rows of one class have one length.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.device.halo import Local

Arrays = dict[str, Any]
Sizes = Mapping[int, int]
"""Rows of each length."""


def extension_arrays(local: Local, place: NDArray[np.int32], count: int, outer: int, sizes: Sizes) -> Arrays:
    """Index and weight arrays of E for a box of coefficients.

    Parameters
    ----------
    local
        Its part of the extension.
    place
        Place of each unknown in the list of those of the box.
    count, outer, sizes
        Length of that list, number of dependent coefficients and of rows of each length, as large as in any box.
    """
    position = np.full(local.size, count + outer, dtype=np.int32)
    places = place[local.unknowns]
    position[local.free] = places
    position[local.outer] = np.arange(count, count + len(local.outer), dtype=np.int32)
    dofs = np.full(count, local.size, dtype=np.int32)  # beyond the coefficients: reads zero
    dofs[places] = local.free
    spare = outer - len(local.outer)
    sources = place[local.sources]
    rows, columns, entries = attached(local, place)
    return {
        "position": position,
        "dofs": dofs,
        "sources": np.pad(sources, ((0, spare), (0, 0))),
        "coefficients": np.pad(local.coefficients, ((0, spare), (0, 0))),
        "rows": by_length(rows, columns, entries, count, sizes),
    }


def attached(local: Local, place: NDArray[np.int32]) -> tuple[Any, Any, Array]:
    """Rows, columns and entries of E off its unit part: places of unknowns, flat indices of dependent coefficients."""
    used = local.coefficients.ravel() != 0
    rows = place[local.sources].ravel()[used]
    columns = np.repeat(local.outer, local.sources.shape[1])[used]
    return rows, columns, local.coefficients.ravel()[used]


def lengths(rows: NDArray[np.integer[Any]], count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Entries of each row, and these up to a power of two."""
    found = np.bincount(rows, minlength=count)
    return found, 2 ** np.ceil(np.log2(np.maximum(found, 1))).astype(np.intp)


def sizes_of(rows: NDArray[np.integer[Any]]) -> dict[int, int]:
    """Number of rows of each length up to a power of two."""
    found, widths = lengths(rows, 0)
    width, times = np.unique(widths[found > 0], return_counts=True)
    return dict(zip(width.tolist(), times.tolist(), strict=True))


def by_length(
    rows: NDArray[np.integer[Any]],
    columns: NDArray[np.integer[Any]],
    entries: Array,
    count: int,
    sizes: Sizes,
) -> Arrays:
    """Sparse rows in classes of equal length padded to `sizes`, and the place of each row in them (last: no row)."""
    order = np.argsort(rows, kind="stable")
    rows, columns, entries = rows[order], columns[order], entries[order]
    found, widths = lengths(rows, count)
    starts = np.concatenate([[0], np.cumsum(found)])[:-1]
    where = np.full(count, sum(sizes.values()), dtype=np.int32)
    classes, done = [], 0
    for width, size in sorted(sizes.items()):
        members = np.flatnonzero((widths == width) & (found > 0))
        column = np.arange(width)
        valid = column < found[members, None]
        at = np.where(valid, starts[members, None] + column, 0)
        spare = ((0, size - len(members)), (0, 0))
        classes.append(
            {
                "columns": np.pad(columns[at].astype(np.int32), spare),
                "entries": np.pad(np.where(valid, entries[at], 0.0), spare),
            }
        )
        where[members] = done + np.arange(len(members), dtype=np.int32)
        done += size
    return {"classes": classes, "where": where}


def collected(rows: Arrays, values: Any) -> Any:
    """Product (M, n) of sparse rows of :func:`by_length` with vectors (M, m)."""
    import jax.numpy as jnp

    carried = [(one["entries"] * values[:, one["columns"]]).sum(axis=-1) for one in rows["classes"]]
    return jnp.concatenate([*carried, jnp.zeros((len(values), 1))], axis=1)[:, rows["where"]]


def extended(arrays: Arrays, unknowns: Any) -> Any:
    """All coefficients (M, size) from the unknowns (M, n)."""
    import jax.numpy as jnp

    outer = (arrays["coefficients"] * unknowns[:, arrays["sources"]]).sum(axis=-1)
    listed = jnp.concatenate([unknowns, outer, jnp.zeros((len(unknowns), 1))], axis=1)
    return listed[:, arrays["position"]]


def restricted(arrays: Arrays, full: Any) -> Any:
    """Sums (M, n) for the unknowns of numbers (M, size) of all coefficients: the transpose of :func:`extended`."""
    import jax.numpy as jnp

    direct = jnp.take(full, arrays["dofs"], axis=1, mode="fill", fill_value=0.0)
    return direct + collected(arrays["rows"], full)
