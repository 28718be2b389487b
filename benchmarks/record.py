"""Rows of a benchmark, stop watch, and what it takes to reach a tolerance."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass


class Laps:
    """Wall time by phase."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._mark = time.perf_counter()

    def lap(self, phase: str) -> None:
        """Count the time since the last call for `phase`."""
        now = time.perf_counter()
        self.seconds[phase] = self.seconds.get(phase, 0.0) + now - self._mark
        self._mark = now

    def split(self, shares: Mapping[str, float]) -> None:
        """Count the time since the last call for the phases of `shares`, the rest of it for ``other``."""
        now = time.perf_counter()
        rest = now - self._mark
        for phase, seconds in shares.items():
            if phase != "total":
                self.seconds[phase] = self.seconds.get(phase, 0.0) + seconds
                rest -= seconds
        self.seconds["other"] = self.seconds.get("other", 0.0) + max(rest, 0.0)
        self._mark = now


@dataclass(frozen=True)
class Row:
    """One solve."""

    program: str
    problem: str
    degree: int
    size: str
    unknowns: int
    error: float
    seconds: Mapping[str, float]

    @property
    def total(self) -> float:
        """Seconds of all phases."""
        return sum(self.seconds.values())


@dataclass(frozen=True)
class Reached:
    """What one program needs for a tolerance: the fastest way, and the one of fewest unknowns."""

    seconds: float
    degree: int
    unknowns: float
    fewest_unknowns: float

    def __str__(self) -> str:
        fastest = f"{self.seconds:.3f} s / {self.unknowns:.0f}"
        return f"{fastest} (p={self.degree}; fewest {self.fewest_unknowns:.0f})"


def crossing(rows: Sequence[Row], tolerance: float) -> tuple[float, float] | None:
    """Seconds and unknowns at which the errors of one degree, coarse to fine, first pass `tolerance`.

    Interpolated linearly between logarithms; None when the tolerance is not reached.
    """
    for before, after in zip([None, *rows], rows, strict=False):
        if after.error > tolerance:
            continue
        if before is None:
            return after.total, float(after.unknowns)
        t = math.log(before.error / tolerance) / math.log(before.error / after.error)
        blend = lambda a, b, t=t: math.exp((1 - t) * math.log(a) + t * math.log(b))  # noqa: E731
        return blend(before.total, after.total), blend(before.unknowns, after.unknowns)
    return None


def reached(rows: Iterable[Row], tolerance: float) -> Reached | None:
    """Best over the degrees of what is needed for `tolerance`; None when no degree reaches it."""
    series: dict[int, list[Row]] = {}
    for row in rows:
        series.setdefault(row.degree, []).append(row)
    found = [(point, degree) for degree, part in series.items() if (point := crossing(part, tolerance))]
    if not found:
        return None
    (seconds, unknowns), degree = min(found)
    return Reached(seconds, degree, unknowns, min(point[1] for point, _ in found))
