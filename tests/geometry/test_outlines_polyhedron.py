"""Polyhedra: the set by crossings of rays, every plane once, the parts, volumes, proper signs, what is refused."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from boundary_sampling import boundary_points
from hypothesis import given, settings
from hypothesis import strategies as st
from random_polygons import random_polygon

import rfm.geometry as g
from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.outlines.polyhedron import MOST_PLANES
from solvers.shape_integrals.properties import properties

Given = tuple[list[tuple[float, float, float]], list[list[int]]]
CUBE = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
SIDES = [[0, 1, 2, 3], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
ROOF = [[4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]]
TETRAHEDRON: Given = (
    [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    [[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]],
)


def prism(polygon: Any) -> Given:
    """Prism of height 1 over a polygon."""
    n = len(polygon)
    points = [(x, y, z) for z in (0, 1) for x, y in polygon]
    walls = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return points, [list(range(n)), list(range(n, 2 * n)), *walls]


def twisted() -> Given:
    """Schoenhardt's polyhedron: no diagonal lies inside, no tetrahedra without new vertices."""
    turns = [2 * np.pi * k / 3 for k in range(3)]
    points = [(np.cos(t), np.sin(t), 0) for t in turns]
    points += [(np.cos(t + 0.5), np.sin(t + 0.5), 1) for t in turns]
    lower = [[i, (i + 1) % 3, 3 + (i + 1) % 3] for i in range(3)]
    return points, [[0, 1, 2], [3, 4, 5], *lower, *[[i, 3 + (i + 1) % 3, 3 + i] for i in range(3)]]


L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
U_SHAPE = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
CAVITY: Given = (
    [*CUBE, *[(0.3 * x + 0.5, 0.3 * y + 0.6, 0.3 * z + 0.7) for x, y, z in CUBE]],
    [face for shift in (0, 8) for face in [[k + shift for k in side] for side in [*SIDES, [4, 5, 6, 7]]]],
)
GALLERY: dict[str, tuple[Given, int | None, float]] = {
    # given, literals when every plane occurs once, volume
    "tetrahedron": (TETRAHEDRON, 4, 1 / 6),
    "cube": ((CUBE, [*SIDES, [7, 6, 5, 4]]), 6, 8),
    "house": (([*CUBE, (1, 1, 3)], [*SIDES, *ROOF]), 9, 8 + 4 / 3),
    "dent": (([*CUBE, (1, 1, 0.8)], [*SIDES, *ROOF]), 9, 8 - 1.6),
    "two dents": (
        ([*CUBE, (1, 1, 1.2), (1, 1, 0.5)], [*SIDES[1:], *ROOF, *[[i, (i + 1) % 4, 9] for i in range(4)]]),
        12,
        8 - 4 / 3 * 0.8 - 4 / 3 * 0.5,
    ),
    "L": (prism(L_SHAPE), 8, 3),
    "U": (prism(U_SHAPE), 9, 5),
    "cavity": (CAVITY, 12, 8 * (1 - 0.027)),
    "twisted": (twisted(), None, 0.0),
}


def crossings(given: Given, points: Array) -> Array:
    """Parity of the crossings of a ray in a generic direction with the fans of the faces."""
    vertices, inside = np.array(given[0], dtype=float), np.zeros(len(points), dtype=bool)
    ray = np.array([0.5391, 0.3172, 0.7803])
    for face in given[1]:
        for second, third in pairwise(face[1:]):
            a, b, c = vertices[[face[0], second, third]]
            normal = np.cross(b - a, c - a)
            t = ((a - points) @ normal) / (ray @ normal)
            hit = points + t[:, None] * ray - a
            u, v = b - a, c - a
            gram = np.array([[u @ u, u @ v], [u @ v, v @ v]])
            share = np.linalg.solve(gram, np.stack([hit @ u, hit @ v]))
            inside ^= (t > 0) & (share > 0).all(axis=0) & (share.sum(axis=0) < 1)
    return inside


def check(given: Given, seed: int = 0) -> g.Shape:
    shape = g.polyhedron(*given)
    random = np.random.default_rng(seed)
    low, high = np.array(shape.box.lower), np.array(shape.box.upper)
    points = np.concatenate(
        [random.uniform(low - 0.2, high + 0.2, (3000, 3)), random.uniform(low - 9, high + 9, (500, 3))]
    )
    np.testing.assert_array_equal(shape.contains(points), crossings(given, points))
    return shape


@pytest.mark.parametrize("name", GALLERY)
def test_gallery(name: str) -> None:
    given, literals, _ = GALLERY[name]
    shape = check(given)
    if literals is not None:
        assert len(shape.expression.literals()) == len(shape.surfaces) == literals
    assert set(shape.parts) == {f"face{k}" for k in range(len(given[1]))}
    random = np.random.default_rng(1)
    turned = [face[::-1] if random.random() < 0.5 else face for face in given[1]]
    check((given[0], turned))


@pytest.mark.parametrize("name", ["tetrahedron", "dent", "L", "cavity"])
def test_volumes(name: str) -> None:
    given, _, volume = GALLERY[name]
    assert properties(g.polyhedron(*given)).volume == pytest.approx(volume, rel=1e-6)


@settings(max_examples=8)
@given(st.integers(3, 7), st.integers(0, 1000))
def test_prisms_over_random_polygons(count: int, seed: int) -> None:
    check(prism(random_polygon(count, np.random.default_rng(seed)).tolist()), seed)


@settings(max_examples=8)
@given(st.integers(4, 15), st.integers(0, 1000))
def test_convex_hulls(count: int, seed: int) -> None:
    from scipy.spatial import ConvexHull

    points = np.random.default_rng(seed).normal(size=(count, 3))
    hull = ConvexHull(points)
    used = np.unique(hull.simplices)
    faces = np.searchsorted(used, hull.simplices).tolist()
    shape = check((points[used].tolist(), faces), seed)
    assert len(shape.expression.literals()) == len(faces)


@pytest.mark.slow
def test_the_sides_of_a_cube_with_six_dents_help_to_find_its_expression() -> None:
    points, faces = [*CUBE], []
    for side in [*SIDES, [4, 5, 6, 7]]:
        middle = np.mean([CUBE[k] for k in side], axis=0)
        points.append(tuple((middle - 0.6 * (middle - 1)).tolist()))
        faces += [[side[i], side[(i + 1) % 4], len(points) - 1] for i in range(4)]
    shape = check((points, faces))
    assert not any(surface.auxiliary for surface in shape.surfaces)
    assert len(shape.expression.literals()) == len(shape.surfaces) == len(shape.parts) == 24


def test_faces_in_one_plane_are_pieces_of_it() -> None:
    shape = g.polyhedron(*prism(U_SHAPE)).named("u")
    (surface,) = (surface for surface in shape.surfaces if surface.pieces)
    points, _ = boundary_points(shape, surface)
    np.testing.assert_array_equal(shape.part("u.face4").selects(points), points[:, 0] > 2)
    moved = shape.rotate(0.3, axis=(1, 2, 3)).move((1, 0, 0))
    assert len(moved.part("u.face8").surfaces) == 1


def test_zero_on_the_boundary_only() -> None:
    shape = g.polyhedron(*prism(L_SHAPE))
    # on the planes of the notch, inside and outside of the solid
    for point, inside in [((1, 0.5, 0.5), 1), ((0.5, 1, 0.5), 1), ((1, 2.5, 0.5), -1), ((1, 3, 1), -1)]:
        assert np.sign(shape.sign(*point)) == inside
    assert shape.sign(1, 1.5, 0.5) == 0.0


def test_the_difference_of_two_functions_is_properly_signed() -> None:
    touching = g.box((0, 0, 0), (1, 1, 1)) | g.box((1, 0, 0), (2, 1, 1))
    outside = ~g.box((0, 0, 0), (2, 1, 1))
    points = np.random.default_rng(0).uniform(-0.5, 2.5, (2000, 3))
    for system in ("r1", "r0"):
        function = g.signed_difference(touching.using(system), outside.using(system))
        assert touching.using(system).membership(1.0, 0.5, 0.5) <= 0.0
        assert function(1.0, 0.5, 0.5) > 0.0
        assert function(0.0, 0.5, 0.5) == pytest.approx(0.0, abs=1e-15)
        np.testing.assert_array_equal(function(*points.T) > 0, ~outside.contains(points))
    with pytest.raises(GeometryError, match="the negation of the same expression"):
        g.signed_difference(touching, ~touching)
    with pytest.raises(GeometryError, match="the set has dimension 3, the complement 2: they must be equal"):
        g.signed_difference(touching, g.disk((0, 0), 1))


def changed(vertex: int, place: tuple[float, float, float]) -> Given:
    points = [place if k == vertex else point for k, point in enumerate(CUBE)]
    return points, [*SIDES, [4, 5, 6, 7]]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((CUBE, SIDES), "the polyhedron is open: edge 4-5 belongs to face1 only"),
        (
            ([*CUBE, (1, 1, 3)], [*SIDES, [4, 5, 6, 7], *ROOF]),
            "the polyhedron is not a manifold: edge 4-5 belongs to face1, face5, face6",
        ),
        (changed(6, (2, 2, 2.1)), "face5 is not plane: vertex 4 lies 0.0249844 off its mean plane"),
        (changed(6, (0, 0, 0)), "vertices 0 and 6 are the same point [0, 0, 0]"),
        ((CUBE, [*SIDES, [4, 5, 6, 9]]), "face5 has vertex 9: the vertices are 0 to 7"),
        ((CUBE, [*SIDES, [4, 5, 6, 5]]), "face5 has vertex 5 twice"),
        ((CUBE, [*SIDES, [4, 5]]), "face5 needs at least 3 vertices, got 2"),
        ((CUBE, [*SIDES, [4, 6, 5, 7]]), "face5 has no area"),
        ((CUBE, SIDES[:3]), "a polyhedron needs at least 4 faces, got 3"),
        (([(0, 0, 0), (1, 0)], SIDES), "vertices must be a list of triples of numbers"),
        ((np.full((4, 3), np.inf), TETRAHEDRON[1]), "vertices must be finite"),
        (
            ([*CUBE, (1, 1, -0.5)], [*SIDES, *ROOF]),
            "face0 and face5 cross: edge 5-8 meets face0 at [1.2, 0.8, 0]",
        ),
        (
            prism([(0, 0), (2, 2), (2, 0), (0, 3)]),
            "face0 is not simple: its edge0 and edge2 cross",
        ),
    ],
)
def test_refused(given: Any, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        g.polyhedron(*given)
    assert str(caught.value) == message


def test_too_many_planes() -> None:
    angles = np.linspace(0, 2 * np.pi, 34, endpoint=False)
    radii = np.where(np.arange(34) % 2, 1.0, 0.7)
    star = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    message = f"a polyhedron that is not convex may have {MOST_PLANES} planes, got 36; divide it"
    with pytest.raises(GeometryError, match=message):
        g.polyhedron(*prism(star.tolist()))
