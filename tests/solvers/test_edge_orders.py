"""Orders in space where two curved faces meet in sharp edges: a ball without a cylinder through it."""

from __future__ import annotations

import math

import pytest

from benchmarks.problems import problem
from benchmarks.programs.rfm_program import pose
from solvers import ritz
from solvers.norms import error_norms
from solvers.problem import Discretization


def error(degree: int, cells: int) -> float:
    stated = pose(problem("ball minus cylinder"))
    solution = ritz.solve(stated, Discretization(degree=degree, grid=cells))
    assert solution.background.rules.unresolved == 0.0
    assert stated.exact is not None
    return error_norms(solution.trial, stated.exact, solution.background).l2


@pytest.mark.parametrize(
    ("degree", "cells"),
    [
        (4, (8, 10)),
        pytest.param(2, (24, 32), marks=pytest.mark.slow),
        pytest.param(3, (16, 24), marks=pytest.mark.slow),
        pytest.param(4, (12, 16), marks=pytest.mark.slow),
    ],
)
def test_sharp_edges_keep_the_order(degree: int, cells: tuple[int, int]) -> None:
    # On grids that a test can afford the order comes down to p + 1 from above (docs/quadrature.md).
    errors = [error(degree, n) for n in cells]
    order = math.log(errors[0] / errors[1]) / math.log(cells[1] / cells[0])
    assert degree + 0.85 < order < degree + 2.2
