"""WEB-splines of degree k with spline R-functions of bidegree k as weights: orders k + 1 and k on an intersection and
on a union, u = weight times a smooth function with the load in the weak form."""

import numpy as np
import pytest

from rfm.calculus import RSpline, Value, derivatives, exp, sin
from rfm.errors import DiscretizationError
from rfm.geometry import disk
from rfm.geometry.shape import Shape
from rfm.geometry.weight import weight as weight_of
from solvers import ritz
from solvers.equations.energy import Energy
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms
from solvers.problem import Clamped, Dirichlet, Discretization, Problem

ONE, OTHER = disk((0, 0), 1.0), disk((0.8, 0), 1.0)


def lens(x: Value, y: Value) -> Value:
    """Product of the two disks' polynomials."""
    return (1 - x * x - y * y) * (1 - (x - 0.8) ** 2 - y * y)


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


def test_a_weight_can_be_a_system_or_a_function() -> None:
    """Other ordinates than those of the groups, and a weight of one's own: the same as by name."""
    domain = ONE & OTHER
    problem = Problem(domain, Poisson(source=1.0), (Dirichlet(domain.part("all"), 0.0),))
    x, y = np.array([0.1, 0.4, 0.6]), np.array([0.3, -0.5, 0.0])

    def solved(weight):  # type: ignore[no-untyped-def]
        # the same rules for all: those of a function would be folded where it is smooth
        rules = Discretization(degree=2, grid=12, weight=weight, moment_fitting=False)
        return ritz.solve(problem, rules).trial.values(np.stack([x, y], -1))

    named = solved("spline2")
    own = RSpline(2, (0.25, 0.5, 1.0), (-1.0, -1.5, -2.0), -1.0)  # those of group 1, doubled
    np.testing.assert_allclose(solved(own), named, rtol=1e-9)
    np.testing.assert_allclose(solved(lens), named, rtol=1e-9)


def test_values_on_several_parts_with_a_weight_of_ones_own() -> None:
    domain = ONE.named("one") & OTHER.named("other")
    left, right = domain.part("one"), domain.part("other")
    conditions = (Dirichlet(left, lambda x, y: x + 0 * y), Dirichlet(right, lambda x, y: 2 * x + 0 * y))
    problem = Problem(domain, Poisson(source=0.0), conditions)
    solution = ritz.solve(problem, Discretization(degree=2, grid=12, weight=lens))
    on_boundary = np.array([[1.0, 0.0], [-0.2, 0.0], [0.8, 0.6]])
    np.testing.assert_allclose(solution.trial.values(on_boundary), [1.0, -0.4, 0.8], atol=1e-12)


def test_a_function_cannot_hold_slopes() -> None:
    problem = Problem(ONE, Plate(), (Clamped(ONE.part("all")),))
    with pytest.raises(DiscretizationError, match="serves prescribed values, not slopes: give the name"):
        ritz.solve(problem, Discretization(degree=3, grid=8, weight=lambda x, y: 1 - x * x - y * y))


def sine(x: Value, y: Value) -> Value:
    """Solution of Example 4.1."""
    rho = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return sin((0.16 - rho) * (0.01 - rho))


@pytest.mark.parametrize(
    ("weight", "k", "grids", "order"),
    [("r0", 1, (51, 102), 2), ("r0", 2, (51, 102), 3), ("spline3", 3, (51, 102), 4)],
)
def test_orders_on_the_annulus_of_example_4_1(
    weight: str, k: int, grids: tuple[int, ...], order: int
) -> None:
    ring = disk((0.5, 0.5), 0.4) - disk((0.5, 0.5), 0.1)
    problem = Problem(ring, Poisson(source=None), (Dirichlet(ring.part("all"), 0.0),), sine)
    found = []
    for grid in grids:
        solution = ritz.solve(problem, Discretization(degree=k, grid=grid, weight=weight))
        found.append(error_norms(solution.trial, sine, solution.background).l2)
    assert np.log2(found[0] / found[1]) == pytest.approx(order, abs=0.2), found


def test_weights_that_kink_across_the_boundary_have_positive_rules_only() -> None:
    """Folded rules have nodes outside; with them the error stalled at 2e-8."""
    ring = disk((0.5, 0.5), 0.4) - disk((0.5, 0.5), 0.1)
    problem = Problem(ring, Poisson(source=None), (Dirichlet(ring.part("all"), 0.0),), sine)
    solution = ritz.solve(problem, Discretization(degree=2, grid=51, weight="spline2"))
    assert solution.background.folded is None
    assert error_norms(solution.trial, sine, solution.background).l2 < 2e-8
    assert ritz.solve(problem, Discretization(degree=2, grid=12, weight="r0")).background.folded is not None
