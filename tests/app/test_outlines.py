"""Outlines and polyhedra in a case file: what they become, and where errors are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rfm
from rfm.app.build import build_domain
from rfm.app.case import load_case
from rfm.errors import CaseError

BAR = [[0, 0], [1, 0], [2, 0], [3, 0], [3, 2], [0, 2]]
SOLID = {
    "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, "h"]],
    "faces": [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]],
}


def case(kind: str, arguments: dict[str, Any]) -> dict[str, Any]:
    return {
        "rfm": 1,
        "parameters": {"h": 2},
        "geometry": {"shapes": {"a": {kind: arguments}}, "domain": "a"},
        "equation": {"poisson": {"source": 1}},
        "boundary_conditions": [{"on": "all", "dirichlet": 0}],
    }


def test_what_they_become() -> None:
    bar = build_domain(load_case(case("outline", {"vertices": BAR, "arcs": {"edge1": {"radius": "-h/4"}}})))
    assert bar.contains(np.array([[1.5, 0.4], [1.5, 0.6], [-1, 1]])).tolist() == [
        False,
        True,
        False,
    ]
    assert "a.edge1" in bar.parts
    holes = [[[1, 0.5], [2, 0.5], [1, 1]]]
    plate = build_domain(load_case(case("polygon", {"vertices": BAR, "holes": holes})))
    assert "a.hole0.edge2" in plate.parts
    solid = build_domain(load_case(case("polyhedron", SOLID)))
    assert solid.box.upper == (1, 1, 2)
    assert solid.parts == ("a", "a.face0", "a.face1", "a.face2", "a.face3")


@pytest.mark.parametrize(
    ("kind", "arguments", "message"),
    [
        (
            "outline",
            {"vertices": BAR, "arcs": {"edge9": {"bulge": 1}}},
            "arcs.edge9: there is no edge 'edge9': the edges are edge0 to edge5",
        ),
        (
            "outline",
            {"vertices": BAR, "arcs": {"edge1": {}}},
            "arcs.edge1: needs an arc, one of: bulge, through, radius, center",
        ),
        (
            "outline",
            {"vertices": BAR, "arcs": {"edge1": {"bulge": 1, "radius": 2}}},
            "arcs.edge1.radius: has bulge and radius; an arc is only one of them",
        ),
        (
            "outline",
            {"vertices": BAR, "arcs": {"edge1": {"bulge": 1, "clockwise": True}}},
            "arcs.edge1.clockwise: only an arc given by its center needs it",
        ),
        (
            "outline",
            {"vertices": BAR, "arcs": {"edge1": {"radius": 0.4}}},
            "outline: edge1: radius 0.4 is too small, its ends are 1 apart: at least 0.5 is needed",
        ),
        ("polygon", {"vertices": BAR, "holes": [[[1, 1]]]}, "holes.0: needs at least 3 vertices, got 1"),
        (
            "polygon",
            {"vertices": BAR, "holes": [[[7, 1], [8, 1], [8, 2]]]},
            "polygon: hole0 is not inside the polygon: its vertex 0 [7, 1] lies outside",
        ),
        (
            "polyhedron",
            {**SOLID, "faces": [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3.5]]},
            "faces.3: must be a list of numbers of vertices, got a list",
        ),
        (
            "polyhedron",
            {**SOLID, "faces": [[0, 1, 2], [0, 1, 3], [1, 2, 3]]},
            "a polyhedron needs at least 4 faces, got 3",
        ),
    ],
)
def test_errors_have_a_place(kind: str, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(CaseError) as caught:
        build_domain(load_case(case(kind, arguments)))
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("path", "degree", "grids"), [("corners/notched_bar", 3, (24, 96)), ("three_d/dented_cube", 2, (4, 8))]
)
def test_order(path: str, degree: int, grids: tuple[int, int]) -> None:
    file = Path(__file__).parents[2] / "cases" / f"{path}.yaml"
    errors = [
        rfm.solve(file, set={"discretization.degree": degree, "discretization.grid": grid}).summary[
            "relative_l2_error"
        ]
        for grid in grids
    ]
    rate = np.log(errors[0] / errors[1]) / np.log(grids[1] / grids[0])
    assert rate == pytest.approx(degree + 1, abs=0.2)
