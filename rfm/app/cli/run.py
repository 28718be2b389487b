"""`rfm run`: solve a case and write its run directory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from rfm.app.case import Case
from rfm.app.cli.outcome import DONE, MISSED, print_json
from rfm.app.cli.output import say, table
from rfm.app.cli.progress import listening
from rfm.app.cli.settings import load
from rfm.app.memory import refuse_large
from rfm.errors import RfmError

HEADLINES = (
    "degree",
    "grid",
    "dofs",
    "relative_l2_error",
    "relative_h1_error",
    "relative_max_error",
    "energy",
)


def run_case(
    *,
    file: Path,
    settings: Sequence[str],
    out: Path | None,
    allow_large: bool,
    as_json: bool,
    together: Mapping[str, Any] | None = None,
) -> int:
    """Solve a case, `together` with other processes if there are any; returns the exit code."""
    from rfm.app.output import write_run
    from rfm.app.run import compute, record_of
    from rfm.app.run_directory import check_output

    case = load(file, settings)
    directory = out or Path("runs") / case.name
    index, machines = (0, 1) if together is None else joined(case, **together)
    if index:
        return MISSED if compute(case).misses else DONE
    with nullcontext() if together is None else telling_others(case):
        check_output(directory)
        if not allow_large:
            refuse_large(case, share=machines)
    with listening() as listener:
        result = compute(case, listener)
        listener.phase("files")
        files = write_run(record_of(result), directory)
    describe(result.summary, as_json)
    for warning in result.warnings:
        say(f"warning: {warning}", as_json)
    for name, path in files.items():
        say(f"{name:<14} {path}", as_json)
    for miss in result.misses:
        say(f"missed: {miss}", as_json)
    if as_json:
        print_json({**result.summary, "files": files})
    return MISSED if result.misses else DONE


def joined(case: Case, coordinator: str | None, count: int | None, index: int | None) -> tuple[int, int]:
    """Join other processes; the number of this one, of which 0 writes the results, and how many machines there are.

    Raises
    ------
    RfmError
        The case solves without devices, or the others are not there.
    """
    from solvers.device.backend import NONE

    if coordinator is None:
        raise RfmError("--processes and --process need --coordinator HOST:PORT, the address of process 0")
    if case.solver.device == NONE:
        message = f"several processes solve together on devices only: choose cpu or gpu, got {NONE}"
        raise case.error(("solver", "device"), message)
    import socket

    from solvers.device.processes import join, team_of

    number = join(coordinator, count, index)
    return number, len(set(team_of(case.solver.device).gather(socket.gethostname())))


def telling_others(case: Case) -> AbstractContextManager[None]:
    """Context whose errors end the other processes too."""
    from solvers.device.processes import telling

    return telling(case.solver.device)


def describe(summary: Mapping[str, Any], as_json: bool) -> None:
    """Print what matters of a summary."""
    rows = [(key, summary.get(key)) for key in HEADLINES if summary.get(key) is not None]
    memory = dict(summary.get("memory_per_unknown") or {})
    # of small problems, solved as arrays, the peak is the program itself
    memory = memory if memory.get("solver") else {}
    for section in ("boundary_error", "integrals", "probes", "seconds"):
        for name, value in dict(summary.get(section) or {}).items():
            rows.append((f"{section}.{name}", value))
    rows += [(f"memory_per_unknown.{name} (bytes)", value) for name, value in memory.items()]
    for number, corner in enumerate(summary.get("corners") or ()):
        rows.append((f"corners.{number}.intensity", corner["intensity"]))
    linear = summary.get("linear") or {}
    rows += [
        (f"linear.{key}", linear[key])
        for key in ("method", "reason", "residual", "iterations")
        if key in linear
    ]
    table(("result", "value"), rows, as_json, title=str(summary.get("title") or summary.get("case", "")))
