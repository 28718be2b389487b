"""Which key of a case is to blame for an error of the solver, which knows nothing of files."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rfm.app.case import Case
from rfm.app.expressions import Expression
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
    equation = case.equation.poisson
    for name in ("source", "conductivity", "reaction"):
        yield from _if_expression(name, ("equation", "poisson", name), getattr(equation, name))
    for i, condition in enumerate(case.boundary_conditions):
        path: Path = ("boundary_conditions", i, condition.kind)
        if condition.robin is not None:
            yield from _if_expression(
                "Robin coefficient", (*path, "coefficient"), condition.robin.coefficient
            )
            yield from _if_expression("Robin value", (*path, "value"), condition.robin.value)
        else:
            yield from _if_expression(f"{condition.kind} value", path, getattr(condition, condition.kind))
    yield from _if_expression("exact solution", ("exact",), case.exact)


def _if_expression(name: str, path: Path, value: object) -> Iterator[tuple[str, Path, Expression]]:
    if isinstance(value, Expression):
        yield name, path, value
