"""Rows of a benchmark, stop watch, and what is read off the rows: what a tolerance costs, how the cost grows."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

PHASES = ("geometry", "quadrature", "assembly", "solve")
TOLERANCES = (1e-4, 1e-6, 1e-8)

Configuration = Mapping[str, Any]
"""What a program is told besides the problem, plain values."""


class Laps:
    """Wall and processor time by phase."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(PHASES, 0.0)
        self._start = time.process_time()
        self._mark = time.perf_counter()
        self.processor = 0.0

    def lap(self, phase: str) -> None:
        """Count the time since the last call for `phase`."""
        self.split({phase: time.perf_counter() - self._mark})

    def split(self, shares: Mapping[str, float]) -> None:
        """Count the time since the last call for the phases of `shares`, what they leave for ``other``."""
        now = time.perf_counter()
        rest = now - self._mark
        for phase, seconds in shares.items():
            if phase in PHASES:
                self.seconds[phase] += seconds
                rest -= seconds
        if rest > 0:
            self.seconds["other"] = self.seconds.get("other", 0.0) + rest
        self._mark = now
        self.processor = time.process_time() - self._start

    @property
    def total(self) -> float:
        """Seconds of all phases."""
        return sum(self.seconds.values())


@dataclass(frozen=True)
class Answer:
    """What a program returns: the number of unknowns, and how to compute the relative error, which is not timed."""

    unknowns: int
    error: Callable[[], float]


@dataclass(frozen=True)
class Row:
    """One solve.

    Attributes
    ----------
    program, problem, series, configuration
        What was run.
    unknowns, error
        Their number, and the relative L2 error.
    seconds
        Wall seconds by phase of the fastest repeat.
    first, processor
        Wall seconds of the first repeat, least processor seconds of any.
    memory_mb
        Highest resident memory during the first repeat, minus what the imports take.
    repeats
        How often it was timed.
    """

    program: str
    problem: str
    series: str
    configuration: Configuration
    unknowns: int
    error: float
    seconds: Mapping[str, float]
    first: float = 0.0
    processor: float = 0.0
    memory_mb: float = 0.0
    repeats: int = 1

    @property
    def total(self) -> float:
        """Seconds of all phases."""
        return sum(self.seconds.values())


@dataclass(frozen=True)
class Reached:
    """What a program needs for a tolerance by its fastest series, and the fewest unknowns of any.

    ``coarsest`` says that the first configuration of the fastest series is already more accurate, so that the
    numbers are upper bounds.
    """

    seconds: float
    unknowns: float
    series: str
    coarsest: bool
    fewest_unknowns: float
    fewest_series: str = field(default="")


def crossing(rows: Sequence[Row], tolerance: float) -> tuple[float, float] | None:
    """Seconds and unknowns at which the errors of one series, coarse to fine, first pass `tolerance`.

    Interpolated linearly between logarithms; None when the tolerance is not reached.
    """
    for before, after in zip([None, *rows], rows, strict=False):
        if after.error > tolerance:
            continue
        if before is None:
            return after.total, float(after.unknowns)
        t = math.log(before.error / tolerance) / math.log(before.error / after.error)
        return blend(t, before.total, after.total), blend(t, before.unknowns, after.unknowns)
    return None


def blend(t: float, start: float, end: float) -> float:
    """Geometric mean of two positive numbers, `end` weighted by t."""
    return math.exp((1 - t) * math.log(start) + t * math.log(end))


def by_series(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Rows of one program and problem, series by series."""
    series: dict[str, list[Row]] = {}
    for row in rows:
        series.setdefault(row.series, []).append(row)
    return series


def reached(rows: Iterable[Row], tolerance: float) -> Reached | None:
    """Best over the series of what is needed for `tolerance`; None when no series reaches it."""
    parts = by_series(rows)
    found = [(point, name) for name, part in parts.items() if (point := crossing(part, tolerance))]
    if not found:
        return None
    (seconds, unknowns), name = min(found)
    (_, fewest), frugal = min(found, key=lambda one: one[0][1])
    return Reached(seconds, unknowns, name, parts[name][0].error <= tolerance, fewest, frugal)


def exponent(unknowns: Sequence[float], costs: Sequence[float]) -> float:
    """Exponent of the power of the unknowns that fits the costs best, in the sense of least squares of logarithms.

    Raises
    ------
    ValueError
        There are fewer than two different numbers of unknowns.
    """
    if len(set(unknowns)) < 2:
        raise ValueError("an exponent needs two different numbers of unknowns")
    x, y = [math.log(n) for n in unknowns], [math.log(c) for c in costs]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True))
    return slope / sum((a - mean_x) ** 2 for a in x)
