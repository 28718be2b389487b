"""Planning: optima against closed forms, proofs by intervals, moving shapes."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus import sin
from rfm.errors import GeometryError
from rfm.geometry import Box, ball, disk, half_plane, polygon, rectangle
from rfm.geometry.planning import (
    Motion,
    clearance,
    first_contact,
    monotone_search,
    moving,
    region,
    upper_bound,
)

SQUARE = Box((-2, -2), (2, 2))


def test_the_farthest_point_of_a_disk():
    """max 3x + 4y on the unit disk is 5, at (0.6, 0.8)."""
    found = monotone_search(lambda x, y: 1 - x * x - y * y, lambda x, y: 3 * x + 4 * y, SQUARE)
    assert found.value == pytest.approx(5, abs=1e-7)
    np.testing.assert_allclose(found.point, (0.6, 0.8), atol=1e-3)
    assert found.value <= 5


def test_an_optimum_at_a_corner_of_three_constraints():
    feasible = region([lambda x, y: 1 - x, lambda x, y: 1 - y, lambda x, y: 1.5 - x - y])
    found = monotone_search(feasible, lambda x, y: 2 * x + y, SQUARE)
    assert found.value == pytest.approx(2.5, abs=1e-6)
    np.testing.assert_allclose(found.point, (1, 0.5), atol=1e-5)


def test_an_optimum_inside_is_not_moved_by_the_constraint():
    found = monotone_search(
        lambda x, y: 1 - x * x - y * y, lambda x, y: -((x - 0.2) ** 2) - (y + 0.1) ** 2, SQUARE
    )
    np.testing.assert_allclose(found.point, (0.2, -0.1), atol=1e-4)


def test_the_best_of_several_local_optima_is_taken():
    objective = lambda x, y: sin(3 * x) + 0.2 * x - y * y  # noqa: E731
    feasible = lambda x, y: 4 - x * x - y * y  # noqa: E731
    found = monotone_search(feasible, objective, SQUARE)
    x = np.linspace(-2, 2, 400_001)
    assert found.value == pytest.approx((np.sin(3 * x) + 0.2 * x).max(), abs=1e-7)
    proof = upper_bound(feasible, objective, SQUARE, found.value, 1e-3)
    assert found.value <= proof.value <= found.value + 1.01e-3


def test_the_bound_is_a_bound_without_a_search():
    proof = upper_bound(lambda x, y: 1 - x * x - y * y, lambda x, y: 3 * x + 4 * y, SQUARE, tolerance=1e-2)
    assert 5 - 1e-9 <= proof.value <= 5.05


def test_a_region_without_points_is_proved_empty():
    feasible = region([lambda x, y: x - 1.0, lambda x, y: -1.0 - x])
    assert upper_bound(feasible, lambda x, y: x, SQUARE).value == -np.inf
    with pytest.raises(GeometryError, match="no feasible point was found from 5 starts"):
        monotone_search(feasible, lambda x, y: x, SQUARE)


def test_the_search_is_monotone():
    values = []

    def objective(x, y):
        return x + 0.5 * y

    feasible = rectangle((-1, -1), (1, 1)).membership
    for tolerance in (1e-1, 1e-3, 1e-6, 1e-9):
        values.append(monotone_search(feasible, objective, SQUARE, tolerance, np.array([[0.1, 0.2]])).value)
    assert values == sorted(values)
    assert values[-1] == pytest.approx(1.5, abs=1e-5)


def test_the_largest_disk_in_a_triangle():
    """Variables: centre and radius; each side keeps its distance.  The inradius of 3, 4, 5 is 1."""
    sides = polygon([(0, 0), (4, 0), (0, 3)]).surfaces
    feasible = region([lambda x, y, r, s=s: s.function(x, y) - r for s in sides])
    found = monotone_search(feasible, lambda x, y, r: r + 0.0 * x, Box((0, 0, 0), (4, 3, 3)))
    assert found.value == pytest.approx(1, abs=1e-6)
    np.testing.assert_allclose(found.point, (1, 1, 1), atol=1e-5)


def test_two_disks_packed_into_a_square():
    """Two equal disks in the unit square have the radius 1/(2 + sqrt 2)."""

    def inside(i):
        return [
            lambda *v: v[2 * i] - v[4],
            lambda *v: 1 - v[2 * i] - v[4],
            lambda *v: v[2 * i + 1] - v[4],
            lambda *v: 1 - v[2 * i + 1] - v[4],
        ]

    apart = lambda *v: (v[0] - v[2]) ** 2 + (v[1] - v[3]) ** 2 - 4 * v[4] ** 2  # noqa: E731
    feasible = region([*inside(0), *inside(1), apart])
    box = Box((0, 0, 0, 0, 0), (1, 1, 1, 1, 0.5))
    found = monotone_search(feasible, lambda *v: v[4] + 0.0 * v[0], box)
    assert found.value == pytest.approx(1 / (2 + np.sqrt(2)), abs=1e-5)


def test_when_two_disks_meet():
    """Centres 3 apart, approaching with the speed 1, radii 0.5 and 0.7: contact at 1.8."""
    a = moving(disk((0, 0), 0.5), Motion(lambda t: (t, 0.0 * t)))
    b = moving(disk((3, 0), 0.7), Motion(lambda t: (0.0 * t, 0.0 * t)))
    box = Box((-1, -1, 0), (4, 1, 3))
    clash = first_contact(a, b, box)
    assert clash is not None
    assert clash.time == pytest.approx(1.8, abs=1e-4)
    np.testing.assert_allclose(clash.point, (2.3, 0), atol=2e-2)
    assert clearance(a, b, box) > 0


def test_a_disk_that_passes_in_time_is_proved_to():
    bar = moving(rectangle((-0.2, -1.2), (0.2, 1.2)), Motion(lambda t: (0.0 * t, 0.0 * t), lambda t: t))
    box = Box((-3, -3, 0), (3, 3, np.pi))
    far = moving(disk((0, 0), 0.3), Motion(lambda t: (2.0 - 0.2 * t, 0.0 * t)))
    near = moving(disk((0, 0), 0.3), Motion(lambda t: (1.0 + 0.0 * t, 0.0 * t)))
    assert clearance(bar, near, box) > 0
    clash = first_contact(bar, near, box)
    assert clash is not None
    # the bar's corner (-0.2 .. 0.2, -1.2) sweeps towards the disk; it touches when its long side reaches the disk
    assert 0.5 < clash.time < 1.5
    assert clearance(bar, far, box, 1e-2) < 0
    assert first_contact(bar, far, box) is None


def test_two_balls_in_space():
    a = moving(ball((0, 0, 0), 0.5), Motion(lambda t: (2 * t, 0.0 * t, 0.0 * t)))
    b = moving(ball((2, 0, 0), 0.5), Motion(lambda t: (0.0 * t, 0.0 * t, 0.0 * t)))
    clash = first_contact(a, b, Box((-1, -1, -1, 0), (3, 1, 1, 1)))
    assert clash is not None
    assert clash.time == pytest.approx(0.5, abs=1e-3)


def test_refusals():
    with pytest.raises(GeometryError, match="a region needs at least one constraint"):
        region([])
    with pytest.raises(GeometryError, match="a search needs a finite box"):
        monotone_search(half_plane((0, 0), (1, 0)).membership, lambda x, y: x, Box((0, 0), (np.inf, 1)))
    with pytest.raises(GeometryError, match="the tolerance of a bound must be positive, got 0"):
        upper_bound(half_plane((0, 0), (1, 0)).membership, lambda x, y: x, SQUARE, tolerance=0.0)
