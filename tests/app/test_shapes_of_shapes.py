"""Shapes made of shapes in a case: references, dimensions, modifiers, and what is refused where."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pytest

from rfm.app.build import build_domain
from rfm.app.case import case_from_document, load_case
from rfm.app.source import from_text
from rfm.errors import CaseError
from tests.solvers.quadrature.measures import measure

CASE = """\
rfm: 1
geometry:
  shapes:
    {shapes}
  domain: {domain}
equation: {{poisson: {{source: 1}}}}
boundary_conditions:
  - {{on: all, dirichlet: 0}}
"""

DISK = "a: {disk: {center: [0, 0], radius: 1}}"
RIGHT = "b: {disk: {center: [1.4, 0], radius: 0.8}}"
PROFILE = "p: {rectangle: {min: [1, 0], max: [2, 0.5]}}"
BRICK = "k: {box: {min: [-0.5, -0.2, 0], max: [0.5, 0.2, 1]}}"


def case(shapes: list[str], domain: str):
    text = CASE.format(shapes="\n    ".join(shapes), domain=domain)
    return case_from_document(from_text(text, "case.yaml"), {})


def domain(*shapes: str, of: str = "s"):
    return build_domain(case(list(shapes), of))


AREAS = [
    ((PROFILE, "s: {revolve: {of: p}}"), 1.5 * pi),
    ((PROFILE, "s: {extrude: {of: p, direction: [0.5, 0, 2]}}"), 1.0),
    (
        ("p: {ellipse: {center: [0, 0], semi_axes: [0.4, 0.3]}}", "s: {screw: {of: p, pitch: 2, length: 1}}"),
        0.12 * pi,
    ),
    ((BRICK, "s: {section: {of: k, point: [0, 0, 0.5], normal: [0, 0, 1]}}"), 0.4),
    ((BRICK, "s: {projection: {of: k, direction: [1, 0, 0], sections: 3}}"), 0.4),
    (("s: {box: {min: [-0.5, -0.2, 0], max: [0.5, 0.2, 1]}, twist: 50}",), 0.4),
    (
        ("s: {box: {min: [-0.5, -0.2, 0], max: [0.5, 0.2, 1]}, taper: {start: 0, end: 1, factor: 0.5}}",),
        0.7 / 3,
    ),
    (("s: {disk: {center: [0, 0], radius: 1}, affine: {matrix: [[2, 0.5], [0, 0.7]]}}",), 1.4 * pi),
    (("s: {disk: {center: [3, 0], radius: 1}, mirror: {point: [0, 0], normal: [1, 0]}, move: [1, 0]}",), pi),
    (("a: {disk: {center: [0, 0], radius: 0.3}}", "s: {repeat: {of: a, step: [1, 0], count: 3}}"), 0.27 * pi),
    (("a: {disk: {center: [1, 0], radius: 0.3}}", "s: {cyclic: {of: a, count: 5}}"), 0.45 * pi),
    ((DISK, "s: {offset: {of: a, distance: -0.1}}"), 0.81 * pi),
    ((DISK, "s: {shell: {of: a, thickness: 0.1}}"), 0.19 * pi),
    ((DISK, "s: {offset: {of: s0, distance: 0.1}}", "s0: {offset: {of: a, distance: -0.2}}"), 0.81 * pi),
    (
        (PROFILE, "s: {revolve: {of: p - h}}", "h: {disk: {center: [1.5, 0.25], radius: 0.1}}"),
        1.5 * pi - 0.03 * pi**2,
    ),
]


@pytest.mark.parametrize(("shapes", "volume"), AREAS)
def test_measures(shapes: tuple[str, ...], volume: float) -> None:
    found = domain(*shapes)
    assert measure(found, 6 if found.dimension == 3 else 10, 5).volume == pytest.approx(volume, rel=1e-6)


def test_names_stay_below_the_new_one() -> None:
    found = domain(
        PROFILE,
        "h: {disk: {center: [1.5, 0.25], radius: 0.1}}",
        "s: {extrude: {of: p - h, direction: [0, 0, 1]}}",
    )
    assert found.parts == (
        "s",
        "s.p",
        "s.p.left",
        "s.p.right",
        "s.p.bottom",
        "s.p.top",
        "s.h",
        "s.start",
        "s.end",
    )
    blended = domain(DISK, RIGHT, "s: {blend: {of: [a, b], radius: 0.3, smoothness: 2}}")
    assert blended.parts == ("s",)
    assert blended.contains(np.array([[0.9, 0.62]])).all()


def test_a_profile_may_have_expressions_of_its_own_coordinates() -> None:
    shape = 'p: {function: {expression: "0.04 - (x - 1)^2 - y^2", box: [[0.7, -0.3], [1.3, 0.3]]}}'
    found = domain(shape, "s: {revolve: {of: p}}")
    assert found.contains(np.array([[0.0, 1.1, 0.1], [0.0, 0.5, 0.0]])).tolist() == [True, False]


REFUSED = [
    (
        [DISK, "s: {offset: {of: c, distance: 1}}"],
        "s",
        "5:22",
        "geometry.shapes.s.offset.of: unknown shape 'c'",
    ),
    ([DISK, "s: {blend: {of: [a, a - c], radius: 1}}"], "s", "5:29", "blend.of.1: unknown shape 'c'"),
    (
        ["a: {offset: {of: b, distance: 1}}", "b: {offset: {of: a, distance: 1}}"],
        "a",
        "5:22",
        "the shapes are made of each other in a circle: a -> b -> a",
    ),
    (["a: {offset: {of: a, distance: 1}}"], "a", "4:22", "in a circle: a -> a"),
    (
        [DISK, RIGHT, "s: {offset: {of: a, distance: 1}}"],
        "s",
        "5:5",
        "the shape 'b' is not used by the domain",
    ),
    ([BRICK, "s: {revolve: {of: k}}"], "s", "5:23", "must be two-dimensional, but is three-dimensional"),
    (
        [DISK, "s: {section: {of: a, point: [0, 0, 0], normal: [0, 0, 1]}}"],
        "s",
        "5:23",
        "must be three-dimensional",
    ),
    ([DISK, BRICK, "s: {blend: {of: [a, k], radius: 1}}"], "s", "6:25", "cannot be combined"),
    (
        [PROFILE, "s: {revolve: {of: p}}"],
        "s - p",
        "5:9",
        "revolve is three-dimensional, the other shapes are two-dimensional",
    ),
    (
        [DISK, "s: {offset: {of: 3, distance: 1}}"],
        "s",
        "5:22",
        "must be an expression of shapes such as outer - inner",
    ),
    ([DISK, "s: {offset: {of: a +, distance: 1}}"], "s", "5:24", "character '+'"),
    (
        [DISK, "s: {blend: {of: a, radius: 1}}"],
        "s",
        "5:21",
        "must be a list of at least two shapes such as [a, b]",
    ),
    (
        [DISK, RIGHT, "s: {blend: {of: [a, b], radius: 0.9}}"],
        "s",
        "6:37",
        "radius: must not exceed the size of the shapes (0.8), got 0.9",
    ),
    ([DISK, "s: {offset: {of: a, distance: -1}}"], "s", "5:35", "makes the shape vanish: its size is 1"),
    ([DISK, "s: {shell: {of: a, thickness: 0}}"], "s", "5:35", "must be positive, got 0"),
    (
        [DISK, "s: {screw: {of: a, pitch: 0, length: 1}}"],
        "s",
        "5:31",
        "pitch: must not be 0: it is the height of a full turn",
    ),
    ([DISK, "s: {cyclic: {of: a, count: 1}}"], "s", "5:32", "count: must be from 2 to 10000, got 1"),
    ([DISK, "s: {cyclic: {of: a, count: 3, by: magic}}"], "s", "5:39", "unknown name 'magic'"),
    ([DISK, "s: {repeat: {of: a, step: [1, 0], count: 2, by: wave}}"], "s", "5:9", "longer than the step"),
    ([DISK, "s: {extrude: {of: a, direction: [1, 0]}}"], "s", "5:37", "must have 3 coordinates, got 2"),
    (
        [DISK, "s: {extrude: {of: a, direction: [1, 0, 0]}}"],
        "s",
        "5:37",
        "must leave the plane of the profile",
    ),
    (
        [DISK, "s: {revolve: {of: c}}", "c: {disk: {center: [-3, 0], radius: 1}}"],
        "s & a",
        "5:9",
        "revolve is three-dim",
    ),
    (
        ["s: {revolve: {of: c}}", "c: {disk: {center: [-3, 0], radius: 1}}"],
        "s",
        "4:23",
        "the profile has no point with x > 0",
    ),
    (
        ["s: {revolve: {of: c}}", "c: {disk: {center: [-3, 0, 0], radius: 1}}"],
        "s",
        "5:24",
        "must have 2 coordinates, got 3",
    ),
    (
        ["a: {disk: {center: [0, 0], radius: 1}, affine: {matrix: [[1, 2], [2, 4]]}}"],
        "a",
        "4:52",
        "affine: matrix must be nonsingular",
    ),
    (
        ["a: {disk: {center: [0, 0], radius: 1}, affine: {matrix: [[1, 2]]}}"],
        "a",
        "4:61",
        "must be a list of 2 rows",
    ),
    (["a: {disk: {center: [0, 0], radius: 1}, twist: 10}"], "a", "4:51", "only a solid can be twisted"),
    (
        ["a: {disk: {center: [0, 0], radius: 1}, taper: {start: 0, end: 0.5, factor: 0.1}}"],
        "a",
        "4:51",
        "inside the shape",
    ),
    ([DISK, "s: {sweep: {of: a}}"], "s", "5:21", "a sweep needs a motion"),
]


@pytest.mark.parametrize(("shapes", "of", "place", "message"), REFUSED)
def test_refused(shapes: list[str], of: str, place: str, message: str) -> None:
    with pytest.raises(CaseError) as caught:
        build_domain(case(shapes, of))
    assert str(caught.value).startswith(f"case.yaml:{place}: "), str(caught.value)
    assert message in str(caught.value)


FOLDER = Path(__file__).parents[2] / "cases" / "geometry"


@pytest.mark.parametrize(
    ("name", "degree", "grids"),
    [
        pytest.param("blended_disks", 2, (8, 16), marks=pytest.mark.slow),
        ("blended_disks", 3, (8, 16)),
        ("ellipse_affine", 3, (6, 12)),
    ],
)
def test_orders(name: str, degree: int, grids: tuple[int, int]) -> None:
    import rfm

    errors = []
    for grid in grids:
        run = rfm.solve(
            load_case(FOLDER / f"{name}.yaml", {"discretization.degree": degree, "discretization.grid": grid})
        )
        errors.append(run.summary["relative_l2_error"])
    assert degree + 0.5 < np.log2(errors[0] / errors[1]) < degree + 2.5


def test_an_affine_disk_is_an_ellipse() -> None:
    import rfm

    given = load_case(FOLDER / "ellipse_affine.yaml")
    primitive = {"ellipse": {"center": [0.2, 0.1], "semi_axes": [1, 0.5], "angle": 30}}
    errors = [
        rfm.solve(FOLDER / "ellipse_affine.yaml", set=changes).summary["relative_l2_error"]
        for changes in ({}, {"geometry.shapes.ellipse": primitive})
    ]
    assert given.geometry.shapes["ellipse"].kind == "disk"
    assert errors[0] == pytest.approx(errors[1], rel=1e-3)
