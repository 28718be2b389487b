"""Cases of elasticity and of plates: what may be written, what is refused and why, and what is stored."""

from __future__ import annotations

import json

import numpy as np
import pytest

import rfm
from rfm.app.build import build_problem
from rfm.app.case import load_case
from rfm.app.schema.conditions import KINDS_OF
from rfm.errors import CaseError
from solvers.problem import FROM_EXACT, Clamped, Dirichlet, Free, Pressure, SimplySupported, Slip, Traction

BODY = {
    "rfm": 1,
    "title": "A body",
    "geometry": {
        "shapes": {
            "plate": {"rectangle": {"min": [0, 0], "max": [2, 1]}},
            "hole": {"disk": {"center": [1, 0.5], "radius": 0.2}},
        },
        "domain": "plate - hole",
    },
    "equation": {"elasticity": {"model": "plane_stress", "young_modulus": 10, "poisson_ratio": 0.3}},
    "boundary_conditions": [
        {"on": "plate.left", "dirichlet": [0, None]},
        {"on": "plate.bottom", "dirichlet": [None, "from exact"]},
        {"on": "plate.right", "traction": "from exact"},
        {"on": "plate.top", "traction": ["x", 0]},
        {"on": "hole", "pressure": 1},
    ],
    "exact": ["x*y", "y^2"],
    "discretization": {"degree": 2, "grid": 12},
}
PLATE = {
    **BODY,
    "equation": {"plate": {"load": "from exact"}},
    "boundary_conditions": [
        {"on": "plate.left", "clamped": True},
        {"on": "plate.right", "clamped": {"value": 0, "slope": "x"}},
        {"on": "plate.top", "simply_supported": "from exact"},
        {"on": "rest", "free": {"shear": 2}},
    ],
    "exact": "x^2*y",
}


def changed(case, **sections):
    return {**case, **sections}


def test_conditions_of_a_body():
    problem = build_problem(load_case(BODY))
    left, bottom, right, top, hole = problem.conditions
    assert isinstance(left, Dirichlet)
    assert left.value == (0.0, None)
    assert bottom.value == (None, FROM_EXACT)
    assert isinstance(right, Traction)
    assert right.traction is FROM_EXACT
    assert top.traction[0](3.0, 0.0) == 3.0
    assert isinstance(hole, Pressure)
    assert problem.exact[1](0.0, 3.0) == 9.0
    assert problem.equation.body_force == (0.0, 0.0)


def test_conditions_of_a_plate():
    problem = build_problem(load_case(PLATE))
    left, right, top, rest = problem.conditions
    assert (type(left), type(right)) == (Clamped, Clamped)
    assert right.slope(3.0, 0.0) == 3.0
    assert isinstance(top, SimplySupported)
    assert (top.value, top.moment) == (FROM_EXACT, FROM_EXACT)
    assert isinstance(rest, Free)
    assert (rest.moment, rest.shear) == (0.0, 2.0)


def test_slip():
    conditions = [{"on": "hole", "slip": True}, {"on": "plate", "dirichlet": 0}]
    slip, held = build_problem(load_case(changed(BODY, boundary_conditions=conditions))).conditions
    assert isinstance(slip, Slip)
    assert held.value == 0.0


@pytest.mark.parametrize("case", [BODY, PLATE])
def test_a_resolved_case_is_read_again(case):
    resolved = load_case(case).to_dict()
    again = load_case(json.loads(json.dumps(resolved)))
    assert again.to_dict() == resolved
    assert [type(c) for c in build_problem(again).conditions] == [
        type(c) for c in build_problem(load_case(case)).conditions
    ]


REFUSED = [
    (BODY, {"exact": "x"}, "exact: must be a list with one entry for each coordinate"),
    (PLATE, {"exact": ["x", "y"]}, "exact: must be one expression"),
    (BODY, {"boundary_conditions": [{"on": "all", "neumann": 0}]}, "elasticity has no condition neumann"),
    (BODY, {"boundary_conditions": [{"on": "all", "dirichlet": [0, 0, 0]}]}, "must have 2 components, got 3"),
    (
        BODY,
        {"boundary_conditions": [{"on": "all", "dirichlet": [None, None]}]},
        "leaves every component free",
    ),
    (BODY, {"boundary_conditions": [{"on": "all", "traction": 1}]}, "must be a list with one entry"),
    (BODY, {"boundary_conditions": [{"on": "all", "slip": False}]}, "must be true"),
    (
        PLATE,
        {"boundary_conditions": [{"on": "all", "dirichlet": 0}]},
        "a plate needs two conditions at every point",
    ),
    (PLATE, {"boundary_conditions": [{"on": "plate", "clamped": True}]}, "no condition on hole"),
    (
        PLATE,
        {"boundary_conditions": [{"on": "all", "clamped": True, "free": True}]},
        "has clamped and free; a condition is only one of them",
    ),
    (
        PLATE,
        {"boundary_conditions": [{"on": "all", "clamped": True}, {"on": "hole", "free": True}]},
        "conditions 0 and 1 overlap on hole",
    ),
    (PLATE, {"boundary_conditions": [{"on": "all", "clamped": False}]}, "must be true, 'from exact' or"),
    (PLATE, {"boundary_conditions": [{"on": "all", "clamped": {"moment": 1}}]}, "unknown key 'moment'"),
    (PLATE, {"discretization": {"degree": 1, "grid": 8}}, "use degree 2 or more"),
    (
        BODY,
        {"equation": {"elasticity": {**BODY["equation"]["elasticity"], "model": "three_dimensional"}}},
        "use plane",
    ),
    (
        BODY,
        {"equation": {"elasticity": {**BODY["equation"]["elasticity"], "poisson_ratio": 0.5}}},
        "below 0.5, got 0.5",
    ),
    (
        BODY,
        {"equation": {"elasticity": {**BODY["equation"]["elasticity"], "young_modulus": -1}}},
        "must be positive",
    ),
    (BODY, {"equation": {**BODY["equation"], **PLATE["equation"]}}, "has elasticity and plate"),
    (BODY, {"equation": {}}, "needs an equation, one of: poisson, elasticity, plate"),
    (BODY, {"equation": {"elastic": {}}}, "did you mean 'elasticity'"),
    (BODY, {"integrals": {"a": {"on": "domain", "of": "u"}}}, "the unknown of elasticity is ux, uy"),
    (PLATE, {"integrals": {"a": {"on": "domain", "of": "ux"}}}, "the unknown of plate is u"),
]


@pytest.mark.parametrize(("case", "change", "message"), REFUSED, ids=[message for *_, message in REFUSED])
def test_mistakes_are_refused(case, change, message):
    with pytest.raises(CaseError) as caught:
        rfm.solve(changed(case, **change))
    assert message in str(caught.value)


def test_every_kind_of_condition_belongs_to_an_equation():
    assert set(KINDS_OF) == {"poisson", "elasticity", "plate"}


def test_a_free_edge_by_structure_needs_degree_five():
    case = {
        **PLATE,
        "discretization": {"degree": 4, "grid": 12},
        "solver": {"conditions": "exact"},
        "boundary_conditions": [{"on": "all", "free": True}],
    }
    with pytest.raises(
        CaseError, match=r"discretization\.degree: .*order 5 of the spline: use degree 5 or more .* got 4"
    ):
        rfm.solve(case)


def test_a_body_is_solved_stored_and_loaded(tmp_path):
    exact = ["0.1*x*(1+y)", "0.2*y*x"]
    case = changed(
        BODY,
        equation={"elasticity": {**BODY["equation"]["elasticity"], "body_force": "from exact"}},
        boundary_conditions=[
            {"on": "plate.left", "dirichlet": "from exact"},
            {"on": "rest", "traction": "from exact"},
        ],
        exact=exact,
        discretization={"degree": 4, "grid": 16},
        probes={"A": [2, 1]},
        integrals={"load": {"on": "plate.right", "of": "flux"}, "mean": {"on": "domain", "of": "ux + 0*uy"}},
        expect={"relative_l2_error": 1e-3, "probes.A.stress.xx": {"value": 3.5165, "tolerance": 0.02}},
    )
    run = rfm.solve(case)
    assert not run.result.misses, run.result.misses
    assert len(run.summary["integrals"]["load"]) == 2
    np.testing.assert_allclose(run.summary["probes"]["A"]["u"], [0.4, 0.4], atol=1e-3)
    assert set(run.summary["probes"]["A"]["stress"]) == {"xx", "xy", "yy", "von_mises"}
    files = run.save(tmp_path / "run")
    points = np.array([[0.1, 0.2], [1.7, 0.9]])
    loaded = rfm.load(files["solution"])
    assert run.u(points).shape == (2, 2)
    assert run.gradient(points).shape == (2, 2, 2)
    np.testing.assert_array_equal(loaded.u(points), run.u(points))
    np.testing.assert_array_equal(loaded.gradient(points), run.gradient(points))
    report = (tmp_path / "run" / "report.html").read_text()
    for words in ("von_mises", "σn = from exact", "−∇·σ(u) = f in Ω (plane stress)"):
        assert words in report


def test_a_plate_is_solved_and_stored(tmp_path):
    case = changed(
        PLATE,
        boundary_conditions=[
            {"on": "plate", "clamped": "from exact"},
            {"on": "hole", "free": "from exact"},
        ],
        discretization={"degree": 3, "grid": 16},
        probes={"A": [0.5, 0.5]},
        expect={"relative_l2_error": 1e-4},
    )
    run = rfm.solve(case)
    assert not run.result.misses, run.result.misses
    assert set(run.summary["probes"]["A"]["moment"]) == {"xx", "xy", "yy"}
    assert run.summary["relative_energy_error"] < 0.05
    files = run.save(tmp_path / "run")
    points = [[0.1, 0.2], [1.7, 0.9]]
    np.testing.assert_array_equal(rfm.load(files["solution"]).u(points), run.u(points))
