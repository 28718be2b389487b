"""rfm up to 1e6 unknowns at low degree: how time and memory grow with the unknowns."""

from __future__ import annotations

from collections.abc import Mapping

from benchmarks.problems import Problem
from benchmarks.programs.rfm_program import solve, versions
from benchmarks.record import Configuration

__all__ = ["series", "solve", "versions"]

CELLS = {2: (32, 64, 128, 256, 512, 1024, 1536), 3: (12, 16, 24, 32, 48, 64, 96, 128)}
DEGREES = {2: (2, 3), 3: (2,)}


def series(problem: Problem) -> Mapping[str, list[Configuration]]:
    """Uniform refinement of Poisson's equation; an annulus fills half its box, a ball too."""
    if problem.equation != "poisson":
        return {}
    return {
        f"p={degree}": [{"degree": degree, "cells": n} for n in CELLS[problem.dimension]]
        for degree in DEGREES[problem.dimension]
    }
