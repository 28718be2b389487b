"""Corners between straight edges: those that the search of all corners finds, with their edges in order."""

import numpy as np
import pytest

from rfm.geometry import disk, polygon, rectangle
from rfm.geometry.singular.corners import corners
from rfm.geometry.singular.straight import straight_corners

L_SHAPE = ((0, 0), (1, 0), (1, 1), (-1, 1), (-1, -1), (0, -1))
NOTCH = ((0, 0), (1, 0.2), (1, 1), (-1, 1), (-1, -1), (1, -1), (1, -0.3))
HOLE = rectangle(min=(0, 0), max=(3, 2)) - rectangle(min=(1, 0.5), max=(2, 1.5))
CROSS = rectangle(min=(-1, -0.2), max=(1, 0.2)) | rectangle(min=(-0.3, -1), max=(0.3, 1))
STEP = polygon(((0, 0), (2, 0), (2, 2), (1, 2), (1, 1), (0, 1)))


@pytest.mark.parametrize(
    "shape", [polygon(L_SHAPE), polygon(NOTCH), HOLE, CROSS, STEP, HOLE - disk(center=(0.5, 0.5), radius=0.1)]
)
def test_they_are_the_reentrant_ones_of_all_corners(shape):
    expected = [c for c in corners(shape) if len(c.angles) == 1 and c.angles[0] > np.pi]
    found = straight_corners(shape)
    assert np.allclose([c.point for c in found], [c.point for c in expected], atol=1e-12)
    assert np.allclose([c.angle for c in found], [c.angles[0] for c in expected])
    for one, other in zip(found, expected, strict=True):
        assert one.reentrant
        assert {one.first, one.second} == set(other.surfaces)


@pytest.mark.parametrize("shape", [polygon(L_SHAPE), polygon(NOTCH), HOLE, CROSS, STEP])
def test_edges_bound_the_sector_in_order(shape):
    for corner in straight_corners(shape):
        for angle, surface in ((0.0, corner.first), (corner.angle, corner.second)):
            at = np.array(corner.point) + 0.01 * np.array(
                [np.cos(corner.start + angle), np.sin(corner.start + angle)]
            )
            assert abs(surface.function(*at)) < 1e-12
            assert abs(shape.sign(*at)) < 1e-12
        for angle, inside in ((0.1, True), (corner.angle - 0.1, True), (-0.1, False)):
            at = np.array(corner.point) + 0.01 * np.array(
                [np.cos(corner.start + angle), np.sin(corner.start + angle)]
            )
            assert (shape.sign(*at) > 0) == inside


@pytest.mark.parametrize(
    "shape",
    [
        rectangle(min=(0, 0), max=(1, 1)),
        polygon(((0, 0), (1, 0), (0, 1))),
        disk(center=(0, 0), radius=1) - disk(center=(0, 0), radius=0.5),
        rectangle(min=(0, 0), max=(1, 1)) | disk(center=(1, 1), radius=0.3),
    ],
)
def test_convex_and_curved_corners_are_not_among_them(shape):
    assert straight_corners(shape) == ()


def test_edges_whose_lines_support_a_polygon_are_factors_of_their_own():
    # y = -1 of the L used to be joined with x = 0: a kink of every weight at (0, -1)
    from rfm.geometry.expression import Literal
    from rfm.geometry.weight import weight

    shape = polygon(L_SHAPE)
    alone = {term.surface.name for term in shape.expression.terms if isinstance(term, Literal)}
    assert alone == {"edge1", "edge2", "edge3", "edge4"}
    own = weight(shape, shape.part("all"))
    step = 1e-3
    second = [
        (own(-x, -1 + y)) for x, y in ((step, step), (2 * step, step), (step, 2 * step), (2 * step, 2 * step))
    ]
    assert second[0] * second[3] == pytest.approx(
        second[1] * second[2], rel=1e-2
    )  # like the product of distances
