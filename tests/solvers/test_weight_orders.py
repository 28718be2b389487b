"""What the smoothness of a weight costs: orders in L2 on an annulus, with data of its own and a generic solution.

A plateau 1 - max(0, 1 - dist/delta)^gamma leaves a kink in psi: order min(p + 1, gamma + 1/2, 2 gamma - 1), as soon as
the mesh is finer than the strip.  A scaled weight is as smooth as the weight it is made of.
"""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import exp, sin
from rfm.geometry import disk
from solvers import ritz
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms
from solvers.problem import Dirichlet, Discretization, Problem

ANNULUS = disk(center=(0.5, 0.5), radius=0.4).named("outer") - disk(center=(0.5, 0.5), radius=0.1).named(
    "inner"
)


def data(x, y):
    return exp(x) * sin(y)


def solution(x, y):
    s = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return data(x, y) + 50.0 * (0.16 - s) * (s - 0.01) * exp(x) * sin(3 * y)


PROBLEM = Problem(ANNULUS, Poisson(source=None), (Dirichlet(ANNULUS.part("all"), data),), solution)


def order(degree: int, weight: str, grids: tuple[int, ...]) -> float:
    errors = []
    for grid in grids:
        found = ritz.solve(PROBLEM, Discretization(degree=degree, grid=grid, weight=weight))
        errors.append(error_norms(found.trial, solution, found.background).l2)
    return float(-np.polyfit(np.log(grids), np.log(errors), 1)[0])


@pytest.mark.parametrize(
    ("degree", "weight", "grids", "expected", "above"),
    [
        (1, "scaled:beta5:alpha2", (48, 64, 96), 2.0, 0.15),
        (2, "scaled:beta1:alpha2", (64, 96, 128), 3.0, 0.15),
        (2, "plateau:delta0.05:gamma3", (64, 80, 96), 3.0, 0.5),  # still approaching from above
        (2, "plateau:delta0.05:gamma2", (48, 64, 80, 96), 2.5, 0.15),
        (3, "plateau:delta0.08:gamma2", (32, 48, 64, 96), 2.5, 0.15),
    ],
)
def test_order(degree: int, weight: str, grids: tuple[int, ...], expected: float, above: float) -> None:
    assert expected - 0.15 < order(degree, weight, grids) < expected + above
