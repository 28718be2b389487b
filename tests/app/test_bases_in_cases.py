"""The bases in case files: names and degrees, refusals, memory, a run that is written and read."""

from __future__ import annotations

import numpy as np
import pytest

import rfm
from rfm.app.build import build_discretization, build_domain
from rfm.app.case import load_case
from rfm.app.catalogue import TOPICS
from rfm.app.memory import required_bytes
from rfm.app.schema import discretization
from rfm.errors import CaseError, RfmError
from solvers.bases.registry import BASES

CASE = {
    "rfm": 1,
    "geometry": {"shapes": {"d": {"disk": {"center": [0, 0], "radius": 1}}}, "domain": "d"},
    "equation": {"poisson": {"source": "from exact"}},
    "boundary_conditions": [{"on": "all", "dirichlet": "from exact"}],
    "exact": "exp(x)*sin(2*y)",
    "discretization": {"basis": "legendre", "degree": 8, "grid": 4},
}


def changed(**values):
    return load_case(CASE, {f"discretization.{key}": value for key, value in values.items()})


def test_the_schema_knows_the_bases_and_their_degrees():
    assert {name: basis.degrees for name, basis in BASES.items()} == discretization.BASES
    assert [row[0] for row in TOPICS["bases"].rows()] == list(BASES)


@pytest.mark.parametrize("name", BASES)
def test_degrees_are_those_of_the_basis(name):
    highest = BASES[name].degrees[1]
    assert changed(basis=name, degree=highest).discretization.degree == highest
    with pytest.raises(CaseError, match=f"must be from 1 to {highest}, got {highest + 1}") as caught:
        changed(basis=name, degree=highest + 1)
    assert f"basis: {name}" in str(caught.value)


def test_degrees_of_a_study_are_those_of_the_basis():
    assert load_case(CASE, {"study": {"degree": [4, 20]}}).study.degree == (4, 20)
    with pytest.raises(CaseError, match=r"study\.degree: must be from 1 to 8, got 20"):
        load_case(CASE, {"study": {"degree": [4, 20]}, "discretization.basis": "b-spline"})


def test_a_wrong_basis_is_the_only_complaint():
    with pytest.raises(RfmError, match="did you mean 'legendre'") as caught:
        changed(basis="legendr", degree=30)
    assert "degree" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "degree"), [("legendre", 8), ("trigonometric", 5), ("radial", 2), ("b-spline", 3)]
)
def test_a_run_is_written_and_read(name, degree, tmp_path):
    run = rfm.solve(changed(basis=name, degree=degree, grid=8))
    assert run.summary["basis"] == name
    run.save(tmp_path / "run")
    loaded = rfm.load(tmp_path / "run")
    points = np.array([[0.1, 0.2], [-0.5, 0.3], [0.0, -0.9]])
    assert np.array_equal(loaded.u(points), run.u(points))
    assert np.array_equal(loaded.gradient(points), run.gradient(points))
    assert np.abs(run.u(points) - np.exp(points[:, 0]) * np.sin(2 * points[:, 1])).max() < 1e-2


def test_the_memory_of_a_dense_matrix_counts():
    needed = []
    for degree in (10, 40):
        case = changed(degree=degree)
        domain = build_domain(case)
        needed.append(required_bytes(domain, build_discretization(case, domain)))
    assert needed[1] - needed[0] > 8 * (41**4 - 11**4)
