"""The summary of a run, what was expected of it, and what was missed."""

from __future__ import annotations

import resource
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rfm.app.case import Case
from rfm.app.quantities import integrals, probes

if TYPE_CHECKING:
    from solvers.solution import Solution

PHASES = ("geometry", "quadrature", "assembly", "solve")


@dataclass(frozen=True)
class Miss:
    """An expectation of the case that the result does not meet."""

    key: str
    got: float | None
    wanted: str

    def __str__(self) -> str:
        got = "nothing" if self.got is None else f"{self.got:.6g}"
        return f"{self.key}: expected {self.wanted}, got {got}"


def summarise(case: Case, solution: Solution) -> dict[str, Any]:
    """Everything worth a number about a solution, as plain JSON values.

    Parameters
    ----------
    case, solution
        What was asked for and what came out.
    """
    from solvers.measures import measure
    from solvers.norms import all_boundary_errors

    problem, trial, background = solution.problem, solution.trial, solution.background
    measures = measure(solution.pieces)
    norms = measures.norms
    seconds = {phase: round(solution.seconds.get(phase, 0.0), 6) for phase in PHASES}
    linear = solution.linear
    return {
        "case": case.name,
        "title": case.title,
        "status": "done",
        "dimension": problem.domain.dimension,
        "degree": trial.degree,
        "basis": solution.discretization.basis,
        "grid": int(max(background.grid.cells)),
        "cells": [int(n) for n in background.grid.cells],
        "dofs": solution.dofs,
        "relative_l2_error": norms.l2 if norms else None,
        "relative_h1_error": norms.h1 if norms else None,
        "relative_max_error": norms.maximum if norms else None,
        "relative_energy_error": measures.energy_norm,
        "boundary_error": all_boundary_errors(solution.pieces),
        "energy": measures.energy if problem.equation.symmetric and not problem.oblique else None,
        "linear": {
            "method": linear.method,
            "reason": linear.reason,
            "residual": linear.residual,
            "iterations": linear.iterations,
            "condition": linear.condition,
        },
        "probes": probes(case, solution),
        "integrals": integrals(case, solution),
        "corners": [dict(one) for one in solution.intensities],
        "seconds": seconds,
        "peak_memory_mb": round(peak_memory_mb(), 1),
        "memory_per_unknown": {
            "solver": linear.nbytes and round(linear.nbytes / solution.dofs),
            "peak": round(peak_memory_mb() * 2**20 / solution.dofs),
        },
    }


def peak_memory_mb() -> float:
    """Largest resident memory of this process so far, in megabytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)


def misses(case: Case, summary: Mapping[str, Any]) -> list[Miss]:
    """Expectations of the case that `summary` does not meet.

    A limit on a mapping (``boundary_error``) holds for each of its values.
    """
    found = []
    for key, expected in case.expect.items():
        for name, got in _numbers(key, summary):
            if expected.limit is not None:
                if got is None or not got <= expected.limit:
                    found.append(Miss(name, got, f"at most {expected.limit:.6g}"))
            elif got is None or not abs(got - (expected.value or 0.0)) <= (expected.tolerance or 0.0):
                found.append(Miss(name, got, f"{expected.value:.10g} within {expected.tolerance:.3g}"))
    return found


def _numbers(key: str, summary: Mapping[str, Any]) -> list[tuple[str, float | None]]:
    """The numbers a key stands for: one, or all those below it."""
    value = _lookup(key.split("."), summary)
    if isinstance(value, Mapping):
        return [pair for name in value for pair in _numbers(f"{key}.{name}", summary)]
    if isinstance(value, list):
        return [(f"{key}.{i}", float(item)) for i, item in enumerate(value)]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return [(key, None)]
    return [(key, float(value))]


def _lookup(names: list[str], value: Any) -> Any:
    """Value at a dotted path; names of parts and probes may themselves contain dots."""
    if not names:
        return value
    if isinstance(value, list) and names[0].isdigit() and int(names[0]) < len(value):
        return _lookup(names[1:], value[int(names[0])])
    if isinstance(value, Mapping):
        for count in range(len(names), 0, -1):
            head = ".".join(names[:count])
            if head in value:
                return _lookup(names[count:], value[head])
    return None
