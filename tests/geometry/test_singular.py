"""Corners of plane shapes and edges of solids: all of them, nothing else, to rounding."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus import R1, exp, sin, system
from rfm.errors import GeometryError
from rfm.geometry import (
    Box,
    ball,
    box,
    cone,
    cylinder,
    disk,
    function,
    half_plane,
    half_space,
    polygon,
    rectangle,
    weight,
)
from rfm.geometry.singular.corners import corners
from rfm.geometry.singular.criteria import criterion, operations
from rfm.geometry.singular.edges import edges, vertices
from rfm.geometry.singular.roots import common_zeros
from rfm.geometry.singular.smoothness import continuous_derivatives


def points_of(found):
    return np.array([corner.point for corner in found]).reshape(-1, 2)


def test_a_parabola_and_a_line_meet_in_two_corners():
    shape = function(lambda x, y: y - x * x, dimension=2) & half_plane((0, 4), (0, -1))
    found = corners(shape, Box((-10, -10), (10, 10)))
    np.testing.assert_allclose(points_of(found), [(-2, 4), (2, 4)], atol=1e-14)
    assert [corner.angles[0] for corner in found] == pytest.approx([np.arctan(4)] * 2, abs=1e-12)
    assert all(corner.convex and not corner.contact for corner in found)


def test_a_pentagon_has_its_five_points():
    turns = 2 * np.pi * np.arange(5) / 5 + 0.1
    given_points = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    found = corners(polygon(given_points.tolist()))
    expected = given_points[np.lexsort(given_points.T[::-1])]
    np.testing.assert_allclose(points_of(found), expected, atol=1e-14)
    assert [corner.angles[0] for corner in found] == pytest.approx([0.6 * np.pi] * 5, abs=1e-12)


@settings(max_examples=15)
@given(st.integers(3, 40), st.integers(0, 10_000))
def test_a_star_polygon_has_its_vertices(count, seed):
    rng = np.random.default_rng(seed)
    turns = 2 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
    given_points = rng.uniform(0.4, 1.0, count)[:, None] * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    found = points_of(corners(polygon(given_points.tolist())))
    assert len(found) == count
    gaps = np.abs(found[:, None] - given_points).max(axis=2).min(axis=1)
    assert gaps.max() < 1e-9


def test_lines_that_cross_inside_or_outside_are_no_corners():
    shape = rectangle((0, 0), (2, 1)) | rectangle((1, 0.5), (3, 2))
    found = points_of(corners(shape))
    expected = [(0, 0), (0, 1), (1, 1), (1, 2), (2, 0), (2, 0.5), (3, 0.5), (3, 2)]
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_an_interior_angle_is_that_of_the_shape():
    found = corners(polygon([(0, 0), (1, 0), (1, 1), (-1, 1), (-1, -1), (0, -1)]))
    angles = {corner.point: np.degrees(corner.angles[0]) for corner in found}
    assert angles.pop((0.0, 0.0)) == pytest.approx(270)
    assert list(angles.values()) == pytest.approx([90] * 5)
    assert [c.convex for c in found].count(False) == 1


def test_where_two_quarters_touch_there_are_two_angles():
    shape = (half_plane((0, 0), (1, 0)) & half_plane((0, 0), (0, 1))) | (
        half_plane((0, 0), (-1, 0)) & half_plane((0, 0), (0, -1))
    )
    (found,) = corners(shape, Box((-1, -1), (1, 1)))
    assert found.angles == pytest.approx((np.pi / 2, np.pi / 2))


def test_three_curves_through_one_point_are_one_corner():
    shape = disk((0, 0), 1) & half_plane((0, 1), (1, -1)) & half_plane((0, 1), (-2, -1))
    assert sum(abs(c.point[0]) < 1e-12 and abs(c.point[1] - 1) < 1e-12 for c in corners(shape)) == 1


@pytest.mark.parametrize("second", [disk((2, 0), 1), disk((0.5, 0), 0.5)], ids=["outside", "inside"])
def test_circles_that_touch_have_a_contact(second):
    shape = disk((0, 0), 1) | second if second.box.upper[0] > 1 else disk((0, 0), 1) - second
    (found,) = corners(shape)
    assert found.contact
    assert np.abs(np.array(found.point) - (1, 0)).max() < 1e-5


def test_smooth_shapes_have_no_corners():
    assert corners(disk((0, 0), 1) - disk((0.2, 0.1), 0.3)) == ()


def test_transcendental_curves_are_certified():
    zeros = common_zeros(
        [lambda x, y: y - exp(x) + 1, lambda x, y: y - sin(3 * x)],
        np.array([[-2.0, -3.0]]),
        np.array([[2.0, 3.0]]),
    )
    assert len(zeros.points) == 3
    assert not len(zeros.contacts)
    x, y = zeros.points.T
    assert np.abs(np.exp(x) - 1 - y).max() < 1e-14
    assert np.abs(np.sin(3 * x) - y).max() < 1e-14


def test_a_box_has_twelve_edges_and_eight_vertices():
    found = edges(box((0, 0, 0), (1, 2, 3)))
    assert len(found) == 12
    assert sorted(edge.length for edge in found) == pytest.approx([1] * 4 + [2] * 4 + [3] * 4, abs=1e-12)
    for edge in found:
        for surface in edge.surfaces:
            assert np.abs(surface.function(*edge.points.T)).max() < 1e-14
        assert edge.angles == pytest.approx(np.pi / 2)
    corner_points = [(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)]
    np.testing.assert_allclose(vertices(box((0, 0, 0), (1, 2, 3))), corner_points, atol=1e-14)


def test_a_bored_ball_has_two_circles():
    found = edges(ball((0, 0, 0), 1) - cylinder((0, 0, 0), (0, 0, 1), 0.3))
    assert [edge.closed for edge in found] == [True, True]
    for edge in found:
        assert edge.length == pytest.approx(0.6 * np.pi, rel=1e-3)
        assert edge.angles == pytest.approx(np.arccos(0.3), abs=1e-12)
        np.testing.assert_allclose(np.abs(edge.points[:, 2]), np.sqrt(1 - 0.09), atol=1e-13)


def test_a_finer_accuracy_brings_the_polygon_closer():
    shape = cone((0, 0, 0), (0, 0, 1), 0.5, 1)
    (coarse,), (fine,) = edges(shape, accuracy=1e-3), edges(shape, accuracy=1e-4)
    assert np.pi - fine.length < 0.2 * (np.pi - coarse.length)
    assert fine.closed
    assert fine.angles == pytest.approx(np.arctan(2), abs=1e-10)


def test_a_notched_box_has_arcs_between_its_edges():
    found = edges(box((0, 0, 0), (1, 1, 1)) - ball((1, 1, 1), 0.5))
    assert len(found) == 15
    arcs = [edge for edge in found if not edge.surfaces[1].name]
    assert [arc.length for arc in arcs] == pytest.approx([np.pi / 4] * 3, rel=1e-3)


def test_equal_crossed_cylinders_keep_their_two_ellipses():
    shape = cylinder((0, 0, 0), (1, 0, 0), 0.5, 2) | cylinder((0, 0, 0), (0, 1, 0), 0.5, 2)
    seams = [e for e in edges(shape) if {s.name for s in e.surfaces} == {"lateral"}]
    lengths = [edge.length for edge in seams]
    from scipy.special import ellipe

    assert lengths == pytest.approx([4 * np.sqrt(0.5) * ellipe(0.5)] * 2, rel=1e-3)
    assert all(edge.closed for edge in seams)


def test_refusals():
    with pytest.raises(
        GeometryError, match="corners are for plane shapes, this one has dimension 3: use edges"
    ):
        corners(ball((0, 0, 0), 1))
    with pytest.raises(GeometryError, match="edges are for solids, this shape has dimension 2: use corners"):
        edges(disk((0, 0), 1))
    with pytest.raises(GeometryError, match="give a finite box in which to search"):
        corners(half_plane((0, 0), (1, 0)))
    with pytest.raises(GeometryError, match=r"accuracy must be above 0 and at most 0\.1, got 0"):
        edges(half_space((0, 0, 0), (1, 0, 0)), accuracy=0.0)


def test_surfaces_that_coincide_bear_corners_like_one():
    shape = rectangle((0, 0), (2, 1)) | rectangle((0, 1), (1, 2)).move((0, 0))
    found = points_of(corners(shape))
    np.testing.assert_allclose(found, [(0, 0), (0, 2), (1, 1), (1, 2), (2, 0), (2, 1)], atol=1e-14)


@pytest.mark.parametrize("name", ["r0", "ralpha0.5", "rp4", "r0m2", "rnorm2"])
def test_the_criterion_vanishes_at_every_corner_and_nowhere_else(name):
    shape = rectangle((0, 0), (2, 1)) | disk((1, 1), 0.6)
    K = criterion(shape, system(name))
    for corner in corners(shape):
        assert abs(K(*corner.point)) < 1e-12
    x, y = np.random.default_rng(1).uniform(-1, 3, (2, 500))
    assert (np.asarray(K(x, y)) > 1e-12).all()


def test_each_operation_has_its_own_criterion():
    shape = rectangle((0, 0), (2, 1)) | disk((1, 1), 0.6)
    found = operations(shape)
    assert [one.kind for one in found] == ["intersection"] * 3 + ["union"]
    assert [one.kappa(2.0, 0.0) < 1e-12 for one in found].count(True) == 1


def test_minimum_and_maximum_are_singular_on_a_curve():
    K = criterion(rectangle((0, 0), (1, 1)), R1())
    assert K(0.25, 0.25) == 0.0


def test_a_shape_of_one_surface_is_singular_nowhere():
    assert criterion(disk((0, 0), 1))(0.3, 0.1) == 1.0


@pytest.mark.parametrize(("name", "expected"), [("auto", 4), ("r0", 0), ("r0m1", 1), ("r0m2", 2), ("rp4", 0)])
def test_how_smooth_a_weight_is_at_a_convex_corner(name, expected):
    shape = disk((0, 0), 1) & half_plane((0, -0.2), (0, 1))
    for corner in corners(shape):
        vanishing = weight(shape, shape.part("all"), name)
        assert continuous_derivatives(vanishing, shape.membership, corner.point, 2.0) == expected


def test_a_re_entrant_corner_leaves_a_weight_without_a_derivative():
    shape = disk((0, 0), 1) | rectangle((0, -0.4), (1.5, 0.4))
    found = {c.point: c for c in corners(shape)}
    vanishing = weight(shape, shape.part("all"))
    smooth = [continuous_derivatives(vanishing, shape.membership, point, 2.5) for point in found]
    assert smooth == [0] * 4  # all four belong to one factor, an R-disjunction


def test_along_an_edge_a_product_is_smooth_and_an_r_function_is_not():
    shape = box((0, 0, 0), (1, 1, 1))
    across = np.array([[1.0, 0, 0], [0, 1.0, 0]])
    for name, expected in (("auto", 4), ("r0", 0)):
        vanishing = weight(shape, shape.part("all"), name)
        assert continuous_derivatives(vanishing, shape.membership, (0, 0, 0.4), 1.0, across) == expected
