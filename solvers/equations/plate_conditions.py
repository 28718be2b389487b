"""The essential part of the conditions of a plate: deflection and slope."""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Array
from solvers.data import values
from solvers.equations.rows import Equality, Row, Scalar, apply
from solvers.exact import Exact, exact_jet, required
from solvers.problem import Clamped, Condition, Datum, FromExact, SimplySupported

Asked = tuple[str, Row, Datum | FromExact]
"""Name of a datum, the row that takes it, and the datum."""


def essential(condition: Condition, normals: Array) -> list[Asked]:
    """Deflection and slope that a condition prescribes, rows in a jet of order 1 or more."""
    deflection: Row = {0: 1.0}
    match condition:
        case Clamped(value=value, slope=slope):
            return [
                ("value", deflection, value),
                ("slope", {1 + i: normals[..., i] for i in range(2)}, slope),
            ]
        case SimplySupported(value=value):
            return [("value", deflection, value)]
    return []


def resolved(asked: Asked, coords: Sequence[Array], exact: Exact | None, order: int) -> Equality:
    """The row and its value at the points; that of the exact solution in its jet of the given order."""
    name, row, datum = asked
    right: Scalar
    if isinstance(datum, FromExact):
        right = apply(row, exact_jet(required(exact), coords, order))
    else:
        right = values(name, datum, coords)
    return row, right


def essential_rows(
    condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
) -> list[Equality]:
    """Rows of the essential part of a condition."""
    return [resolved(asked, coords, exact, 1) for asked in essential(condition, normals)]
