"""The programs compared, one module each with the same three functions.

``series(problem)`` gives configurations coarse to fine by the name of a series, none for a problem that the program
cannot solve; ``solve(problem, configuration, laps)`` solves once; ``versions()`` says what ran.  A module imports its
program, so it is loaded only where that is installed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Protocol

from benchmarks.problems import Problem
from benchmarks.record import Answer, Configuration, Laps

Series = Mapping[str, Sequence[Configuration]]

MODULES = {
    "rfm": "rfm_program",
    "rfm, large": "rfm_large",
    "scikit-fem": "scikit_fem",
    "NGSolve": "ngsolve_program",
    "ngsxfem": "ngsxfem",
    "nutils": "nutils_program",
}
"""Modules by the names of the programs."""


class Program(Protocol):
    """What a module of a program has."""

    def series(self, problem: Problem) -> Series:
        """Configurations, coarse to fine."""

    def solve(self, problem: Problem, configuration: Configuration, laps: Laps) -> Answer:
        """Solve once."""

    def versions(self) -> Mapping[str, str]:
        """Versions of what ran."""


def load(name: str) -> Program:
    """Import the module of a program.

    Raises
    ------
    ImportError
        The program is not installed.
    """
    program: Program = import_module(f"benchmarks.programs.{MODULES[name]}")  # type: ignore[assignment]
    return program


def refined(key: str, start: float, factor: float, count: int, **fixed: object) -> list[Configuration]:
    """Configurations with ``start / factor^i`` under `key`, and `fixed` the same in all."""
    return [{**fixed, key: start / factor**i} for i in range(count)]
