"""The directory of a study: what is finished stays, so that the same command goes on where it ended.

::

    DIR/study.json           the runs with their states and results, and the resolved case
    DIR/study.csv            the same table
    DIR/runs/NAME/           one directory for each run that is done
    DIR/summary.json, ...    the last run with the table, as `rfm run` writes it

A run is written as a whole or not at all.  Whether it is done is told by its own ``summary.json``, which holds the
fingerprint of its case; ``study.json`` is a view that is written now and then, and at the end.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rfm import __version__
from rfm.app.run_directory import (
    REASONS,
    STUDY_FILE,
    OutputError,
    check_output,
    discard,
    replacing,
    write_bytes,
)
from rfm.app.storage import plain, summary_text
from rfm.app.study.plan import Plan, changes
from rfm.app.study.table import csv_text, row_of, row_of_outcome, with_rates
from rfm.app.study.task import DONE, Outcome, Task

FORMAT = 1
RUNS = "runs"

OFTEN = 2.0
"""Seconds between two writings of the table."""

SHOWN = 4
"""Keys named where a case has changed."""


class StudyFolder:
    """The directory of a study.

    Parameters
    ----------
    path, plan
        Where, and which runs.
    files
        Names of the files that a run must have to be done.
    restart
        Remove the runs that are done, to make all anew.

    Raises
    ------
    OutputError
        It holds something else, cannot be written, or holds runs of another state of the case.
    """

    def __init__(self, path: Path, plan: Plan, files: tuple[str, ...], restart: bool = False) -> None:
        check_output(path)
        self.path, self.plan, self.files = path, plan, files
        self._tasks = {task.name: task for task in plan.tasks}
        self._written = 0.0
        if restart:
            for task in plan.tasks:
                discard(self.folder(task.name))
        self.rows: dict[str, dict[str, Any]] = self._found()

    def folder(self, name: str) -> Path:
        """Directory of a run."""
        return self.path / RUNS / name

    def pending(self) -> list[Task]:
        """Runs that are missing or failed."""
        return [task for task in self.plan.tasks if self.rows.get(task.name, {}).get("state") != DONE]

    def keep(self, outcome: Outcome) -> None:
        """Write what came out of a run."""
        task = self._tasks[outcome.name]
        if outcome.files:
            with replacing(self.folder(outcome.name)) as partial:
                for name, content in outcome.files.items():
                    write_bytes(partial / name, content)
        self.rows[outcome.name] = row_of_outcome(task, outcome)
        if time.monotonic() - self._written > OFTEN:
            self.write()

    def table(self) -> list[dict[str, Any]]:
        """Rows of all runs in the order of the plan."""
        return with_rates(self.plan, self.rows)

    def write(self) -> None:
        """Write the table."""
        rows = self.table()
        state = {
            "format": FORMAT,
            "rfm": __version__,
            "case": self.plan.case.name,
            "title": self.plan.case.title,
            "runs": {s: sum(row["state"] == s for row in rows) for s in sorted({r["state"] for r in rows})},
            "axes": {axis.key: list(axis.values) for axis in self.plan.axes},
            "rows": rows,
            "resolved_case": self._resolved(),
        }
        self._put(STUDY_FILE, summary_text(state))
        self._put("study.csv", csv_text(self.plan, rows))
        self._written = time.monotonic()

    def _resolved(self) -> dict[str, Any]:
        """Return the case as plain data without its study."""
        case: dict[str, Any] = plain(self.plan.case.to_dict())
        case.pop("study", None)
        return case

    def _put(self, name: str, text: str) -> None:
        partial = self.path / f".{name}.partial"
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            partial.write_text(text, encoding="utf-8")
            partial.replace(self.path / name)
        except OSError as error:
            reason = REASONS.get(error.errno or 0, error.strerror or str(error))
            raise OutputError(
                f"cannot write {self.path / name}: {reason}; the finished runs are kept"
            ) from error

    def _found(self) -> dict[str, dict[str, Any]]:
        """Rows of the runs that are done."""
        rows, other = {}, []
        for task in self.plan.tasks:
            folder = self.folder(task.name)
            summary = _read(folder / "summary.json")
            if summary is None:
                continue
            if (summary.get("study") or {}).get("digest") != task.digest:
                other.append(task.name)
            elif all((folder / name).exists() for name in self.files):
                rows[task.name] = row_of(task, DONE, summary)
        if other:
            raise OutputError(
                f"{self.path} holds {len(other)} of these runs of another state of the case{self._changed()}: choose "
                "another directory with --out, or make them anew with --restart"
            )
        return rows

    def _changed(self) -> str:
        """Which keys have changed since the study was written, in brackets."""
        before = _read(self.path / STUDY_FILE)
        if before is None:
            return ""
        varied = {axis.key for axis in self.plan.axes}
        found = [key for key in changes(before.get("resolved_case"), self._resolved()) if key not in varied]
        if not found:
            version = before.get("rfm")
            return f" (made by rfm {version})" if version != __version__ else ""
        more = f" and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
        return f" (changed: {', '.join(found[:SHOWN])}{more})"


def _read(file: Path) -> Mapping[str, Any] | None:
    """Content of a JSON file; None when there is none, or it is damaged."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None
