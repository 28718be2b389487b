"""Every primitive: sign, tight box, normalised slopes, part names, checked arguments."""

from __future__ import annotations

import numpy as np
import pytest
from boundary_sampling import boundary_points, sample_box

import rfm.geometry as g
from rfm.calculus.jets import partials
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape

BOUNDED: dict[str, tuple[Shape, tuple[str, ...]]] = {
    "disk": (g.disk((0.3, -0.2), 0.7), ()),
    "ellipse": (g.ellipse((0.3, -0.2), (0.7, 0.2), 0.6), ()),
    "rectangle": (g.rectangle((-1, 0), (0.5, 2)), ("left", "right", "bottom", "top")),
    "polygon": (g.polygon([(0, 0), (2, 1), (0, 3), (0.5, 1)]), ("edge0", "edge1", "edge2", "edge3")),
    "ball": (g.ball((0.1, 0.2, 0.3), 0.5), ()),
    "ellipsoid": (g.ellipsoid((0, 1, 0), (0.5, 1.0, 0.25), 0.4, (1, 2, 0)), ()),
    "box": (g.box((0, 0, 0), (1, 2, 3)), ("left", "right", "front", "back", "bottom", "top")),
    "cylinder": (g.cylinder((0, 1, 0), (1, 2, -1), 0.5, 2.0), ("lateral", "bottom", "top")),
    "cone": (g.cone((0, 0, 1), (1, 1, 1), 0.5, 2.0), ("lateral", "base")),
    "torus": (g.torus((0, 0, 1), (1, -1, 2), 1.0, 0.3), ()),
    "function": (g.function(lambda x, y: 1.0 - x**4 - y**4, g.Box((-1, -1), (1, 1))), ()),
}

UNBOUNDED: dict[str, tuple[Shape, g.Box]] = {
    "half_plane": (g.half_plane((0, 2), (0, -3)), g.Box((-np.inf, -np.inf), (np.inf, 2))),
    "oblique half_plane": (g.half_plane((0, 2), (1, -3)), g.Box((-np.inf, -np.inf), (np.inf, np.inf))),
    "half_space": (g.half_space((0, 2, 1), (1, 0, 0)), g.Box((0, -np.inf, -np.inf), (np.inf,) * 3)),
    "strip": (g.strip((0, 1), (0, 1), 0.5), g.Box((-np.inf, 0.75), (np.inf, 1.25))),
    "slab": (g.slab((0, 0, 1), (0, 0, 2), 1), g.Box((-np.inf, -np.inf, 0.5), (np.inf, np.inf, 1.5))),
    "cylinder": (g.cylinder((1, 1, 5), (0, 0, 1), 0.5), g.Box((0.5, 0.5, -np.inf), (1.5, 1.5, np.inf))),
}


@pytest.mark.parametrize("kind", BOUNDED)
def test_part_names(kind: str) -> None:
    shape, names = BOUNDED[kind]
    assert shape.parts == names


@pytest.mark.parametrize("kind", BOUNDED)
def test_box_is_tight(kind: str) -> None:
    shape, _ = BOUNDED[kind]
    points = sample_box(shape, 100_000, margin=0.1)
    inside = points[shape.contains(points)]
    assert shape.box.contains(g.Box(tuple(inside.min(axis=0)), tuple(inside.max(axis=0))))
    # every side is touched by the boundary
    ends = np.concatenate([boundary_points(shape, s, 6000)[0] for s in shape.surfaces])
    ends = np.concatenate([ends, inside])
    slack = np.minimum(ends.min(axis=0) - shape.box.lower, np.array(shape.box.upper) - ends.max(axis=0))
    assert slack.min() > -1e-9
    assert slack.max() < 0.03 * max(shape.box.size)


@pytest.mark.parametrize("kind", BOUNDED)
def test_box_stays_tight_under_rotation(kind: str) -> None:
    """The reach is rotated, not the box: turning there and back gives the first box."""
    shape, _ = BOUNDED[kind]
    axis = None if shape.dimension == 2 else (1.0, 2.0, -0.5)
    back = shape.rotate(0.7, axis).rotate(-0.7, axis)
    np.testing.assert_allclose(
        [*back.box.lower, *back.box.upper], [*shape.box.lower, *shape.box.upper], atol=1e-12
    )


@pytest.mark.parametrize("kind", UNBOUNDED)
def test_box_of_unbounded(kind: str) -> None:
    shape, box = UNBOUNDED[kind]
    np.testing.assert_allclose([*shape.box.lower, *shape.box.upper], [*box.lower, *box.upper])
    assert not shape.box.finite


@pytest.mark.parametrize("kind", BOUNDED)
def test_normalised_surfaces_have_unit_slope(kind: str) -> None:
    shape, _ = BOUNDED[kind]
    for surface in shape.surfaces:
        if surface.auxiliary:
            continue
        points, normals = boundary_points(shape, surface)
        slope = (partials(surface.function, tuple(points.T), 1)[1:] * normals.T).sum(axis=0)
        assert slope.min() > 0.01
        if surface.normalised:
            np.testing.assert_allclose(slope, 1.0, atol=1e-12)


@pytest.mark.parametrize("kind", BOUNDED)
def test_degree_is_a_bound_in_any_orientation(kind: str) -> None:
    """Differences of order degree + 1 along random lines vanish, those of order degree do not."""
    shape, _ = BOUNDED[kind]
    random = np.random.default_rng(1)
    for surface in shape.surfaces:
        if surface.degree is None:
            continue
        start, step = random.normal(size=(2, shape.dimension))
        values = surface.function(*(start[:, None] + 0.3 * step[:, None] * np.arange(8)))
        assert np.abs(np.diff(values, surface.degree + 1)).max() < 1e-11 * np.abs(values).max()
        assert np.abs(np.diff(values, surface.degree)).max() > 1e-6


def test_torus_agrees_with_the_distance_to_its_circle() -> None:
    shape = g.torus((0, 0, 0), (0, 0, 1), 1.0, 0.4)
    points = sample_box(shape, 20_000, margin=0.2)
    across = np.hypot(points[:, 0], points[:, 1])
    np.testing.assert_array_equal(shape.contains(points), np.hypot(across - 1.0, points[:, 2]) < 0.4)


def test_cone_has_one_nappe() -> None:
    shape = g.cone((0, 0, 0), (0, 0, 1), 1.0, 2.0)
    points = np.random.default_rng(0).uniform(-3, 3, (20_000, 3))
    height = points[:, 2]
    expected = (height > 0) & (height < 2) & (np.hypot(points[:, 0], points[:, 1]) < 0.5 * height)
    np.testing.assert_array_equal(shape.contains(points), expected)
    assert len(shape.surfaces) == 3
    assert len(shape.part("all").surfaces) == 2


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: g.disk((0, 0), -1), "radius must be positive, got -1"),
        (lambda: g.disk((0, 0), 0), "radius must be positive, got 0"),
        (lambda: g.disk((0, 0), float("nan")), "radius must be finite, got nan"),
        (lambda: g.disk((0, 0), "big"), "radius must be a number, got 'big'"),
        (lambda: g.disk((0, 0, 0), 1), r"center must have 2 components, got \[0, 0, 0\]"),
        (lambda: g.ball((0, 0), 1), "center must have 3 components"),
        (lambda: g.ellipse((0, 0), (1, -2)), r"semi_axes must be positive, got \[1, -2\]"),
        (lambda: g.rectangle((0, 0), (1, 0)), "max must exceed min in every component"),
        (lambda: g.half_plane((0, 0), (0, 0)), "normal must not be the zero vector"),
        (lambda: g.strip((0, 0), (1, 0), -2), "width must be positive, got -2"),
        (lambda: g.cylinder((0, 0, 0), (0, 0, 1), 1, 0), "height must be positive, got 0"),
        (lambda: g.cone((0, 0, 0), (0, 0, 1), -1, 1), "radius must be positive"),
        (lambda: g.torus((0, 0, 0), (0, 0, 1), 1, 2), "minor_radius must be smaller than major_radius"),
        (lambda: g.function(lambda x, y: x), "needs a box"),
        (lambda: g.function(lambda x, y: x, dimension=4), "dimension must be 2 or 3, got 4"),
        (lambda: g.function(lambda x, y: x, ((0, 0), (-1, 1))), "max must exceed min"),
        (lambda: g.ellipse((0, 0), (1, 2), float("inf")), "angle must be finite"),
    ],
)
def test_refused(build: object, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        build()  # type: ignore[operator]


def test_registry_has_every_kind() -> None:
    assert set(g.KINDS) == {
        *("half_plane", "disk", "ellipse", "rectangle", "strip", "polygon", "outline", "curve", "function"),
        "interval",
        *("half_space", "ball", "ellipsoid", "box", "slab", "cylinder", "cone", "torus", "polyhedron"),
    }
