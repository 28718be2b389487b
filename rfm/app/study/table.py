"""The table of a study: one row for each run, with the measured rates."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rfm.app.study.plan import DEGREE, GRID, Plan
from rfm.app.study.task import DONE, PENDING, REFUSED, Outcome, Task

NORMS = {"l2": "relative_l2_error", "h1": "relative_h1_error", "max": "relative_max_error"}

RESULTS = ("dofs", *NORMS.values(), "energy", "seconds")


def row_of(task: Task, state: str, summary: Mapping[str, Any] | None) -> dict[str, Any]:
    """Row of a run, without rates; `summary` is that of a run that is done."""
    row: dict[str, Any] = {
        "run": task.name,
        "state": state,
        "settings": dict(task.settings),
        "degree": task.degree,
        "grid": task.grid,
    }
    if summary is None:
        return {**row, **dict.fromkeys(RESULTS), "results": {}}
    row.update({key: summary[key] for key in ("degree", "grid", "dofs", *NORMS.values(), "energy")})
    return {**row, "seconds": summary["seconds"]["total"], "results": dict(_scalars(summary))}


def row_of_outcome(task: Task, outcome: Outcome) -> dict[str, Any]:
    """Row of a run that has ended."""
    row = row_of(task, outcome.state, outcome.summary)
    if outcome.error is None:
        return row
    row["error"] = dict(outcome.error)
    return {**row, "refused": row["error"]["message"]} if outcome.state == REFUSED else row


def _scalars(summary: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """Integrals, and values at probes, by name."""
    for name, value in (summary.get("integrals") or {}).items():
        yield from _numbers(f"integrals.{name}", value)
    for name, found in (summary.get("probes") or {}).items():
        yield from _numbers(f"probes.{name}.u", found.get("u"))


def _numbers(name: str, value: Any) -> Iterator[tuple[str, float]]:
    if isinstance(value, int | float):
        yield name, value
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for i, item in enumerate(value):
            yield from _numbers(f"{name}.{i}", item)


def with_rates(plan: Plan, rows: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows of the whole plan in its order, with rates; runs that are not in `rows` are pending.

    A rate is measured from the last coarser run that is done and differs in its grid only.
    """
    last: dict[str, Mapping[str, Any]] = {}
    table = []
    for task in plan.tasks:
        row = rows.get(task.name) or row_of(task, PENDING, None)
        series = str({key: value for key, value in task.settings.items() if key != GRID})
        table.append({**row, **_rates(last.get(series), row)})
        if row["state"] == DONE:
            last[series] = row
    return table


def _rates(before: Mapping[str, Any] | None, row: Mapping[str, Any]) -> dict[str, float | None]:
    """Measured orders: log(e1 / e2) / log(n2 / n1)."""
    rates: dict[str, float | None] = {f"rate_{name}": None for name in NORMS}
    for name, key in NORMS.items():
        first, second = (before or {}).get(key), row.get(key)
        if (
            before is None
            or not first
            or not second
            or min(first, second) <= 0
            or row["grid"] == before["grid"]
        ):
            continue
        rates[f"rate_{name}"] = math.log(first / second) / math.log(row["grid"] / before["grid"])
    return rates


def csv_text(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the table as comma-separated values, numbers with all their digits."""
    results = list(dict.fromkeys(key for row in rows for key in row["results"]))
    varied = [axis.key for axis in plan.axes if axis.key not in (DEGREE, GRID)]
    rates = [f"rate_{name}" for name in NORMS]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["run", "state", *varied, "degree", "grid", *RESULTS, *rates, *results, "message"])
    for row in rows:
        writer.writerow(
            [
                row["run"],
                row["state"],
                *(row["settings"][key] for key in varied),
                *(row.get(key) for key in ("degree", "grid", *RESULTS, *rates)),
                *(row["results"].get(key) for key in results),
                message_of(row),
            ]
        )
    return stream.getvalue()


def message_of(row: Mapping[str, Any]) -> str:
    """Why a run has no results; empty where it has."""
    return str((row.get("error") or {}).get("message", ""))
