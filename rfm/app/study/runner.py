"""Runs a study: what is missing is computed, what ends is kept, what fails is recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rfm.app.storage import StorageError
from rfm.app.study.engines import Engine
from rfm.app.study.folder import StudyFolder
from rfm.app.study.plan import Plan
from rfm.app.study.table import row_of_outcome, with_rates
from rfm.app.study.task import DONE, FAILED, Outcome, Task
from rfm.errors import CaseError, NumericsError

KEPT = ("summary.json", "solution.h5")
"""Files of a run that are always kept: enough to evaluate, draw and report it later."""

Told = Callable[[int, int, Mapping[str, Any]], None]


@dataclass(frozen=True)
class Study:
    """A study that has ended.

    Attributes
    ----------
    rows
        The table.
    reused
        Runs that were done before.
    files
        Files of the last run with the table, by name; empty when no directory was asked for.
    """

    rows: list[dict[str, Any]]
    reused: int = 0
    files: Mapping[str, str] | None = None

    @property
    def failed(self) -> list[dict[str, Any]]:
        """Rows of the runs that failed."""
        return [row for row in self.rows if row["state"] == FAILED]


class Interrupted(KeyboardInterrupt):
    """The study was interrupted; the message says what was kept and how to go on."""


def run_study(
    plan: Plan,
    engine: Engine,
    told: Told = lambda done, count, row: None,
    allow_large: bool = False,
) -> Study:
    """Run a study and keep nothing but its table.

    Parameters
    ----------
    plan, engine
        Which runs, and who computes them.
    told
        Told the number of ended runs, of all runs, and the row of each run as it ends.
    allow_large
        Do not refuse runs that may not fit into memory.

    Raises
    ------
    RfmError
        No run succeeded: the error of the first.
    """
    tasks = {task.name: task for task in plan.tasks}
    rows: dict[str, dict[str, Any]] = {}
    try:
        for outcome in _ended(engine, [replace(task, allow_large=allow_large) for task in plan.tasks]):
            rows[outcome.name] = row_of_outcome(tasks[outcome.name], outcome)
            told(len(rows), len(tasks), rows[outcome.name])
    except KeyboardInterrupt:
        message = f"interrupted after {len(rows)} of {len(tasks)} runs; nothing is kept without --out DIR"
        raise Interrupted(message) from None
    table = with_rates(plan, rows)
    _require_success(table)
    return Study(table)


def run_study_in(
    folder: StudyFolder,
    engine: Engine,
    told: Told = lambda done, count, row: None,
    allow_large: bool = False,
) -> Study:
    """Run what is missing or failed of a study, and keep it in a directory.

    Raises
    ------
    RfmError
        No run succeeded: the error of the first.  What was computed is kept in any case.
    """
    count, reused = len(folder.plan.tasks), len(folder.rows)
    tasks = [
        replace(task, folder=str(folder.folder(task.name)), files=folder.files, allow_large=allow_large)
        for task in folder.pending()
    ]
    try:
        folder.write()
        for outcome in _ended(engine, tasks):
            folder.keep(outcome)
            told(len(folder.rows), count, folder.rows[outcome.name])
    except KeyboardInterrupt:
        done = sum(row["state"] == DONE for row in folder.rows.values())
        raise Interrupted(
            f"interrupted; {done} of {count} runs are done and kept in {folder.path}: the same command goes on "
            "from there"
        ) from None
    finally:
        folder.write()
    rows = folder.table()
    _require_success(rows)
    return Study(rows, reused, _report(folder, rows))


def _ended(engine: Engine, tasks: Sequence[Task]) -> Iterator[Outcome]:
    """Outcomes of an engine, which is stopped with the iteration."""
    outcomes = engine.outcomes(tasks)
    try:
        yield from outcomes
    finally:
        close = getattr(outcomes, "close", None)
        if close is not None:
            close()


def _report(folder: StudyFolder, rows: list[dict[str, Any]]) -> dict[str, str]:
    """Write the last run that is done into the directory of the study, with the table."""
    from rfm.app.output import write_run
    from rfm.app.restored import restore

    last = next(row["run"] for row in reversed(rows) if row["state"] == DONE)
    path: Path = folder.folder(last)
    try:
        record = restore(path).record(tuple(rows))
    except StorageError as error:
        raise StorageError(f"{error}; remove {path} and give the same command again") from error
    return write_run(record, folder.path)


def _require_success(rows: list[dict[str, Any]]) -> None:
    """Refuse a study of which nothing came out."""
    if any(row["state"] == DONE for row in rows):
        return
    error = next(row["error"] for row in rows if row.get("error"))
    raised = CaseError if error["exit_code"] == CaseError.exit_code else NumericsError
    raise raised(error["text"])
