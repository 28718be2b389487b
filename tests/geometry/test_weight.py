"""Weights and distances: zero exactly on the part, positive elsewhere, slopes, smoothness across."""

from __future__ import annotations

import numpy as np
import pytest
from boundary_sampling import boundary_points, inside_points

import rfm.geometry as g
from rfm.calculus.jets import partials
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape
from rfm.geometry.weight import COMBINATIONS

outer, inner = g.disk((0.5, 0.5), 0.4).named("outer"), g.disk((0.5, 0.5), 0.1).named("inner")
plate, disk = g.rectangle((0, 0), (2, 1)).named("plate"), g.disk((2, 1), 0.7).named("disk")
ell = g.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]).named("ell")
u_shape = g.polygon([(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]).named("u")
stairs = g.polygon([(0, 0), (4, 0), (4, 3), (3, 3), (3, 2), (2, 2), (2, 1), (1, 1), (1, 3), (0, 3)]).named(
    "s"
)
hole = g.rectangle((0.5, 0.3), (1.2, 0.6)).named("hole")
tube = g.cylinder((0, 0, 0), (1, 0, 0.2), 0.6, 3).named("tube")
ring = g.torus((0, 0, 0), (1, 1, 0), 1, 0.3).named("ring")
cone = g.cone((0, 0, 0), (0, 0, 1), 1, 2).named("cone")

CASES: dict[str, tuple[Shape, tuple[str, ...]]] = {
    "annulus": (outer - inner, ("all", "outer", "inner")),
    "corner cut": (plate - disk, ("all", "plate", "disk", "plate.right")),
    "union": (plate | disk, ("all", "plate", "disk", "plate.right", "plate.left")),
    "bite": (disk - plate, ("all", "plate", "plate.top", "disk")),
    "moved union": ((plate | disk).rotate(0.3).scale(2).move((1, 1)), ("plate", "plate.right")),
    "L": (ell, ("all", "ell.edge0", "ell.edge2", "ell.edge3")),
    "U": (u_shape, ("all", "u.edge1", "u.edge2", "u.edge6", "u.edge3", "u.edge4")),
    "stairs": (stairs, ("all", "s.edge2", "s.edge5", "s.edge8")),
    "rectangular hole": (plate - hole, ("all", "hole", "hole.left", "plate.left")),
    "exclusive or": ((plate - disk) | (disk - plate), ("all",)),
    "tube minus ring": (tube - ring, ("all", "ring", "tube.lateral")),
    "tube or ring": (tube | ring, ("all", "ring", "tube.lateral", "tube.top")),
    "cone": (cone, ("all", "cone.base", "cone.lateral")),
}
PAIRS = [(case, name) for case, (_, names) in CASES.items() for name in names]


def clear_of_corners(shape: Shape, surface: object, points: np.ndarray, gap: float = 0.05) -> np.ndarray:
    """Points at which every other surface is at a distance."""
    others = [np.abs(s.function(*points.T)) for s in shape.surfaces if s is not surface]
    return np.min(others, axis=0) > gap if others else np.ones(len(points), dtype=bool)


@pytest.mark.parametrize("system", ["auto", "saturated", "r0"])
@pytest.mark.parametrize(("case", "name"), PAIRS)
def test_zero_exactly_on_the_part(case: str, name: str, system: str) -> None:
    shape = CASES[case][0]
    part = shape.part(name)
    weight = g.weight(shape, part, system)
    assert weight(*inside_points(shape).T).min() > 0
    for surface in shape.surfaces:
        points, normals = boundary_points(shape, surface)
        chosen = part.selects(points) if surface in part.surfaces else np.zeros(len(points), dtype=bool)
        jet = partials(weight, tuple(points.T), 1)
        assert np.abs(jet[0][chosen]).max(initial=0.0) < 1e-14
        clear = clear_of_corners(shape, surface, points)
        slope = (jet[1:] * normals.T).sum(axis=0)
        assert slope[chosen & clear].min(initial=1.0) > 1e-4
        assert jet[0][~chosen].min(initial=1.0) > 0


@pytest.mark.parametrize(("case", "name"), PAIRS)
def test_distance_is_normalised(case: str, name: str) -> None:
    shape = CASES[case][0]
    part = shape.part(name)
    distance = g.distance(shape, part)
    assert distance(*inside_points(shape).T).min() > 0
    for surface in part.surfaces:
        points, normals = boundary_points(shape, surface)
        keep = part.selects(points) & clear_of_corners(shape, surface, points)
        jet = partials(distance, tuple(points[keep].T), 1)
        assert np.abs(jet[0]).max(initial=0.0) < 1e-14
        np.testing.assert_allclose((jet[1:] * normals[keep].T).sum(axis=0), 1.0, atol=1e-9)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_normalisation_of_higher_order(order: int) -> None:
    """Equation (4.10) on an ellipse: w = s + O(s^(m+1)) along inward normals, s the arc length."""
    shape = g.ellipse((0, 0), (1.0, 0.6), 0.3)
    distance = g.distance(shape, shape.part("all"), order)
    points, normals = boundary_points(shape, shape.surfaces[0], 60)
    steps = np.array([0.005, 0.0025])
    errors = [np.abs(distance(*(points + s * normals).T) - s).max() for s in steps]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order + 1, abs=0.15)


def test_order_must_be_positive() -> None:
    with pytest.raises(GeometryError, match="order of normalisation must be at least 1, got 0"):
        g.normalise(lambda x, y: x, 2, 0)


@pytest.mark.parametrize("system", ["auto", "r0"])
def test_restricted_part(system: str) -> None:
    shape = outer - inner
    part = shape.part("outer").restricted(lambda x, y: x - 0.5)
    weight = g.weight(shape, part, system)
    points, normals = boundary_points(shape, outer.surfaces[0])
    jet = partials(weight, tuple(points.T), 1)
    right = points[:, 0] > 0.5
    assert np.abs(jet[0][right]).max() < 1e-14
    np.testing.assert_allclose((jet[1:] * normals.T).sum(axis=0)[points[:, 0] > 0.55], 1.0, atol=1e-9)
    assert jet[0][~right].min() > 0
    assert weight(*inside_points(shape).T).min() > 0


def test_union_of_restricted_parts() -> None:
    shape = outer - inner
    right = shape.part("outer").restricted(lambda x, y: x - 0.5)
    weight = g.weight(shape, right | shape.part("inner"))
    several = g.weight(shape, [right, shape.part("inner")])
    points = inside_points(shape)
    np.testing.assert_allclose(weight(*points.T), several(*points.T))
    holes, _ = boundary_points(shape, inner.surfaces[0])
    assert np.abs(weight(*holes.T)).max() < 1e-14


def test_trimmed_weight_is_smooth_across_the_boundary() -> None:
    """Third differences across a trimmed piece shrink like h^3; those of (5.1) only like h."""
    shape, surface = plate | disk, disk.surfaces[0]
    weight = g.weight(shape, shape.part("disk"))
    points, normals = boundary_points(shape, surface, 200)
    far = clear_of_corners(shape, surface, points, 0.2)
    points, normals = points[far][:5], normals[far][:5]

    def differences(h: float) -> float:
        line = [weight(*(points + k * h * normals).T) for k in (-1.5, -0.5, 0.5, 1.5)]
        return float(np.abs(np.diff(line, 3, axis=0)).max())

    assert differences(1e-2) / differences(5e-3) == pytest.approx(8.0, rel=0.1)


def test_published_trimming() -> None:
    """Equation (5.1): zero on f = 0, t >= 0 only, unit slope there."""
    x = np.linspace(-1, 1, 41)
    f, t = np.meshgrid(x, x, indexing="ij")
    value = g.trimmed(f, t)
    zero = (f == 0) & (t >= 0)
    assert np.abs(value[zero]).max() == 0
    assert value[~zero].min() > 0
    np.testing.assert_allclose(g.trimmed(1e-6, 0.5) / 1e-6, 1.0, atol=1e-9)


def test_product_of_two_factors_is_the_automatic_choice() -> None:
    """Annulus: a polynomial, so that psi of a smooth solution is smooth."""
    shape = outer - inner
    points = inside_points(shape)
    expected = outer.surfaces[0].function(*points.T) * -inner.surfaces[0].function(*points.T)
    np.testing.assert_allclose(g.weight(shape, shape.part("all"))(*points.T), expected, rtol=1e-14)


def test_many_holes_are_saturated() -> None:
    square = g.rectangle((0, 0), (1, 1)).named("square")
    for i in range(3):
        for j in range(3):
            square = square - g.disk((0.2 + 0.3 * i, 0.2 + 0.3 * j), 0.05).named(f"h{i}{j}")
    points = inside_points(square)
    everything = square.part("all")
    values = {name: g.weight(square, everything, name)(*points.T) for name in COMBINATIONS}
    np.testing.assert_allclose(values["auto"], values["saturated"])
    spread = {name: np.ptp(np.log10(np.quantile(v, [0.05, 0.95]))) for name, v in values.items()}
    assert spread["saturated"] < spread["product"] - 1.0


@pytest.mark.parametrize("hole", [g.disk((0, 0), 0.3), g.ellipse((0, 0), (0.3, 0.5), 1.0).scale(2.0)])
def test_saturated_holes_have_no_pole_and_a_limit(hole: Shape) -> None:
    """Also inside the hole, where moment-fitted rules have nodes."""
    domain = g.rectangle((-2, -2), (2, 2)) - hole.named("hole")
    part = domain.part("hole")
    grid = np.meshgrid(*[np.linspace(-2, 2, 401)] * 2)
    values = g.weight(domain, part, "saturated")(*grid)
    assert np.isfinite(values).all()
    assert np.abs(values).max() < 2.0
    np.testing.assert_array_equal(values > 0, hole.surfaces[0].function(*grid) < 0)


def test_torus_peak_bounds_its_function() -> None:
    (surface,) = ring.surfaces
    points = inside_points(ring, 200_000)
    values = surface.function(*points.T)
    assert 0.99 * surface.peak < values.max() <= surface.peak


def test_many_outlines_are_joined_by_r0() -> None:
    """At the obtuse corners of a polygon of many sides a weight must vanish like r, not like r^2."""
    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    corners = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    shape = g.polygon(corners)
    steps = np.array([1e-3, 1e-4])
    for system, order in (("auto", 1.0), ("product", 2.0)):
        weight = g.weight(shape, shape.part("all"), system)
        near = weight(*((1.0 - steps)[:, None] * corners[0]).T)
        assert np.log10(near[0] / near[1]) == pytest.approx(order, abs=0.02)


def test_a_carrier_that_touches_only_in_its_part_is_not_trimmed() -> None:
    shape = plate - disk
    (surface,) = shape.part("plate.right").surfaces
    assert g.weight(shape, shape.part("plate.right")) is surface.function


def test_no_part_gives_one() -> None:
    shape = outer - inner
    nothing = shape.part("outer") - shape.part("outer")
    assert g.weight(shape, nothing)(0.3, 0.4) == 1.0
    assert g.distance(shape, nothing)(0.3, 0.4) == 1.0


def test_unknown_system() -> None:
    with pytest.raises(
        GeometryError,
        match="unknown weight 'best'; choose one of auto, product, saturated, scaled, plateau, r0",
    ):
        g.weight(outer, outer.part("all"), "best")
    with pytest.raises(GeometryError, match="R_p needs an even p >= 2, got 3"):
        g.weight(outer, outer.part("all"), "rp3")
    with pytest.raises(GeometryError, match="spline R-functions have groups 1 to 6, got 7"):
        g.weight(outer, outer.part("all"), "spline2:group7")


def test_extension_is_constant_along_normals() -> None:
    """Equation (7.2) on a circle: f(x - w grad w), zero normal derivative on the boundary."""
    shape = g.disk((0, 0), 1)
    distance = g.distance(shape, shape.part("all"), 2)
    extended = g.extend(lambda x, y: x**2 * y + y, distance, 2)
    angles = np.linspace(0, 2 * np.pi, 17)
    points = np.array([np.cos(angles), np.sin(angles)])
    jet = partials(extended, tuple(points), 1)
    np.testing.assert_allclose(jet[0], points[0] ** 2 * points[1] + points[1], atol=1e-13)
    np.testing.assert_allclose((jet[1:] * points).sum(axis=0), 0.0, atol=1e-12)
