from __future__ import annotations

import math

import numpy as np
import pytest
from boundary_checks import (
    check_intervals,
    check_jets,
    check_ratio,
    check_slope,
    check_slope_on,
    check_zero,
    cloud,
)

from rfm.calculus import partials
from rfm.errors import GeometryError
from rfm.geometry.boundaries import arc, arc_about, arc_through, circle, polyline

CENTER, RADIUS = np.array([1.0, 2.0]), 0.5
OPENINGS = [
    (0.0, 0.1),
    (0.0, 1.0),
    (0.3, 0.3 + math.pi),
    (0.0, 5.0),
    (0.0, 6.27),
    (1.0, -2.0),
    (0.0, 2 * math.pi),
]


def on_arc(start, end, count=25):
    angles = start + (end - start) * (np.arange(count) + 0.5) / count
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return CENTER + RADIUS * rays, rays


def distance_to_arc(start, end):
    middle, half = 0.5 * (start + end), 0.5 * abs(end - start)
    ends = [CENTER + RADIUS * np.array([math.cos(a), math.sin(a)]) for a in (start, end)]

    def distance(points):
        rays = points - CENTER
        angle = np.abs((np.arctan2(rays[:, 1], rays[:, 0]) - middle + np.pi) % (2 * np.pi) - np.pi)
        to_ends = np.min([np.linalg.norm(points - point, axis=1) for point in ends], axis=0)
        return np.where(angle <= half, np.abs(np.linalg.norm(rays, axis=1) - RADIUS), to_ends)

    return distance


@pytest.mark.parametrize(("start", "end"), OPENINGS)
def test_zero_on_it_unit_slope_across_it(start, end):
    w = arc(CENTER, RADIUS, start, end)
    points, rays = on_arc(start, end)
    check_zero(w, points)
    check_slope(w, points, rays, 1e-5 * min(1.0, abs(end - start)))
    around = cloud(points[0], 0.3)
    check_ratio(w, distance_to_arc(start, end), around, 0.4, 1.7)
    check_jets(w, around[:50])
    check_intervals(w, around[:200], 0.02, least=0.4)


def test_derivatives_on_the_arc_itself():
    points, rays = on_arc(0.0, 2.0)
    check_slope_on(arc(CENTER, RADIUS, 0.0, 2.0), points, rays)
    # exactly on it they are those of the left: the inside of a counter-clockwise arc
    for start, end, inward in ((0.0, 1.0, -1.0), (1.0, 0.0, 1.0)):
        jet = partials(arc((0, 0), 5.0, start, end), (4.0, 3.0), 1)
        np.testing.assert_allclose(jet[1:], inward * np.array([0.8, 0.6]), atol=1e-15)


def test_a_circle_is_smooth_all_around():
    points, _ = on_arc(0.0, 2 * math.pi, 100)
    assert np.abs(partials(circle(CENTER, RADIUS), tuple(points.T), 3)[3:]).max() < 20.0


def test_arcs_in_space():
    a, b, c = np.array([[0.0, 0, 0], [1, 1, 1], [2, 0, 0.5]])
    w = arc_through(a, b, c)
    check_zero(w, np.array([a, b, c]), 2e-15)
    batch = w.batches[0]
    normal = np.cross(batch.toward_middle[0], batch.across[0])
    angle = np.linspace(-0.9, 0.9, 11) * batch.half_opening
    rays = np.outer(np.cos(angle), batch.toward_middle[0]) + np.outer(np.sin(angle), batch.across[0])
    points = batch.center + batch.radius * rays
    check_zero(w, points, 2e-15)
    for share in (0.0, 0.6, 1.0):  # every normal direction
        check_slope(w, points, share * rays + math.sqrt(1 - share**2) * normal)
    dense = np.linspace(-1, 1, 4001) * batch.half_opening
    path = batch.center + batch.radius * (
        np.outer(np.cos(dense), batch.toward_middle[0]) + np.outer(np.sin(dense), batch.across[0])
    )
    around = cloud(b, 1.0, 500)
    around = around[np.linalg.norm(around - b, axis=1) > 0.05]

    def distance(points):
        return np.linalg.norm(points[:, None] - path, axis=2).min(axis=1)

    away = around[distance(around) > 0.02]
    check_ratio(w, distance, away, 0.4, 1.7)


@pytest.mark.parametrize(
    ("middle", "end", "half", "left"),
    [
        ((0.0, 1.0), (-1.0, 0.0), 0.5 * math.pi, True),
        ((0.0, -1.0), (-1.0, 0.0), 0.5 * math.pi, False),
        ((-1.0, 0.0), (0.0, -1.0), 0.75 * math.pi, True),
        ((-1.0, 0.0), (0.0, 1.0), 0.75 * math.pi, False),
    ],
)
def test_arc_through_three_points(middle, end, half, left):
    batch = arc_through((1.0, 0.0), middle, end).batches[0]
    assert batch.half_opening[0] == pytest.approx(half)
    np.testing.assert_allclose(batch.start[0], (1.0, 0.0), atol=1e-15)
    np.testing.assert_allclose(batch.end[0], end, atol=1e-15)
    assert (batch.side(np.zeros((1, 1)), np.zeros((1, 1))) > 0) == left


def test_arc_about_a_center():
    quarter = arc_about((0, 0), (1, 0), (0, 1)).batches[0]
    rest = arc_about((0, 0), (1, 0), (0, 1), clockwise=True).batches[0]
    whole = arc_about((0, 0), (1, 0), (1, 0), clockwise=True).batches[0]
    halves = [batch.half_opening[0] / math.pi for batch in (quarter, rest, whole)]
    np.testing.assert_allclose(halves, (0.25, 0.75, 1.0))
    assert [batch.sense[0] for batch in (quarter, rest, whole)] == [1.0, -1.0, -1.0]


def test_arcs_and_segments_join():
    w = arc_about((0, 0), (1, 0), (0, 1)) | polyline([[0, 1], [0, 0], [1, 0]])
    angle = np.linspace(0.1, 1.4, 9)
    rays = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    check_zero(w, np.concatenate([rays, [[0, 0], [0, 0.5], [0.2, 0], [1, 0]]]))
    check_slope(w, rays, rays)
    assert w(0.3, 0.3) > 0.0


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: arc((0, 0), 0, 0, 1), "radius must be positive, got 0"),
        (lambda: arc((0, 0), 1, 1, 1), "an arc from angle 1 to the same angle is a point"),
        (lambda: arc((0, 0), 1, 0, 7), "an arc opens by at most a full turn, 2 pi, got 7"),
        (
            lambda: arc_about((0, 0), (1, 0), (0, 2)),
            r"the end \[0, 2\] is not on the arc: its distance from the center is 2, that of the start 1",
        ),
        (
            lambda: arc_about((1, 0), (1, 0), (0, 2)),
            r"the start of the arc is its center \[1, 0\]: the radius is zero",
        ),
        (
            lambda: arc_through((0, 0), (1, 1), (2, 2)),
            r"the three points of an arc lie on a line: \[\[0, 0\], \[1, 1\], \[2, 2\]\]",
        ),
        (
            lambda: arc_through((0, 0), (1, 1), (0, 0)),
            r"the three points of an arc must differ, got \[\[0, 0\], \[1, 1\], \[0, 0\]\]",
        ),
    ],
)
def test_bad_arcs(build, message):
    with pytest.raises(GeometryError, match=f"^{message}$"):
        build()
