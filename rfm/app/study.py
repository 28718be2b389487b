"""A convergence study: one case on several grids and degrees, with the measured rates."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from rfm.app.case import Case
from rfm.errors import CaseError, DiscretizationError

if TYPE_CHECKING:
    from rfm.app.run import Result
    from solvers.stopwatch import Listener

NORMS = {"l2": "relative_l2_error", "h1": "relative_h1_error", "max": "relative_max_error"}


def variants(case: Case) -> list[Case]:
    """Cases of the study: every degree on every grid, degrees outermost.

    Raises
    ------
    CaseError
        The case has no study.
    """
    if case.study is None:
        message = "the case has no study; add e.g. study: {grid: [8, 16, 32], degree: [2, 3]}"
        raise case.error((), message)
    given = case.discretization
    if case.study.grid is None and given.spacing is not None:
        raise case.error(("study",), "needs grids: a study of degrees cannot take the spacing", key=True)
    from rfm.app.schema.discretization import DEFAULT_GRID

    grids = case.study.grid or (given.grid or DEFAULT_GRID,)
    degrees = case.study.degree or (given.degree,)
    return [case.discretized(degree=degree, grid=grid) for degree in degrees for grid in grids]


def run_study(
    case: Case,
    listener: Listener | None = None,
    row_done: Callable[[Mapping[str, Any]], None] = lambda row: None,
) -> tuple[list[dict[str, Any]], Result | None]:
    """Rows of the study and the result of its last successful row.

    A grid that is too coarse for a degree gives a row without results that says so.

    Raises
    ------
    RfmError
        The case is wrong, the numerics failed, or no row succeeded.
    """
    from rfm.app.run import compute

    rows: list[dict[str, Any]] = []
    last: Result | None = None
    refusal: CaseError | None = None
    for variant in variants(case):
        try:
            last = compute(variant, listener)
            row = row_of(last.summary)
        except CaseError as error:
            if not isinstance(error.__cause__, DiscretizationError):
                raise
            refusal, row = error, _refused(variant, error)
        earlier = [other for other in rows if other["degree"] == row["degree"] and other["dofs"] is not None]
        rows.append({**row, **_rates(earlier[-1] if earlier else None, row)})
        row_done(rows[-1])
    if last is None and refusal is not None:
        raise refusal
    return rows, last


def row_of(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Row of the summary of one run, without rates."""
    row = {key: summary[key] for key in ("degree", "grid", "dofs")}
    row.update({key: summary[key] for key in NORMS.values()})
    return {**row, "energy": summary["energy"], "seconds": summary["seconds"]["total"]}


def _refused(case: Case, error: CaseError) -> dict[str, Any]:
    given = case.discretization
    empty = dict.fromkeys(("dofs", *NORMS.values(), "energy", "seconds"))
    return {"degree": given.degree, "grid": given.grid, **empty, "refused": error.message}


def _rates(before: Mapping[str, Any] | None, row: Mapping[str, Any]) -> dict[str, float | None]:
    """Measured orders from the row before of the same degree: log(e1 / e2) / log(n2 / n1)."""
    rates: dict[str, float | None] = {f"rate_{name}": None for name in NORMS}
    for name, key in NORMS.items():
        first, second = (before or {}).get(key), row.get(key)
        if before is not None and first and second and first > 0 and second > 0:
            rates[f"rate_{name}"] = math.log(first / second) / math.log(row["grid"] / before["grid"])
    return rates
