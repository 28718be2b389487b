"""Which key of a case is to blame for an error of the solver, which knows nothing of files."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rfm.app.case import Case
from rfm.app.expressions import Expression
from rfm.app.schema.conditions import leaves
from rfm.app.yaml_reader import Path
from rfm.errors import CaseError, DataError, DiscretizationError, GeometryError, RfmError, StructureError


def located(case: Case, error: RfmError) -> RfmError:
    """Return the error with its place in the case; the error itself where it has none."""
    if isinstance(error, CaseError):
        return error
    if isinstance(error, DataError):
        return _data_error(case, error)
    if isinstance(error, GeometryError):
        return case.error(("geometry", "domain"), str(error))
    if isinstance(error, DiscretizationError):
        name, _, rest = str(error).partition(" ")
        if rest.startswith("must") and getattr(case.discretization, name, None) is not None:
            return case.error(("discretization", name), rest)
        key = "grid" if case.discretization.spacing is None else "spacing"
        return case.error(("discretization", key), str(error))
    if isinstance(error, StructureError):
        return case.error(("boundary_conditions",), str(error), key=True)
    return error


def _data_error(case: Case, error: DataError) -> RfmError:
    """Place a datum without a finite value at its expression, or at the one that spoils it."""
    path = getattr(error.field, "path", None)
    if path:
        return case.error(path, str(error))
    for name, where, expression in _data(case):
        field = expression.field(case.dimension, where)
        value = float(np.asarray(field(*error.point)))
        if not np.isfinite(value):
            return case.error(where, str(DataError(name, field, error.point, value)))
    return error


def _data(case: Case) -> Iterator[tuple[str, Path, Expression]]:
    """Every expression of the problem: what it is, where it stands."""
    for path, value in leaves(("equation", case.equation.name), case.equation.data):
        if isinstance(value, Expression):
            yield str(path[2]), path, value
    for i, condition in enumerate(case.boundary_conditions):
        for below, value in condition.data():
            if isinstance(value, Expression):
                name = " ".join(part for part in below if isinstance(part, str))
                yield name if len(below) > 1 else f"{name} value", ("boundary_conditions", i, *below), value
    for path, value in leaves(("exact",), case.exact):
        if isinstance(value, Expression):
            yield "exact solution", path, value
