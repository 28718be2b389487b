"""Where moment-fitted weights make the matrix indefinite, the solve goes on with the positive rules, and says so."""

from pathlib import Path

import pytest

from rfm.app.case import load_case
from rfm.app.run import compute

CASE = Path(__file__).parents[2] / "cases" / "plate" / "taylor_example.yaml"
COARSE = {"discretization.grid": 10, "discretization.degree": 5}


def test_the_positive_rules_take_over():
    found = compute(load_case(CASE, COARSE))
    assert found.warnings[0].startswith("moment fitting was turned off")
    asked = compute(load_case(CASE, {**COARSE, "discretization.moment_fitting": False}))
    assert asked.warnings == ()
    assert found.summary["relative_l2_error"] == pytest.approx(asked.summary["relative_l2_error"], rel=1e-9)
    assert found.summary["relative_l2_error"] < 1e-3


def test_an_energy_that_is_negative_itself_is_refused():
    from rfm.errors import NumericsError

    case = load_case(
        {
            "rfm": 1,
            "geometry": {"shapes": {"d": {"disk": {"center": [0, 0], "radius": 1}}}, "domain": "d"},
            "equation": {"poisson": {"source": 1, "reaction": -200}},
            "boundary_conditions": [{"on": "all", "dirichlet": 0}],
            "discretization": {"degree": 2, "grid": 12},
        }
    )
    with pytest.raises(NumericsError, match="the matrix is not positive definite"):
        compute(case)
