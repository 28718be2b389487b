"""`rfm study`: errors, rates and results over grids, degrees and any other keys."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rfm.app.cli.outcome import DONE, FAILED, print_json
from rfm.app.cli.output import say, shown, table
from rfm.app.cli.progress import listening
from rfm.app.cli.settings import document, parse_variations
from rfm.app.study.engines import Automatic, Engine, Here, Processes
from rfm.app.study.folder import StudyFolder
from rfm.app.study.plan import DEGREE, GRID, Plan, make_plan
from rfm.app.study.runner import KEPT, Study, run_study, run_study_in
from rfm.app.study.table import message_of
from rfm.app.study.task import DONE as RUN_DONE
from rfm.errors import CaseError

if TYPE_CHECKING:
    from solvers.stopwatch import Listener

COLUMNS = {
    "degree": "degree",
    "grid": "grid",
    "dofs": "dofs",
    "relative_l2_error": "L2 error",
    "rate_l2": "rate",
    "relative_h1_error": "H1 error",
    "rate_h1": "rate",
}

MOST_RESULTS = 4
"""Integrals and values at probes in the printed table; all are in the files."""


def study_case(
    *,
    file: Path,
    settings: Sequence[str],
    vary: Sequence[str],
    out: Path | None,
    jobs: int | None,
    scheduler: str | None,
    restart: bool,
    pictures: bool,
    allow_large: bool,
    as_json: bool,
) -> int:
    """Run the study of a case; returns the exit code."""
    if out is None and (restart or pictures):
        raise CaseError(
            f"{'--restart' if restart else '--pictures'} needs --out DIR, where the runs are kept"
        )
    if jobs is not None and jobs < 1:
        raise CaseError(f"must be at least 1, got {jobs}", place="--jobs")
    plan = make_plan(document(file, settings), parse_variations(vary))
    with listening() as listener:
        engine = _engine(jobs, scheduler, listener)
        if out is None:
            study = run_study(plan, engine, _tell, allow_large)
        else:
            folder = StudyFolder(out, plan, _files(pictures), restart)
            study = run_study_in(folder, engine, _tell, allow_large)
    _describe(plan, study, as_json)
    files = dict(study.files or {})
    for name, path in files.items():
        say(f"{name:<14} {path}", as_json)
    if as_json:
        status = "failed" if study.failed else "done"
        print_json({"case": plan.case.name, "status": status, "rows": study.rows, "files": files})
    return FAILED if study.failed else DONE


def _engine(jobs: int | None, scheduler: str | None, listener: Listener) -> Engine:
    if scheduler is not None:
        from rfm.app.study.cluster import Cluster

        return Cluster(scheduler, jobs)
    if jobs is None:
        return Automatic(listener)
    return Here(listener) if jobs == 1 else Processes(jobs)


def _files(pictures: bool) -> tuple[str, ...]:
    from rfm.app.run_directory import RUN_FILES

    return RUN_FILES if pictures else KEPT


def _tell(done: int, count: int, row: Mapping[str, Any]) -> None:
    """Say on standard error how a run ended."""
    words = [f"{row['state']}: {message_of(row)}"] if row["state"] != RUN_DONE else []
    if not words:
        error = row.get("relative_l2_error")
        words = [f"L2 error {error:.2e}"] if error is not None else [f"{row['dofs']} unknowns"]
        words.append(f"{row['seconds']:.2f} s")
    print(f"[{done:>{len(str(count))}}/{count}] {row['run']}: {', '.join(words)}", file=sys.stderr)


def _describe(plan: Plan, study: Study, as_json: bool) -> None:
    """Print the table, and why some rows are empty."""
    if study.reused:
        say(f"{study.reused} of {len(study.rows)} runs were done before", as_json)
    varied = {key: label for key, label in plan.labels().items() if key not in (DEGREE, GRID)}
    results = list(dict.fromkeys(key for row in study.rows for key in row["results"]))[:MOST_RESULTS]
    lines = [
        {
            **{label: row["settings"][key] for key, label in varied.items()},
            **{key: _cell(row, key) for key in COLUMNS},
            **{key.partition(".")[2]: row["results"].get(key) for key in results},
            "seconds": row["seconds"],
            "state": row["state"],
        }
        for row in study.rows
    ]
    kept = [
        key for key in lines[0] if any(line[key] is not None for line in lines) or key in ("degree", "grid")
    ]
    if all(row["state"] == RUN_DONE for row in study.rows):
        kept.remove("state")
    columns = [COLUMNS.get(key, key) for key in kept]
    table(columns, [[line[key] for key in kept] for line in lines], as_json, plan.case.title)
    for row in study.rows:
        if row["state"] != RUN_DONE:
            where = ", ".join(f"{key} {shown(value)}" for key, value in _named(plan, row).items())
            say(f"{where}: {message_of(row) or row['state']}", as_json)


def _named(plan: Plan, row: Mapping[str, Any]) -> dict[str, Any]:
    return {label: row["settings"][key] for key, label in plan.labels().items()}


def _cell(row: Mapping[str, Any], key: str) -> Any:
    value = row.get(key)
    return f"{value:.2f}" if key.startswith("rate") and value is not None else value
