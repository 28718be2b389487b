"""Quantities derived from a solution: stresses of an elastic body, moments of a plate."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.types import Array, Field, Value

if TYPE_CHECKING:
    from rfm.app.record import PointFunction
    from solvers.exact import Exact
    from solvers.problem import Problem
    from solvers.solution import Trial


def derived(problem: Problem, trial: Trial, points: Array) -> dict[str, dict[str, Array]]:
    """Derived quantities of a field at points (n, d) by kind and name, each of shape (n,)."""
    where = np.atleast_2d(np.asarray(points, dtype=float))
    equation = problem.equation
    jet = trial.at(where, equation.order)
    found = equation.derived(list(where.T), jet)
    for inclusion in problem.inclusions:
        inside = np.asarray(inclusion.region.membership(*where.T)) >= 0
        own = inclusion.equation.derived(list(where.T), jet)
        found = {
            kind: {name: np.where(inside, own[kind][name], values) for name, values in parts.items()}
            for kind, parts in found.items()
        }
    return found


def pictured(problem: Problem, trial: Trial) -> dict[str, PointFunction]:
    """Derived quantities that files and pictures show beside the solution, by name."""
    return {name: partial(_one, problem, trial, name) for name in problem.equation.pictured}


def _one(problem: Problem, trial: Trial, name: str, points: Array) -> Array:
    return next(values[name] for values in derived(problem, trial, points).values() if name in values)


def everywhere(problem: Problem) -> Exact | None:
    """The exact solution at points of all materials."""
    from solvers.exact import components_of

    if problem.exact is None or not problem.inclusions:
        return problem.exact
    parts = [(i.region.membership, components_of(i.exact)) for i in problem.inclusions if i.exact is not None]
    fields = tuple(
        _Pieces(component, tuple((inside, own[c]) for inside, own in parts))
        for c, component in enumerate(components_of(problem.exact))
    )
    return fields if len(fields) > 1 else fields[0]


@dataclass(frozen=True, eq=False)
class _Pieces:
    """A field that is another one in some regions."""

    rest: Field
    parts: tuple[tuple[Field, Field], ...]

    def __call__(self, *coords: Value) -> Value:
        """Values at arrays of coordinates."""
        value = self.rest(*coords)
        for inside, own in self.parts:
            value = np.where(np.asarray(inside(*coords)) >= 0, own(*coords), value)
        return value
