r"""Sparse rows in the jet of the unknown field: :math:`r \cdot v = \sum_\beta r_\beta v_\beta`.

Strong residuals and natural boundary operators are such rows.  The jet v is stacked component after component,
its entry ``component * n_beta + beta`` is :math:`\partial^\beta u_c`, with :math:`\beta` over
:func:`rfm.calculus.jets.multi_indices` of the order that the equation states for the rows.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rfm.calculus.types import Array

Scalar = Array | float
Row = Mapping[int, Scalar]
"""Nonzero entries by position in the jet, arrays over points or numbers."""
Equality = tuple[Row, Scalar]
"""A row r and the value f it is to take: ``r.v = f``."""


def apply(row: Row, jet: Array) -> Array:
    """Values ``r.v`` at the points of a jet v of shape (n_rows, *points)."""
    total: Array = np.zeros(jet.shape[1:])
    for position, entry in row.items():
        total = total + entry * jet[position]
    return total


def added(first: Row, second: Row) -> Row:
    """Sum of two rows."""
    total = dict(first)
    for position, entry in second.items():
        total[position] = total[position] + entry if position in total else entry
    return total


def scaled(factor: Scalar, row: Row) -> Row:
    """Row times a factor."""
    return {position: factor * entry for position, entry in row.items()}
