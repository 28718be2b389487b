r"""Element integrals on scattered points: every point has its own tables.

The same forms as in :mod:`solvers.assembly_tensor`, for the fine rules of cut cells and for boundary rules. The
tables of all directions but the last are multiplied out point by point; the last one is a matrix product a cell.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rfm.calculus.types import Array
from solvers.assembly_parity import Form, Key, Kind, Kinds, table
from solvers.splines import tables


def element_entries(form: Form, degree: int, nodes: Array, blocks: Mapping[Key, Array]) -> Array:
    """Elements of a chunk of cells.

    Parameters
    ----------
    form
        What to integrate.
    degree
        Degree p.
    nodes
        Unit coordinates, shape (n, q, d).
    blocks
        Coefficients by key, shape (n, q), weights included.

    Returns
    -------
    ndarray, shape (n, entries)
    """
    phi = tables(degree, nodes, form.order)
    dimension = nodes.shape[2]
    known: dict[tuple[int, Kind], Array] = {}

    def factor(axis: int, kind: Kind) -> Array:
        if (axis, kind) not in known:
            known[axis, kind] = table(phi[:, :, :, axis], kind)
        return known[axis, kind]

    def product(suffix: Kinds, level: int) -> Array:
        """Coefficients times the tables of directions below `level`, shape (n, q, entries so far)."""
        matching = [term for term in form.terms if term[0][level:] == suffix]
        if level == 0:
            total = sum(scale * blocks[key] for key, scale in matching[0][1])
            return np.asarray(total)[:, :, None]
        heads = sorted({kinds[level - 1] for kinds, _ in matching})
        result = multiplied(product((heads[0], *suffix), level - 1), factor(level - 1, heads[0]))
        for head in heads[1:]:
            result += multiplied(product((head, *suffix), level - 1), factor(level - 1, head))
        return result

    def multiplied(left: Array, right: Array) -> Array:
        """Outer products point by point, shape (n, q, entries so far)."""
        joined: Array = (left[:, :, :, None] * right[:, :, None, :]).reshape(*left.shape[:2], -1)
        return joined

    last = sorted({kinds[-1] for kinds, _ in form.terms})
    left = np.concatenate([product((kind,), dimension - 1) for kind in last], axis=1)
    right = np.concatenate([factor(dimension - 1, kind) for kind in last], axis=1)
    elements: Array = np.matmul(left.transpose(0, 2, 1), right).reshape(len(nodes), -1)
    return elements
