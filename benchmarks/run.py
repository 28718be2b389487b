"""Time rfm beside other programs: ``python -m benchmarks.run [--limit SECONDS] [--only TEXT] [--programs ...]``.

Every program runs its series on every problem through :mod:`benchmarks.worker`, each solve in a process of its own
with two threads; nothing else runs meanwhile.  Times are after the imports, the smallest of up to three repeats, and
hold geometry or mesh, quadrature or cutting, assembly and solve, not the error norm.  Rows go to
``benchmarks/results/NAME.json``, tables to the terminal, and with ``--pages docs`` a page and plots to docs/.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks import report
from benchmarks.problems import PROBLEMS
from benchmarks.programs import MODULES
from benchmarks.record import Row

THREADS = "2"
VARIABLES = ("OMP", "OPENBLAS", "MKL", "NGS", "NUMBA")
SHARE = 8.0
"""All series of a program on a problem share this many times the limit."""

OURS = ("rfm", "rfm, large")
COMPARED = tuple(name for name in MODULES if name != "rfm, large")
LARGE_PROBLEMS = ("annulus", "ball minus cylinder")
ROOT = Path(__file__).resolve().parents[1]


@dataclass
class Record:
    """What a run of the benchmark leaves behind."""

    settings: dict[str, Any]
    versions: dict[str, dict[str, str]] = field(default_factory=dict)
    rows: list[Row] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def write(self, path: Path) -> None:
        """Write JSON."""
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = [{**vars(row), "total": row.total} for row in self.rows]
        content = {"settings": self.settings, "versions": self.versions, "rows": rows, "notes": self.notes}
        path.write_text(json.dumps(content, indent=1) + "\n")


def environment() -> dict[str, str]:
    """Environment of the workers."""
    threads = {f"{name}_NUM_THREADS": THREADS for name in VARIABLES}
    return {**os.environ, **threads, "NUTILS_NPROCS": THREADS, "PYTHONPATH": str(ROOT)}


def lines(python: str, program: str, problem: str, options: list[str]) -> Iterator[dict[str, Any]]:
    """What a worker says, as it says it; a last note when it failed."""
    command = [python, "-m", "benchmarks.worker", program, problem, *options]
    with (
        tempfile.TemporaryFile("w+") as errors,  # not a pipe: warnings would fill it
        subprocess.Popen(
            command, cwd=ROOT, env=environment(), text=True, stdout=subprocess.PIPE, stderr=errors
        ) as worker,
    ):
        assert worker.stdout is not None
        for line in worker.stdout:
            if line.startswith("{"):  # programs greet on the same stream
                yield json.loads(line)
        worker.wait()
        errors.seek(0)
        complaint = errors.read().strip().splitlines()
    if worker.returncode:
        yield {"note": complaint[-1] if complaint else f"exit code {worker.returncode}"}


def described(row: Row) -> str:
    """One row for the terminal."""
    phases = "  ".join(f"{phase} {seconds:.4f}" for phase, seconds in row.seconds.items() if seconds)
    size = " ".join(
        f"{key}={value:.4g}" for key, value in row.configuration.items() if isinstance(value, float | int)
    )
    return (
        f"  {row.series:<14} {size:<26} {row.unknowns:>8} unknowns  {row.error:.2e}  {row.total:.4f} s  "
        f"{row.memory_mb:.0f} MB  ({phases})"
    )


def collect(record: Record, python: str, program: str, problem: str, options: list[str]) -> None:
    """Run one worker and keep what it says."""
    for line in lines(python, program, problem, options):
        if "row" in line:
            record.rows.append(Row(**line["row"]))
            print(described(record.rows[-1]), flush=True)
        elif "versions" in line:
            record.versions[program] = line["versions"]
        else:
            record.notes.append(f"{problem}|{program}|{line['note']}")
            print(f"  {line['note']}", flush=True)


def arguments() -> argparse.Namespace:
    """Options of the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--limit", type=float, default=10.0, help="seconds at which a series ends; in space thrice"
    )
    parser.add_argument("--programs", nargs="+", choices=COMPARED, default=list(COMPARED))
    parser.add_argument("--only", default="", help="only problems whose name contains this text")
    parser.add_argument("--peers-python", default=sys.executable, help="interpreter of the other programs")
    parser.add_argument(
        "--large", action="store_true", help="only rfm, to 1e6 unknowns, for the growth of the cost"
    )
    parser.add_argument("--name", help="stem of the file of results")
    parser.add_argument(
        "--out", type=Path, default=ROOT / "benchmarks" / "results", help="folder of the results"
    )
    parser.add_argument(
        "--pages", type=Path, help="folder of the documentation to write a page and plots into"
    )
    parser.add_argument("--remark", default="", help="a sentence about the machine for the page")
    return parser.parse_args()


def main() -> None:
    """Run everything and write the tables."""
    given = arguments()
    programs = ["rfm, large"] if given.large else given.programs
    name = given.name or ("large" if given.large else "peers")
    record = Record(
        {
            "system": f"{platform.system()} {platform.machine()}",
            "cores": os.cpu_count(),
            "threads": int(THREADS),
            "limit": given.limit,
            "remark": given.remark,
        }
    )
    options = [str(given.limit), str(SHARE * given.limit), *(["--all"] if given.large else [])]
    for problem in PROBLEMS:
        if given.only not in problem.name or (given.large and problem.name not in LARGE_PROBLEMS):
            continue
        for program in programs:
            print(f"{problem.name}, {program}", flush=True)
            python = sys.executable if program in OURS else given.peers_python
            collect(record, python, program, problem.name, options)
            record.write(given.out / f"{name}.json")
    print("\n" + "\n".join(report.summary(record.rows)))
    if given.pages:
        report.write(given.out, given.pages)


if __name__ == "__main__":
    main()
