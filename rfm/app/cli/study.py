"""`rfm study`: errors and rates over grids and degrees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rfm.app.cli.outcome import DONE, print_json
from rfm.app.cli.output import say, table
from rfm.app.cli.progress import listening
from rfm.app.cli.settings import load
from rfm.app.memory import refuse_large
from rfm.app.study import run_study, variants

COLUMNS = {
    "degree": "degree",
    "grid": "grid",
    "dofs": "dofs",
    "relative_l2_error": "L2 error",
    "rate_l2": "rate",
    "relative_h1_error": "H1 error",
    "rate_h1": "rate",
    "seconds": "seconds",
}


def study_case(
    *, file: Path, settings: Sequence[str], out: Path | None, allow_large: bool, as_json: bool
) -> int:
    """Run the study of a case; with `out`, write the directory of its last run with the table."""
    from rfm.app.run_directory import check_output

    case = load(file, settings)
    if out is not None:
        check_output(out)
    if not allow_large:
        for variant in variants(case):
            refuse_large(variant)
    with listening() as listener:
        rows, last = run_study(case, listener)
        files = _write(last, rows, out)
    table(list(COLUMNS.values()), [[_cell(row, key) for key in COLUMNS] for row in rows], as_json, case.title)
    for row in rows:
        if "refused" in row:
            say(f"degree {row['degree']}, grid {row['grid']}: {row['refused']}", as_json)
    for name, path in files.items():
        say(f"{name:<14} {path}", as_json)
    if as_json:
        print_json({"case": case.name, "status": "done", "rows": rows, "files": files})
    return DONE


def _write(last: Any, rows: Sequence[Mapping[str, Any]], out: Path | None) -> dict[str, str]:
    if out is None or last is None:
        return {}
    from rfm.app.output import write_run
    from rfm.app.run import record_of

    return write_run(record_of(last, tuple(dict(row) for row in rows)), out)


def _cell(row: Mapping[str, Any], key: str) -> Any:
    value = row.get(key)
    return f"{value:.2f}" if key.startswith("rate") and value is not None else value
