"""WEB-splines of degree k with spline R-functions of bidegree k as weights: orders k + 1 and k on an intersection and
on a union, u = weight times a smooth function with the load in the weak form."""

import numpy as np
import pytest

from rfm.calculus import Value, derivatives, exp, sin
from rfm.geometry import disk
from rfm.geometry.shape import Shape
from rfm.geometry.weight import weight as weight_of
from solvers import ritz
from solvers.equations.energy import Energy
from solvers.norms import error_norms
from solvers.problem import Dirichlet, Discretization, Problem

ONE, OTHER = disk((0, 0), 1.0), disk((0.8, 0), 1.0)


def errors(domain: Shape, weight: str, k: int, grids: tuple[int, ...]) -> np.ndarray:
    w = weight_of(domain, domain.part("all"), weight)

    def exact(x: Value, y: Value) -> Value:
        return w(x, y) * exp(0.5 * x) * sin(2 * y + x + 1)

    last: dict[str, Value] = {"x": None}

    def density(x: Value, y: Value, u: Value) -> Value:
        if last["x"] is not x:
            last.update(x=x, slopes=derivatives(exact, (x, y), 1)[1:])
        along, across = last["slopes"]
        return 0.5 * (u.x * u.x + u.y * u.y) - along * u.x - across * u.y

    problem = Problem(domain, Energy(density), (Dirichlet(domain.part("all"), 0.0),), exact)
    found = []
    for n in grids:
        solution = ritz.solve(problem, Discretization(degree=k, grid=n, weight=weight))
        norms = error_norms(solution.trial, exact, solution.background)
        found.append((norms.l2, norms.h1))
    return np.array(found).T


@pytest.mark.parametrize("k", [1, 2, 3])
@pytest.mark.parametrize("name", ["intersection", "union"])
def test_orders(name: str, k: int) -> None:
    domain = {"intersection": ONE & OTHER, "union": ONE | OTHER}[name]
    l2, h1 = errors(domain, f"spline{k}", k, (24, 48))
    assert np.log2(l2[0] / l2[1]) == pytest.approx(k + 1, abs=0.2)
    assert np.log2(h1[0] / h1[1]) == pytest.approx(k, abs=0.12)
    assert l2[1] < {1: 2.5e-3, 2: 3e-5, 3: 6e-7}[k]


@pytest.mark.parametrize("group", [2, 3, 4, 5, 6])
def test_groups_differ_by_little(group: int) -> None:
    (error,), _ = errors(ONE | OTHER, f"spline2:group{group}:bound2", 2, (16,))
    (default,), _ = errors(ONE | OTHER, "r0", 2, (16,))
    assert 0.5 < error / default < 2.0
