"""Poisson's equation by rfm: Ritz with WEB-splines on a uniform grid, called as by a user of the packages."""

from __future__ import annotations

from problems import Benchmark
from record import Laps, Row

from solvers import ritz
from solvers.norms import error_norms
from solvers.problem import Discretization


def solve(benchmark: Benchmark, degree: int, grid: int, laps: Laps) -> Row:
    """Build the shape and solve once; the error is computed outside the time."""
    problem = benchmark.problem()
    laps.lap("geometry")
    solution = ritz.solve(problem, Discretization(degree=degree, grid=grid))
    laps.split(solution.seconds)
    error = error_norms(solution.trial, benchmark.exact, solution.background).l2
    return Row("rfm", benchmark.name, degree, str(grid), solution.dofs, error, laps.seconds)
