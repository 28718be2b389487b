"""Quantities derived from a solution: stresses of an elastic body, moments of a plate."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.types import Array

if TYPE_CHECKING:
    from rfm.app.record import PointFunction
    from solvers.solution import Solution


def derived(solution: Solution, points: Array) -> dict[str, dict[str, Array]]:
    """Derived quantities at points (n, d) by kind and name, each of shape (n,)."""
    where = np.atleast_2d(np.asarray(points, dtype=float))
    equation = solution.problem.equation
    return equation.derived(list(where.T), solution.trial.at(where, equation.order))


def pictured(solution: Solution) -> dict[str, PointFunction]:
    """Derived quantities that files and pictures show beside the solution, by name."""
    return {name: partial(_one, solution, name) for name in solution.problem.equation.pictured}


def _one(solution: Solution, name: str, points: Array) -> Array:
    return next(values[name] for values in derived(solution, points).values() if name in values)
