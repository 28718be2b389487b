"""Maps: membership is that of the preimage, boxes contain the image, parts survive, volumes are the known ones."""

from __future__ import annotations

import math
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rfm.geometry as g
from rfm.calculus import partials
from rfm.calculus.intervals import Interval
from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface
from rfm.geometry.transforms import (
    affine,
    cyclic,
    extrude,
    mirror,
    projection,
    repeat,
    repeat_series,
    revolve,
    screw,
    section,
    sweep,
    taper,
    twist,
)
from tests.solvers.quadrature.measures import measure

PROFILE = g.polygon([(0.5, 0.0), (1.0, 0.0), (0.8, 0.6)]).named("tip") - g.disk((0.75, 0.2), 0.1).named("eye")
LENS = g.disk((0.0, 0.0), 1.0).named("a") & g.ellipse((0.5, 0.2), (1.0, 0.6), 0.4).named("b")
BRICK = g.box((-0.5, -0.2, 0.0), (0.5, 0.3, 1.0)).named("brick") - g.ball((0.1, 0.0, 0.5), 0.15).named("hole")
SHEAR = np.array([[1.2, 0.5], [-0.3, 0.8]])
SHEAR_3D = np.array([[1.0, 0.4, 0.0], [0.0, 1.3, -0.2], [0.3, 0.0, -0.7]])


def turned(points: Array, angle: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    x, y, *rest = points.T
    return np.stack([c * x - s * y, s * x + c * y, *rest], axis=1)


def revolved_back(points: Array) -> Array:
    return np.stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]], axis=1)


IMAGES = {
    "affine": (affine(LENS, SHEAR, (0.3, -0.2)), LENS, lambda p: (p - [0.3, -0.2]) @ np.linalg.inv(SHEAR).T),
    "affine solid": (affine(BRICK, SHEAR_3D), BRICK, lambda p: p @ np.linalg.inv(SHEAR_3D).T),
    "mirror": (mirror(LENS, (0.2, 0.0), (1.0, 0.0)), LENS, lambda p: [0.4, 0.0] + [-1.0, 1.0] * p),
    "revolve": (revolve(PROFILE), PROFILE, revolved_back),
    "revolve generic": (revolve(LENS), LENS, revolved_back),
    "extrude": (
        extrude(PROFILE, (0.3, -0.4, 1.5)),
        PROFILE,
        lambda p: np.where(
            ((p[:, 2] > 0) & (p[:, 2] < 1.5))[:, None], p[:, :2] - p[:, 2:] * [0.2, -0.4 / 1.5], 99.0
        ),
    ),
    "screw": (
        screw(LENS, 2.0, 1.5),
        LENS,
        lambda p: np.where(((p[:, 2] > 0) & (p[:, 2] < 1.5))[:, None], turned(p, -pi * p[:, 2])[:, :2], 99.0),
    ),
    "twist": (twist(BRICK, 0.9), BRICK, lambda p: turned(p, -0.9 * p[:, 2])),
    "taper": (
        taper(BRICK, 0.0, 1.0, 0.4),
        BRICK,
        lambda p: np.column_stack([p[:, :2] / (1 - 0.6 * np.clip(p[:, 2:], 0, 1)), p[:, 2]]),
    ),
    "section": (
        section(BRICK, (0.0, 0.1, 0.0), (0.0, 1.0, 0.0)),
        BRICK,
        lambda p: np.column_stack([p[:, 1], np.full(len(p), 0.1), p[:, 0]]),
    ),
}


def points_around(shape: Shape, count: int = 4000) -> Array:
    low, size = np.array(shape.box.lower), np.array(shape.box.size)
    return np.asarray(low + size * np.random.default_rng(1).uniform(-0.3, 1.3, (count, shape.dimension)))


@pytest.mark.parametrize("name", IMAGES)
def test_a_point_is_inside_where_its_preimage_is(name: str) -> None:
    image, given_, back = IMAGES[name]
    points = points_around(image)
    inside = image.contains(points)
    np.testing.assert_array_equal(inside, given_.contains(back(points)))
    assert 10 < inside.sum() < len(points) - 10


@pytest.mark.parametrize("name", IMAGES)
def test_boxes_contain_and_labels_survive(name: str) -> None:
    image, given_, _ = IMAGES[name]
    points = points_around(image, 20000)
    inside = points[image.contains(points)]
    for direction in np.vstack(
        [np.eye(image.dimension), np.ones((1, image.dimension)) / image.dimension**0.5]
    ):
        for sign in (1.0, -1.0):
            reach = float(image.reach(sign * direction[None, :])[0])
            assert (inside @ (sign * direction)).max() <= reach
    tight = 0.1 if name != "twist" else 0.25
    assert (inside.max(axis=0) - inside.min(axis=0) > (1 - tight) * np.array(image.box.size) - 0.05).all()
    assert {part for part in image.parts if part != "start" and part != "end"} <= set(given_.parts)
    if name not in ("revolve generic",):
        assert len(set(image.parts) & set(given_.parts)) >= len(given_.parts) - 2


@pytest.mark.parametrize("name", IMAGES)
def test_functions_are_enclosed_and_normalised_only_when_they_say_so(name: str) -> None:
    image, _, _ = IMAGES[name]
    rng = np.random.default_rng(2)
    low = points_around(image, 300)
    high = low + rng.uniform(0.0, 0.1, low.shape)
    for surface in image.surfaces:
        bound = Interval.of(surface.function(*(Interval(a, b) for a, b in zip(low.T, high.T, strict=True))))
        for t in (0.0, 0.3, 1.0):
            values = surface.function(*(low + t * (high - low)).T)
            assert np.all((bound.lo <= values) & (values <= bound.hi))
        assert slopes_are_honest(surface, image)


def slopes_are_honest(surface: Surface, image: Shape) -> bool:
    """The slope on the carrier, found by Newton steps from random points, is 1 when it is said to be."""
    points = points_around(image, 400)
    for _ in range(40):
        value, *slope = partials(surface.function, tuple(points.T), 1)
        slopes = np.array(slope).reshape(image.dimension, -1).T
        points = points - (value / np.maximum((slopes**2).sum(axis=1), 1e-12))[:, None] * slopes
    value, *slope = partials(surface.function, tuple(points.T), 1)
    near = (np.abs(value) < 1e-12) & np.isfinite(points).all(axis=1) & (np.abs(points).max(axis=1) < 5.0)
    lengths = np.sqrt((np.array(slope).reshape(image.dimension, -1) ** 2).sum(axis=0))[near]
    assert len(lengths) > 20
    return not surface.normalised or bool(np.abs(lengths - 1.0).max() < 1e-9)


@given(
    st.lists(st.floats(-2, 2), min_size=4, max_size=4).filter(lambda m: abs(m[0] * m[3] - m[1] * m[2]) > 0.1),
    st.lists(st.floats(-3, 3), min_size=2, max_size=2),
)
def test_affine_maps_keep_polynomials_areas_and_boxes(entries: list[float], shift: list[float]) -> None:
    matrix = np.array(entries).reshape(2, 2)
    image = affine(g.disk((0.3, -0.1), 0.7).named("d") & g.half_plane((0, 0), (1, 0)), matrix, shift)
    assert {surface.degree for surface in image.surfaces} == {1, 2}
    angle = np.linspace(0, 2 * pi, 400)
    rim = np.column_stack([0.3 + 0.7 * np.cos(angle), -0.1 + 0.7 * np.sin(angle)]) @ matrix.T + shift
    whole = affine(g.disk((0.3, -0.1), 0.7), matrix, shift).box
    np.testing.assert_allclose(whole.upper, rim.max(axis=0), rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(whole.lower, rim.min(axis=0), rtol=1e-3, atol=1e-3)


VOLUMES = {
    "ellipse": (affine(g.disk((0, 0), 1.0), [[2, 0.5], [0, 0.7]]), 1.4 * pi),
    "ring of a rectangle": (revolve(g.rectangle((1.0, 0.0), (2.0, 0.5))), 1.5 * pi),
    "torus": (revolve(g.disk((1.0, 0.0), 0.4)), 0.32 * pi**2),
    "eighth of a ring of an ellipse (Pappus)": (
        revolve(g.ellipse((1.0, 0.0), (0.5, 0.4))) & g.box((0, 0, 0), (2, 2, 1)),
        0.05 * pi**2,
    ),
    "ring of a triangle (Pappus)": (revolve(g.polygon([(0.5, 0), (1, 0), (0.8, 0.6)])), 0.23 * pi),
    "cone": (revolve(g.polygon([(0, 0), (1, 0), (0, 1)])), pi / 3),
    "ball of a half disk": (revolve(g.disk((0.0, 0.0), 1.0), axis=(1.0, 1.0, 0.0)), 4 / 3 * pi),
    "ellipsoid": (revolve(g.ellipse((0.0, 0.2), (1.0, 0.5))), 2 / 3 * pi),
    "slanted cylinder": (extrude(g.disk((0, 0), 0.5), (0.3, 0.2, 1.0)), 0.25 * pi),
    "screw": (screw(g.disk((0.2, 0.0), 0.4), 3.0, 1.0), 0.16 * pi),
    "twisted brick": (twist(g.box((-0.5, -0.2, 0), (0.5, 0.2, 1)), 1.0), 0.4),
    "frustum": (taper(g.box((-0.5, -0.2, 0), (0.5, 0.2, 1)), 0.0, 1.0, 0.5), 0.4 * 1.75 / 3),
    "copies": (repeat(g.disk((0, 0), 0.3), (1.0, 0.2), 3), 0.27 * pi),
    "folded": (repeat(g.disk((0, 0), 0.3), (1.0, 0.0), 3, "wave"), 0.27 * pi),
    "petals": (cyclic(g.disk((1.0, 0.0), 0.3), 5), 0.45 * pi),
    "folded petals": (cyclic(g.disk((1.0, 0.0), 0.3), 5, by="wave"), 0.45 * pi),
    "section of a torus": (section(g.torus((0, 0, 0), (0, 0, 1), 1.0, 0.4), (0, 0, 0), (0, 1, 0)), 0.32 * pi),
    "section of a box": (section(g.box((0, 0, 0), (1, 2, 3)), (0, 0, 1), (0, 0, 1)), 2.0),
    "shadow of a ball": (projection(g.ball((0, 0, 0), 1.0), (0, 0, 1), 5), pi),
}


@pytest.mark.parametrize("name", VOLUMES)
def test_volumes(name: str) -> None:
    shape, volume = VOLUMES[name]
    found = measure(shape, 5 if shape.dimension == 3 else 12, 5)
    assert found.volume == pytest.approx(volume, rel=2e-6)
    assert found.volume_by_divergence == pytest.approx(volume, rel=1e-4)


def test_a_polygon_through_the_axis_loses_its_negative_half() -> None:
    whole = revolve(g.rectangle((-3.0, 0.0), (1.0, 2.0)))
    points = np.random.default_rng(3).uniform(-3.2, 3.2, (4000, 3))
    cylinder = g.cylinder((0, 0, 1), (0, 0, 1), 1.0, 2.0)
    np.testing.assert_array_equal(whole.contains(points), cylinder.contains(points))
    assert {surface.degree for surface in whole.surfaces} == {1, 2}


@pytest.mark.parametrize("distance", [0.3, -0.3, 1.0, -1.0])
def test_circles_across_the_axis(distance: float) -> None:
    shape = g.disk((distance, 0.1), 1.0) | g.disk((2.0, 0.0), 0.1)
    points = np.random.default_rng(3).uniform(-2.2, 2.2, (4000, 3))
    np.testing.assert_array_equal(revolve(shape).contains(points), shape.contains(revolved_back(points)))
    assert all(surface.degree is not None for surface in revolve(shape).surfaces)


def test_revolved_lines_and_circles_stay_polynomials() -> None:
    degrees = {s.name: s.degree for s in revolve(PROFILE).surfaces if not s.auxiliary}
    assert degrees == {"tip.edge0": 1, "tip.edge1": 2, "tip.edge2": 2, "eye": 4}


@pytest.mark.parametrize("by", ["copies", "wave"])
def test_symmetric_shapes_may_be_folded_or_copied(by: str) -> None:
    petal = g.ellipse((0.8, 0.0), (0.3, 0.1)).named("petal")
    for count in (2, 3, 5, 8):
        flower = cyclic(petal, count, center=(0.1, 0.0), by=by)
        points = np.random.default_rng(4).uniform(-1.2, 1.2, (3000, 2))
        moved = petal.move((-0.1, 0.0)).contains
        expected = np.zeros(len(points), dtype=bool)
        for k in range(count):
            expected |= moved(turned(points - [0.1, 0.0], np.full(len(points), 2 * pi * k / count)))
        np.testing.assert_array_equal(flower.contains(points), expected)
        assert flower.parts == ("petal",)
        assert expected.sum() > 20


def test_the_wave_mirrors_every_other_shape() -> None:
    wedge = g.polygon([(0, 0), (0.6, 0), (0, 0.4)])
    row = repeat(wedge, (0.8, 0.0), 3, "wave")
    assert row.contains(np.array([[0.05, 0.3], [0.05 + 1.6, 0.3], [0.55 + 0.8, 0.3]])).all()
    assert not row.contains(np.array([[0.05 + 0.8, 0.3], [0.05 + 2.4, 0.3], [-0.55, 0.05]])).any()
    np.testing.assert_allclose(row.box.upper, [2.2, 0.4], atol=1e-12)


def test_fourier_series_approach_the_wave() -> None:
    petal = g.disk((0.8, 0.0), 0.2)
    points = np.random.default_rng(5).uniform(-1.0, 1.0, (2000, 2))
    exact = cyclic(petal, 6, by="wave").membership(*points.T)
    errors = [
        float(np.abs(cyclic(petal, 6, by="fourier", terms=n).membership(*points.T) - exact).max())
        for n in (2, 8, 32)
    ]
    assert errors[0] > 3 * errors[1] > 9 * errors[2]
    disk, window = g.disk((0.0, 0.0), 0.2), g.rectangle((-0.5, -0.5), (5.5, 0.5))
    row = repeat_series(disk, (1.0, 0.0), 60) & window
    points = np.random.default_rng(6).uniform((-0.5, -0.3), (5.5, 0.3), (20000, 2))
    assert row.contains(points).mean() == pytest.approx(6 * 0.04 * pi / 3.6, rel=3e-2)
    assert row.box.upper == (5.5, 0.2)


def test_sweeps_fill_up() -> None:
    exact = 0.09 * pi + 0.6
    missing = [
        exact - measure(sweep(g.disk((0, 0), 0.3), (1.0, 0.0), samples=n), 16, 5).volume for n in (5, 9, 17)
    ]
    assert missing[0] > 3 * missing[1] > 9 * missing[2] > 0
    turning = sweep(g.disk((1.0, 0.0), 0.2), angle=math.pi, samples=30)
    assert turning.contains(np.array([[0.0, 1.0], [-1.0, 0.0]])).all()


REFUSED = [
    (
        lambda: affine(LENS, [[1, 2], [2, 4]]),
        r"matrix must be nonsingular, got \[\[1, 2\], \[2, 4\]\] with determinant 0",
    ),
    (lambda: affine(LENS, [[1, 2]]), "matrix must have 2 rows, got 1"),
    (
        lambda: affine(LENS, [[1, 2, 3], [2, 4, 4]]),
        r"each row of matrix must have 2 components, got \[1, 2, 3\]",
    ),
    (lambda: screw(LENS, 0.0, 1.0), "pitch must not be 0: it is the height of a full turn"),
    (lambda: screw(LENS, 1.0, -1.0), "length must be positive, got -1"),
    (lambda: screw(BRICK, 1.0, 1.0), "a profile to be screwed must be two-dimensional, got a solid"),
    (lambda: twist(LENS, 1.0), "only a solid can be twisted"),
    (lambda: taper(BRICK, 0.0, 0.0, 0.5), "end must differ from start, both are 0"),
    (
        lambda: taper(BRICK, 0.0, 0.5, 0.4),
        r"tip at height 0.833333, inside the shape, which reaches from 0 to 1",
    ),
    (lambda: taper(g.half_space((0, 0, 0), (0, 0, 1)), 0, 1, 0.5), "only a bounded shape can be tapered"),
    (lambda: cyclic(LENS, 1), "count must be a whole number of at least 2, got 1"),
    (lambda: cyclic(LENS, 3, by="fourier", terms=0), "terms must be at least 1, got 0"),
    (lambda: cyclic(LENS, 3, by="x"), "by must be one of copies, wave, fourier, got 'x'"),
    (lambda: repeat(LENS, (0, 0), 2), "step must not be the zero vector"),
    (lambda: repeat(LENS, (1, 0), 1), "count must be a whole number of at least 2, got 1"),
    (lambda: repeat(LENS, (0.5, 0), 2, "wave"), "longer than the step"),
    (lambda: repeat_series(LENS, (3, 0), 0), "terms must be at least 1, got 0"),
    (
        lambda: extrude(LENS, (1, 0, 0)),
        r"direction must leave the plane of the profile, z is not 0, got \[1, 0, 0\]",
    ),
    (lambda: revolve(BRICK), "a profile to be revolved must be two-dimensional"),
    (lambda: revolve(g.disk((-2, 0), 1.0)), "the profile has no point with x > 0"),
    (lambda: revolve(g.half_plane((-1, 0), (1, 0))), "there is nothing to revolve"),
    (
        lambda: section(BRICK, (0, 0, 3), (0, 0, 1)),
        r"the plane through \[0, 0, 3\] across \[0, 0, 1\] misses the solid",
    ),
    (lambda: section(LENS, (0, 0, 3), (0, 0, 1)), "only a solid can be cut"),
    (lambda: projection(BRICK, (0, 0, 1), 0), "sections must be at least 1, got 0"),
    (lambda: projection(g.half_space((0, 0, 0), (0, 0, 1)), (0, 0, 1)), "bounded along the direction"),
    (lambda: sweep(LENS, (1, 0), samples=1), "samples must be a whole number of at least 2, got 1"),
    (lambda: sweep(LENS), "a sweep needs a motion"),
]


@pytest.mark.parametrize(("build", "message"), REFUSED)
def test_refused(build, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        build()
