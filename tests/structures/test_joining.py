"""Corners: where parts meet, whether data agree there, and how smooth the joined field is."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.calculus.jets import partials
from rfm.geometry.primitives_2d import disk, half_plane, rectangle
from rfm.geometry.primitives_3d import box
from rfm.geometry.weight import weight
from structures.contact import boundary_points, meeting_points, spread_points
from structures.corners import corner_jumps
from structures.field_expression import field
from structures.joining import Piece, join
from structures.manufactured import generic_field, manufactured_extension
from structures.reconcile import reconcile
from structures.transfinite import interpolate

SQUARE = rectangle(min=(0, 0), max=(1, 1)).named("r")
LEFT, RIGHT, BOTTOM, TOP = (SQUARE.part(f"r.{side}") for side in ("left", "right", "bottom", "top"))


def test_corners_of_a_square():
    assert meeting_points(SQUARE, LEFT, TOP) == pytest.approx(np.array([[0.0, 1.0]]))
    assert len(meeting_points(SQUARE, LEFT, RIGHT)) == 0
    assert len(meeting_points(SQUARE, LEFT | RIGHT, TOP | BOTTOM)) == 4


def test_corners_of_a_half_disk():
    domain = disk(center=(0, 0), radius=2).named("d") & half_plane(point=(0, 1), normal=(0, -1)).named("h")
    found = meeting_points(domain, domain.part("d"), domain.part("h"))
    assert found == pytest.approx(np.array([[-np.sqrt(3), 1.0], [np.sqrt(3), 1.0]]))


def test_surfaces_that_cross_outside_the_domain_do_not_meet():
    hole = disk(center=(0.5, 0.5), radius=0.2).named("h")
    other = disk(center=(0.6, 0.5), radius=0.2).named("g")
    domain = (SQUARE - hole) - other
    assert len(meeting_points(domain, domain.part("h"), domain.part("g"))) == 2
    inside = SQUARE - (hole & other)
    assert len(meeting_points(inside, inside.part("h"), inside.part("r"))) == 0


def test_edge_in_space():
    domain = box(min=(0, 0, 0), max=(1, 2, 3)).named("b")
    found = meeting_points(domain, domain.part("b.left"), domain.part("b.top"))
    assert len(found) > 20
    assert np.abs(found[:, [0, 2]] - [0.0, 3.0]).max() < 1e-9
    assert np.ptp(found[:, 1]) > 1.5


def test_boundary_points_lie_on_their_part():
    domain = disk(center=(0, 0), radius=1).named("a") | disk(center=(1, 0), radius=1).named("b")
    points = boundary_points(domain, domain.part("a"))
    assert len(points) > 20
    assert np.hypot(*points.T) == pytest.approx(1.0)
    assert points[:, 0].max() < 0.5 + 1e-9


def test_contradictory_data_are_found():
    data = [(LEFT, 0.0), (TOP, lambda x, y: 1.0 + x), (RIGHT, lambda x, y: 2.0 * y)]
    worst, other = corner_jumps(SQUARE, data)
    assert (worst.parts, worst.jump) == (("r.left", "r.top"), pytest.approx(1.0))
    assert worst.location == pytest.approx((0.0, 1.0))
    assert other.jump < 1e-12


def test_corner_jumps_from_given_points():
    x = np.linspace(0, 1, 5000)
    points = {"r.left": np.stack([0 * x, x], axis=1), "r.top": np.stack([x, 0 * x + 1], axis=1)}
    (found,) = corner_jumps(SQUARE, [(LEFT, lambda x, y: y), (TOP, 3.0)], points)
    assert found.jump == pytest.approx(2.0)
    assert corner_jumps(SQUARE, [(LEFT, lambda x, y: y), (RIGHT, 3.0)], points) == []


def test_one_circle_in_two_pieces():
    domain = disk(center=(0, 0), radius=1).named("d")
    right = domain.part("d").restricted(lambda x, y: x - 0.6, "right")
    left = domain.part("d").restricted(lambda x, y: 0.6 - x, "left")
    (found,) = corner_jumps(domain, [(right, lambda x, y: y), (left, 0.0)])
    assert found.jump == pytest.approx(0.8)
    assert np.abs(found.location) == pytest.approx([0.6, 0.8])


def u(x, y):
    return exp(x) * sin(2 * y + 0.3) + x * y * y


def curvature(f, radius):
    """Largest second derivative at a distance from the corner (0, 1)."""
    angle = np.linspace(0.1, np.pi / 2 - 0.1, 40)
    coords = radius * np.cos(angle), 1 - radius * np.sin(angle)
    return np.abs(partials(f, coords, 2)[3:]).max()


def two_formulas():
    a = field(lambda x, y: u(x, y) + x * (1 + sin(x + 2 * y)))
    b = field(lambda x, y: u(x, y) + (1 - y) * cos(x - y))
    return a, b


def test_plain_weights_have_unbounded_curvature_at_a_corner():
    # r Phi(angle): second derivatives like 1/r
    omegas = [field(weight(SQUARE, part)) for part in (LEFT, TOP)]
    plain = interpolate(list(zip(two_formulas(), omegas, strict=True)), 2.0)
    ratio = curvature(plain, 1e-4) / curvature(plain, 1e-2)
    assert np.log(ratio) / np.log(1e-4 / 1e-2) == pytest.approx(-1.0, abs=0.15)


def test_joined_data_are_smooth_at_the_corner():
    a, b = two_formulas()
    joined = join(SQUARE, [Piece(LEFT, a), Piece(TOP, b)])
    assert max(curvature(joined, radius) for radius in (1e-1, 1e-2, 1e-3, 1e-4)) < 30.0


def test_reconciled_data_keep_their_values_and_agree_around_the_corner():
    omegas = field(weight(SQUARE, LEFT)), field(weight(SQUARE, TOP))
    a, b = two_formulas()
    a2, b2, left_over = reconcile(SQUARE, (a, b), omegas, np.array([[0.0, 1.0]]))
    t = np.linspace(0, 1, 11)
    assert partials(a2 - a, (0 * t, t), 0)[0] == pytest.approx(0.0, abs=1e-13)
    assert partials(b2 - b, (t, 0 * t + 1), 0)[0] == pytest.approx(0.0, abs=1e-13)
    inside = spread_points(SQUARE, 500).T
    before, after = (np.abs(partials(gap, tuple(inside), 0)).max() for gap in (b - a, b2 - a2))
    assert before > 1.0
    assert after < 1e-6
    assert left_over < 1e-8


def test_manufactured_extension_is_right_on_the_boundary_and_wrong_inside():
    domain = disk(center=(3, 4), radius=2).named("d")
    extended = manufactured_extension(u, weight(domain, domain.part("all")), domain.box)
    on = tuple(boundary_points(domain, domain.part("all")).T)
    assert partials(extended, on, 0) == pytest.approx(partials(u, on, 0), rel=1e-12, abs=1e-9)
    center = (np.array([3.0]), np.array([4.0]))
    assert abs(partials(extended, center, 0) - partials(u, center, 0)).max() > 0.5


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_generic_field_is_of_order_one_and_no_polynomial(scale):
    domain = rectangle(min=(0, 0), max=(scale, 2 * scale))
    q = generic_field(domain.box)
    values = partials(q, tuple(spread_points(domain).T), 0)[0]
    assert 0.5 < np.abs(values).max() < 5
    middle = (np.array([scale / 2]), np.array([scale]))
    # far derivatives along each axis do not vanish
    orders = partials(q, middle, 6)
    assert min(abs(orders[21, 0]) * scale**6, abs(orders[27, 0]) * scale**6) > 1e-3
