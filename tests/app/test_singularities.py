"""Corners and edges of a run reach its report and its picture of the shape."""

from pathlib import Path

from rfm.app.case import load_case
from rfm.app.run import compute, record_of
from tests.app.test_report import outline

CASES = Path(__file__).parents[2] / "cases"


def solved(name, **settings):
    return record_of(compute(load_case(CASES / name, settings)))


def test_a_re_entrant_corner_is_listed_with_its_angle_and_smoothness():
    record = solved("corners/l_shape.yaml", **{"discretization.grid": 8})
    angles = {one.place: one.angle for one in record.singularities}
    assert len(angles) == 6
    assert angles["(0, 0)"] == "270.0"
    assert {one.smoothness for one in record.singularities if one.angle == "90.0"} <= {0, 4}
    html, _ = outline(record)
    assert "<td>(0, 0)</td>" in html
    assert "interior angle (degrees)" in html


def test_edges_of_a_solid_are_listed():
    record = solved("three_d/box_minus_ball.yaml", **{"discretization.grid": 6, "discretization.degree": 2})
    assert len(record.singularities) == 12
    assert all(one.angle == "90.0" and one.smoothness == 4 for one in record.singularities)
    assert "to" in record.singularities[0].place


def test_a_smooth_shape_has_no_such_section():
    record = solved("poisson/annulus.yaml", **{"discretization.grid": 8})
    assert record.singularities == ()
    assert "interior angle" not in outline(record)[0]
