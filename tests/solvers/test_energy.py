"""Equations from a density that somebody wrote: the same as those that are built in, and the example of the docs."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.errors import RfmError
from rfm.geometry import disk
from solvers import ritz
from solvers.equations.elasticity import Elasticity
from solvers.equations.energy import Energy
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.equations.rows import apply
from solvers.exact import exact_jet
from solvers.measures import measure
from solvers.problem import FROM_EXACT, Clamped, Dirichlet, Discretization, Neumann, Problem, Robin, Traction

DISK = disk(center=(0, 0), radius=1).named("disk")
RING = DISK - disk(center=(0, 0), radius=0.4).named("hole")
DOCS = Path(__file__).parents[2] / "docs" / "equations.md"


def conductivity(x, y):
    return 1 + x * x


def diffusion(x, y, u):
    return 0.5 * conductivity(x, y) * (u.x**2 + u.y**2) + 0.5 * u.value**2 - exp(x) * u.value


def elastic(x, y, u):
    first, shear = 0.3 / (1 - 0.09), 1 / 2.6
    a, b = u
    strain = a.x**2 + b.y**2 + 0.5 * (a.y + b.x) ** 2
    return 0.5 * first * (a.x + b.y) ** 2 + shear * strain


def bending(x, y, u):
    return 0.5 * (1 + x * y) * (u.xx**2 + u.yy**2 + 0.6 * u.xx * u.yy + 1.4 * u.xy**2)


def exact(x, y):
    return exp(x) * sin(2 * y + 0.3) + x * x * y


def other(x, y):
    return cos(x - y) + x * y


TWINS = [
    (Energy(diffusion), Poisson(lambda x, y: exp(x), conductivity, 1.0), exact),
    (Energy(elastic, count=2), Elasticity(), (exact, other)),
    (Energy(bending, order=2), Plate(lambda x, y: 1 + x * y, 0.3, 0.0), exact),
]


@pytest.mark.parametrize(("written", "built", "truth"), TWINS)
def test_density_and_residual_are_those_of_the_equation(written, built, truth):
    coords = list(np.random.default_rng(0).uniform(-0.5, 0.5, (2, 7)))
    first, second = (equation.density(coords, None) for equation in (written, built))
    for name in ("hessian", "linear"):
        mine, theirs = getattr(first, name), getattr(second, name)
        for key in mine.keys() | theirs.keys():
            np.testing.assert_allclose(mine.get(key, 0.0), theirs.get(key, 0.0), atol=1e-12)
    jet = exact_jet(truth, coords, built.strong_order)
    for (row, right), (known, wanted) in zip(
        written.residual(coords, None), built.residual(coords, None), strict=True
    ):
        np.testing.assert_allclose(apply(row, jet) - right, apply(known, jet) - wanted, atol=1e-10)


def test_natural_conditions_and_a_source_from_the_exact_solution():
    def density(x, y, u):
        return 0.5 * conductivity(x, y) * (u.x**2 + u.y**2)

    for conditions in (
        (Dirichlet(RING.part("disk"), FROM_EXACT), Robin(RING.part("hole"), 2.0, FROM_EXACT)),
        (Dirichlet(RING.part("hole"), FROM_EXACT), Neumann(RING.part("disk"), FROM_EXACT)),
    ):
        problem = Problem(RING, Energy(density, source_from_exact=True), conditions, exact=exact)
        solution = ritz.solve(problem, Discretization(degree=4, grid=16))
        assert measure(solution.pieces).norms.l2 < 1e-6


def test_a_vector_and_a_plate():
    conditions = (Dirichlet(RING.part("disk"), FROM_EXACT), Traction(RING.part("hole"), FROM_EXACT))
    vector = Problem(RING, Energy(elastic, count=2, source_from_exact=True), conditions, exact=(exact, other))
    plate = Problem(
        RING,
        Energy(bending, order=2, source_from_exact=True),
        (Clamped(RING.part("all"), FROM_EXACT, FROM_EXACT),),
        exact=exact,
    )
    for problem in (vector, plate):
        solution = ritz.solve(problem, Discretization(degree=4, grid=16))
        assert measure(solution.pieces).norms.l2 < 1e-5


def test_a_density_that_is_not_quadratic_is_refused():
    problem = Problem(RING, Energy(lambda x, y, u: u.x**4 + u.y**2), (Dirichlet(RING.part("all"), 0.0),))
    with pytest.raises(RfmError, match="not quadratic"):
        ritz.solve(problem, Discretization(degree=2, grid=8))


def test_orders_and_components_that_are_not_supported_are_refused():
    with pytest.raises(RfmError, match="scalars have order 1 or 2"):
        Energy(diffusion, order=3)


def test_the_example_of_the_docs_runs():
    (program,) = re.findall(r"```python\n(.*?)```", DOCS.read_text(), re.DOTALL)
    assert (
        sum(bool(line.strip()) for line in program.splitlines() if not line.startswith(("from", "import")))
        <= 10
    )
    names: dict[str, object] = {}
    exec(program, names)
    assert float(names["middle"]) > 0
