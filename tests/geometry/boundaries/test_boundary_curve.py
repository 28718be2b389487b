from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Polynomial

import rfm
from rfm.calculus import partials
from rfm.errors import CaseError, GeometryError
from rfm.geometry import weight
from rfm.geometry.boundaries import arc, bezier
from rfm.geometry.boundaries.beziers import POWERS
from rfm.geometry.boundaries.curve import curve, region

LEAF = {"start": (0, 0), "pieces": [{"bezier": [(0.6, -0.8), (1.2, 0)]}, {"bezier": [(0.6, 1.0), (0, 0)]}]}


def inside_leaf(x, y):
    """Between two parabolas over 0 < x < 1.2: y = -1.6 r (1 - r) and y = 2 r (1 - r), x = 1.2 r."""
    r = x / 1.2
    return (y > -1.6 * r * (1 - r)) & (y < 2.0 * r * (1 - r))


def test_region_box_and_parts():
    leaf = curve(**LEAF).named("leaf")
    points = np.random.default_rng(0).uniform((-0.3, -0.7), (1.5, 0.8), (3000, 2))
    np.testing.assert_array_equal(leaf.contains(points), inside_leaf(*points.T))
    np.testing.assert_allclose([leaf.box.lower, leaf.box.upper], [(0, -0.4), (1.2, 0.5)], atol=1e-15)
    assert leaf.parts == ("leaf", "leaf.piece0", "leaf.piece1")


def test_weight_of_one_part():
    leaf = curve(**LEAF)
    w = weight(leaf, leaf.part("piece0"))
    r = np.linspace(0.1, 0.9, 17)
    lower, upper = (1.2 * r, -1.6 * r * (1 - r)), (1.2 * r, 2.0 * r * (1 - r))
    assert np.abs(w(*lower)).max() < 1e-15
    assert w(*upper).min() > 0.01
    np.testing.assert_allclose(np.hypot(*partials(w, lower, 1)[1:]), 1.0, atol=1e-6)


def test_a_line_closes_an_open_curve():
    bow = curve((0, 0), [{"arc": [(0.5, 0.5), (1, 0)]}])
    assert bow.parts == ("piece0", "piece1")
    points = np.random.default_rng(0).uniform(-0.2, 1.2, (1000, 2))
    inside = (np.hypot(points[:, 0] - 0.5, points[:, 1]) < 0.5) & (points[:, 1] > 0)
    np.testing.assert_array_equal(bow.contains(points), inside)


def on_arc(center, radius, start, end):
    angle = np.linspace(start, end, 4001)
    return np.array(center) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def on_bezier(control):
    r = np.linspace(0, 1, 4001)
    return r[:, None] ** np.arange(len(control)) @ (POWERS[len(control) - 1] @ np.array(control, dtype=float))


CONTROLS = [
    [(0, 0), (1, 2), (3, 0)],
    [(0, 0), (0, 2), (2, 2), (2, 0)],
    [(0, 0), (2, 1), (-1, 2), (1, 3)],
    [(0, 0), (3, 0), (3, 2), (1, -0.5)],
]
REACHES = [
    (arc((0, 0), 1, 0.3, 2.0), on_arc((0, 0), 1, 0.3, 2.0)),
    (arc((1, 2), 0.5, 0.3, -4.0), on_arc((1, 2), 0.5, 0.3, -4.0)),
    *((bezier(control), on_bezier(control)) for control in CONTROLS),
]


@pytest.mark.parametrize(("piece", "points"), REACHES)
def test_reach_of_pieces(piece, points):
    """The support function is the largest value on fine points of the pieces."""
    angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    directions = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    reach = np.max([batch.reach(directions) for batch in piece.batches], axis=0)
    np.testing.assert_allclose(reach, (directions @ points.T).max(axis=1), atol=1e-6)


CASE = {
    "rfm": 1,
    "title": "a leaf",
    "geometry": {
        "shapes": {
            "leaf": {
                "curve": {
                    "start": [0, 0],
                    "pieces": [{"bezier": [[0.6, -0.8], [1.2, 0]]}, {"bezier": [[0.6, 1.0], [0, 0]]}],
                }
            }
        },
        "domain": "leaf",
    },
    "equation": {"poisson": {"source": "from exact"}},
    "boundary_conditions": [{"on": "all", "dirichlet": "from exact"}],
    "exact": "exp(x)*sin(2*y) + x*y",
    "discretization": {"basis": "web-spline", "degree": 3, "grid": 8},
}


@pytest.mark.slow
@pytest.mark.parametrize("degree", [2, 3])
def test_poisson_converges_with_full_order(degree):
    errors = []
    for grid in (8, 16):
        case = {**CASE, "discretization": {"degree": degree, "grid": grid}}
        errors.append(rfm.solve(case).summary["relative_l2_error"])
    rate = np.log2(errors[0] / errors[1])
    assert degree + 0.7 < rate < degree + 2.1, errors


def changed(curve_):
    shapes = {"leaf": {"curve": curve_}}
    return {**CASE, "geometry": {"shapes": shapes, "domain": "leaf"}}


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            {"start": [0, 0], "pieces": [{"line": [1, 0]}, {"line": [1, 0]}]},
            "geometry.shapes.leaf.curve: piece 1: segment 0 has length zero: points 0 and 1 are the same point [1, 0]",
        ),
        (
            {"start": [0, 0], "pieces": [{"arc": [[1, 0], [2, 0]]}]},
            "geometry.shapes.leaf.curve: piece 0: the three points of an arc lie on a line: [[0, 0], [1, 0], [2, 0]]",
        ),
        (
            {"start": [0, 0], "pieces": [{"arc": [[1, 0]]}]},
            "geometry.shapes.leaf.curve: piece 0: an arc has a point on it and its end",
        ),
        (
            {"start": [0, 0], "pieces": [{"line": [1, 0]}]},
            "geometry.shapes.leaf.curve: the curve encloses nothing: it runs back on itself",
        ),
        ({"start": [0, 0], "pieces": []}, "geometry.shapes.leaf.curve.pieces: must not be empty"),
        (
            {"start": [0, 0], "pieces": [{"line": [1, 0], "arc": [[1, 0]]}]},
            "geometry.shapes.leaf.curve.pieces.0.arc: has line and arc; a piece is only one of them",
        ),
        (
            {"start": [0, 0], "pieces": [{"bezier": [[1, 0], [2]]}]},
            "geometry.shapes.leaf.curve.pieces.0.bezier.1: must have 2 coordinates, got 1",
        ),
    ],
)
def test_bad_curves_in_a_case(given, message):
    with pytest.raises(CaseError) as caught:
        rfm.solve(changed(given))
    assert str(caught.value) == message


def test_bad_pieces_in_python():
    with pytest.raises(
        GeometryError, match=r"^piece 0 must be one of line, arc, bezier, spline, got circle$"
    ):
        curve((0, 0), [{"circle": (1, 0)}])
    with pytest.raises(GeometryError, match=r"^a signed function needs closed curves, but a piece starts at"):
        region([bezier([(0, 0), (1, 2), (3, 0)])])


def test_powers_are_those_of_bernstein():
    for degree in range(4):
        values = POWERS[degree].T  # row j: coefficients of the j-th Bernstein polynomial
        total = Polynomial(values.sum(axis=0))
        np.testing.assert_allclose(total(np.linspace(0, 1, 5)), 1.0)
