"""Time rfm beside scikit-fem: python benchmarks/poisson_vs_scikit_fem.py [--quick] [--only NAME] [--out DIR].

Both run in this one process, after the imports, each over its degrees and grids; a time is the smallest of
three and holds geometry or mesh, assembly and solve, not the error norm.  Prints every row, then what reaches
1e-4, 1e-6 and 1e-8, and writes both as JSON and Markdown.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path

import fitted
import immersed
import numpy as np
import scipy
import skfem
from problems import BENCHMARKS, Benchmark
from record import Laps, Row, reached

from rfm.errors import RfmError

TOLERANCES = (1e-4, 1e-6, 1e-8)
REPEATS = 3
LONG = 4.0
"""Seconds above which a solve is timed once only."""


def fastest(solve: Callable[[Laps], Row]) -> Row:
    """The fastest of a few repeats."""
    best = solve(Laps())
    for _ in range(REPEATS - 1):
        if best.total > LONG:
            break
        row = solve(Laps())
        best = min(best, row, key=lambda one: one.total)
    return best


def series(solves: Iterable[Callable[[Laps], Row]], limit: float) -> Iterator[Row]:
    """Rows coarse to fine, until the last tolerance is reached, the error stalls or a solve exceeds `limit`."""
    previous: Row | None = None
    stalled = 0
    for solve in solves:
        try:
            row = fastest(solve)
        except RfmError as error:  # a grid too coarse for the degree is part of the sweep
            print(f"    {error}", file=sys.stderr)
            continue
        yield row
        if row.error < TOLERANCES[-1] or row.total > limit:
            return
        stalled = stalled + 1 if previous and row.error > 0.8 * previous.error else 0
        if stalled == 2:
            return
        previous = row


def sweep(benchmark: Benchmark, limit: float) -> Iterator[Row]:
    """All rows of a problem, rfm first."""
    for degree in benchmark.degrees:
        yield from series(
            (partial(immersed.solve, benchmark, degree, grid) for grid in benchmark.grids), limit
        )
    for degree in fitted.ELEMENTS[benchmark.dimension]:
        yield from series((partial(fitted.solve, benchmark, degree, size) for size in benchmark.sizes), limit)


def line(row: Row) -> str:
    """One row for the terminal."""
    phases = "  ".join(f"{phase} {seconds:.4f}" for phase, seconds in row.seconds.items())
    return (
        f"  {row.program:<10}  p={row.degree}  {row.size:>7}  {row.unknowns:>8} unknowns  "
        f"{row.error:.2e}  {row.total:.4f} s  ({phases})"
    )


def table(rows: list[Row]) -> list[str]:
    """Markdown: what each program needs for each tolerance."""
    text = ["| problem | program | " + " | ".join(f"{t:.0e}" for t in TOLERANCES) + " |", "|---" * 5 + "|"]
    for problem in dict.fromkeys(row.problem for row in rows):
        for program in dict.fromkeys(row.program for row in rows):
            mine = [row for row in rows if (row.problem, row.program) == (problem, program)]
            cells = []
            for tolerance in TOLERANCES:
                best = reached(mine, tolerance)
                cells.append(str(best) if best else closest(mine))
            text.append(f"| {problem} | {program} | " + " | ".join(cells) + " |")
    return text


def closest(rows: list[Row]) -> str:
    """How near a program came to a tolerance that it did not reach."""
    best = min(rows, key=lambda row: row.error)
    return f"not reached ({best.error:.0e} in {best.total:.1f} s / {best.unknowns})"


def host() -> dict[str, str]:
    """What the times were measured on."""
    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "scikit-fem": skfem.__version__,
        "system": f"{platform.system()} {platform.machine()}",
        "cores": str(os.cpu_count()),
        "threads": os.environ.get("OMP_NUM_THREADS", "all"),
    }


def main() -> None:
    """Run the sweeps and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--quick", action="store_true", help="end each series at a solve of 1 s instead of 30 s"
    )
    parser.add_argument("--only", help="only problems whose name contains this text")
    parser.add_argument("--out", type=Path, default=Path("benchmarks/results"), help="folder of the tables")
    arguments = parser.parse_args()
    limit = 1.0 if arguments.quick else 30.0
    rows: list[Row] = []
    for benchmark in BENCHMARKS:
        if arguments.only and arguments.only not in benchmark.name:
            continue
        print(f"{benchmark.name}: unknowns, relative L2 error, seconds", flush=True)
        for row in sweep(benchmark, limit):
            rows.append(row)
            print(line(row), flush=True)
    summary = table(rows)
    print("\nseconds / unknowns to reach a relative L2 error, by the fastest degree:\n")
    print("\n".join(summary))
    arguments.out.mkdir(parents=True, exist_ok=True)
    record = {"host": host(), "rows": [{**asdict(row), "total": row.total} for row in rows]}
    stem = arguments.out / "poisson_vs_scikit_fem"
    stem.with_suffix(".json").write_text(json.dumps(record, indent=1) + "\n")
    stem.with_suffix(".md").write_text("\n".join(summary) + "\n")
    print(f"\nwritten: {stem}.json, {stem}.md")


if __name__ == "__main__":
    main()
