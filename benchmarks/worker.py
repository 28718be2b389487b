"""One program on one problem: ``python -m benchmarks.worker PROGRAM PROBLEM LIMIT BUDGET [--all]``.

The program is imported once.  Then every solve runs in a process of its own, forked from this one, so that none finds
caches of another and the memory is that of one solve.  Rows are written to standard output, one JSON object a line;
a line with ``note`` says why a configuration or series was left out.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from multiprocessing.connection import Connection
from typing import Any

from benchmarks.problems import Problem, problem
from benchmarks.programs import Program, load
from benchmarks.record import TOLERANCES, Configuration, Laps, Row

REPEATS = 3
LONG = 1.5
"""Seconds after which a solve is not repeated."""
PATIENCE = 8.0
"""A solve with its repeats and error norm is ended after this many times the limit, plus `LONG`."""
SPATIAL = 3.0
"""Limit and budget in space are larger by this factor."""


def resident_mb() -> float:
    """Highest resident memory of this process so far."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024.0**2 if sys.platform == "darwin" else 1024.0)


def measure(program: Program, name: str, one: Problem, series: str, configuration: Configuration) -> Row:
    """The fastest of a few repeats in this process."""
    before = resident_mb()
    first, total, processor, repeats = 0.0, 0.0, float("inf"), 0
    best: Laps | None = None
    while repeats < REPEATS and total < LONG:
        laps = Laps()
        answer = program.solve(one, configuration, laps)
        if best is None:
            first, memory = laps.total, resident_mb() - before
        best = laps if best is None or laps.total < best.total else best
        processor = min(processor, laps.processor)
        total, repeats = total + laps.total, repeats + 1
    assert best is not None
    return Row(
        name, one.name, series, configuration, answer.unknowns, answer.error(), best.seconds,
        first, processor, memory, repeats,
    )  # fmt: skip


def report(sender: Connection, *arguments: Any) -> None:
    """Send what was measured, or what went wrong."""
    try:
        sender.send(measure(*arguments))
    except Exception as error:  # of any program: a failed configuration is a result, not the end
        sender.send(f"{type(error).__name__}: {error}".splitlines()[0][:300])


def isolated(timeout: float, *arguments: Any) -> Row | str:
    """Measure in a process of its own: the row, or why there is none."""
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=report, args=(sender, *arguments))
    process.start()
    sender.close()
    result: Row | str
    try:
        result = receiver.recv() if receiver.poll(timeout) else f"not done after {timeout:.0f} s"
    except EOFError:
        result = "the process ended without a result"
    process.kill()
    process.join()
    return result


def too_long(before: Row, last: Row, limit: float) -> bool:
    """Whether the next solve of a series, extrapolated from the last two, would exceed the limit."""
    growth = max(last.total / before.total, 1.5)
    return last.total * growth > 1.3 * limit


def sweep(
    program: Program, name: str, one: Problem, series: str, configurations: Sequence[Configuration],
    limit: float, deadline: float, whole: bool = False,
) -> Iterator[Row | str]:  # fmt: skip
    """Rows coarse to fine, until the last tolerance is reached, the error stalls or a solve takes too long.

    Of a `whole` series the error is no reason to end it.
    """
    previous: Row | None = None
    stalled = 0
    for configuration in configurations:
        if time.monotonic() > deadline:
            yield f"{series}: ended by the budget"
            return
        timeout = min(PATIENCE * limit, deadline - time.monotonic() + limit) + LONG
        result = isolated(timeout, program, name, one, series, configuration)
        if isinstance(result, str):
            yield f"{series}, {dict(configuration)}: {result}"
            if previous is not None or result.startswith("not done"):
                return
            continue  # a grid too coarse for the degree is part of the sweep
        yield result
        if result.total > limit or (result.error < TOLERANCES[-1] and not whole):
            return
        if previous is not None:
            stalled = stalled + 1 if result.error > 0.8 * previous.error else 0
            if (stalled == 2 and not whole) or too_long(previous, result, limit):
                return
        previous = result


def main() -> None:
    """Run all series of a program on a problem."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("problem")
    parser.add_argument("limit", type=float, help="seconds at which a series ends")
    parser.add_argument("budget", type=float, help="seconds for all series")
    parser.add_argument("--all", action="store_true", help="end no series because it is accurate enough")
    arguments = parser.parse_args()
    program, one = load(arguments.program), problem(arguments.problem)
    factor = SPATIAL if one.dimension == 3 else 1.0
    limit, budget = factor * arguments.limit, factor * arguments.budget
    print(json.dumps({"versions": dict(program.versions())}), flush=True)
    deadline = time.monotonic() + budget
    for name, configurations in program.series(one).items():
        results = sweep(program, arguments.program, one, name, configurations, limit, deadline, arguments.all)
        for result in results:
            line = {"note": result} if isinstance(result, str) else {"row": asdict(result)}
            print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
