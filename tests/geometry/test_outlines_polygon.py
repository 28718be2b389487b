"""Polygons: every edge once, the right set, numbering, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from boundary_sampling import boundary_points, sample_box
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from random_polygons import distances, inside, random_polygon, trial_points, with_flat_vertices

import rfm.geometry as g
from rfm.errors import GeometryError

L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
U_SHAPE = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
SPIRAL = [
    (0, 0),
    (6, 0),
    (6, 6),
    (1, 6),
    (1, 2),
    (4, 2),
    (4, 4),
    (3, 4),
    (3, 3),
    (2, 3),
    (2, 5),
    (5, 5),
    (5, 1),
    (0, 1),
]
SPLIT_SIDE = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (0, 1)]
COMB = [(0, 0), (7, 0), (7, 3), (6, 3), (6, 1), (5, 2), (4, 1), (3, 3), (2, 3), (2, 2), (1, 3), (0, 3)]
GALLERY = {"L": L_SHAPE, "U": U_SHAPE, "spiral": SPIRAL, "split": SPLIT_SIDE, "comb": COMB}


def winding_inside(vertices: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Even-odd rule, independent of the construction."""
    inside = np.zeros(len(points), dtype=bool)
    x, y = points.T
    for (x0, y0), (x1, y1) in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        if y0 == y1:
            continue
        across = (y0 > y) != (y1 > y)
        inside ^= across & (x < (x1 - x0) * (y - y0) / (y1 - y0) + x0)
    return inside


def check_set(vertices: np.ndarray) -> None:
    shape = g.polygon(vertices)
    points = sample_box(shape, 3000, margin=0.1)
    clear = np.abs(shape.membership(*points.T)) > 1e-9
    np.testing.assert_array_equal(shape.contains(points)[clear], winding_inside(vertices, points)[clear])


@pytest.mark.parametrize("name", GALLERY)
@pytest.mark.parametrize("step", [1, -1])
@pytest.mark.parametrize("start", [0, 1, 3])
def test_gallery(name: str, step: int, start: int) -> None:
    check_set(np.roll(np.array(GALLERY[name], dtype=float), start, axis=0)[::step])


@settings(max_examples=60, deadline=None)
@given(st.integers(3, 24), st.integers(0, 10_000), st.booleans())
def test_star_shaped(count: int, seed: int, clockwise: bool) -> None:
    random = np.random.default_rng(seed)
    angles = (np.arange(count) + random.uniform(0.1, 0.9, count)) * 2 * np.pi / count
    assume(np.diff(angles).max() < 3.0)
    radii = random.uniform(0.1, 1.0, count)
    vertices = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    check_set(vertices[::-1] if clockwise else vertices)
    literals = g.polygon(vertices).expression.literals()
    assert len(literals) == count
    assert len({literal.surface for literal in literals}) == count


@pytest.mark.parametrize("name", GALLERY)
@pytest.mark.parametrize("step", [1, -1])
def test_edge_i_runs_from_vertex_i_to_the_next(name: str, step: int) -> None:
    vertices = np.array(GALLERY[name], dtype=float)[::step]
    shape = g.polygon(vertices).named("p")
    assert {part for part in shape.parts if part != "p"} == {f"p.edge{i}" for i in range(len(vertices))}
    # not the middle: that of one edge may lie on the line of another
    middles = vertices + 0.37 * (np.roll(vertices, -1, axis=0) - vertices)
    for index, middle in enumerate(middles):
        part = shape.part(f"p.edge{index}")
        (surface,) = part.surfaces
        assert abs(surface.function(*middle)) < 1e-12
        on_line = np.abs([surface.function(*point) for point in middles]) < 1e-12
        selected = part.selects(middles) & on_line
        assert selected.tolist() == [i == index for i in range(len(middles))]


def test_every_line_is_one_surface() -> None:
    shape = g.polygon(U_SHAPE)
    assert len(shape.surfaces) == 7
    shared = next(surface for surface in shape.surfaces if surface.pieces)
    assert shared.name == "edge2+edge6"
    assert shape.part("edge2").where is not None
    # both pieces together are the whole surface again, and each is what the other leaves
    both = shape.part("edge2") | shape.part("edge6")
    assert (both.where, both.surfaces) == (None, frozenset([shared]))
    rest = shape.part("all") - shape.part("edge2")
    assert len(rest.pieces) == 2
    assert rest.pieces[1].where is shape.part("edge6").where
    assert shared not in (shape.part("all") - both).surfaces
    assert shared not in (rest - shape.part("edge6")).surfaces
    assert shape.part("all").where is None


def test_pieces_follow_a_motion() -> None:
    shape = g.polygon(SPLIT_SIDE).named("p").rotate(0.4).scale(2.0).move((1, -1))
    part = shape.part("p.edge1")
    (surface,) = part.surfaces
    points, _ = boundary_points(shape, surface)
    back = (points - [1, -1]) / 2.0
    along = np.cos(0.4) * back[:, 0] + np.sin(0.4) * back[:, 1]
    clear = (np.abs(along - 1) > 1e-9) & (np.abs(along - 2) > 1e-9)
    np.testing.assert_array_equal(part.selects(points)[clear], ((along > 1) & (along < 2))[clear])


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        ([(0, 0), (1, 0)], "at least 3 vertices, got 2"),
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "edge0 and edge2 cross at [0.5, 0.5]"),
        ([(0, 0), (1, 0), (1, 1), (0, 0)], "vertices 0 and 3 are the same point [0, 0]: edge3 has no length"),
        ([(0, 0), (1, 0), (0, 0), (1, 1)], "vertices 0 and 2 are the same point"),
        ([(0, 0), (1, 0), (2, 0)], "edge0 and edge2 fold back on each other"),
        ([(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)], "edge0 and edge2 touch at [1, 0]"),
        ([(0, 0), (2, 0), (1, 0), (1, 1)], "edge0 and edge1 fold back on each other at [2, 0]"),
        ([(0, 0), (1, float("nan")), (1, 1)], "vertices must be finite"),
        ([0, 1, 2], "list of pairs"),
        ([(0, 0), (1,), (1, 1)], "list of pairs"),
    ],
)
def test_refused(vertices: list[tuple[float, float]], message: str) -> None:
    with pytest.raises(GeometryError, match=re.escape(message)):
        g.polygon(vertices)


def test_a_thousand_vertices() -> None:
    angles = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    radii = 1.0 + 0.2 * np.sin(25 * angles)
    check_set(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1))


def check_rings(rings: list[np.ndarray], random: np.random.Generator, literals: int | None) -> None:
    """The sign everywhere off the boundary, and how many literals."""
    shape = g.polygon(rings[0], rings[1:])
    points = np.concatenate([trial_points(ring, random) for ring in rings])
    clear = np.min([distances(ring, points) for ring in rings], axis=0) > 1e-9
    expected = np.where(inside(rings, points), 1.0, -1.0)
    np.testing.assert_array_equal(np.sign(shape.membership(*points.T))[clear], expected[clear])
    if literals is not None:
        assert len(shape.expression.literals()) == literals == len(shape.surfaces)


@settings(max_examples=25)
@given(st.integers(3, 200), st.integers(0, 10_000), st.booleans())
def test_random_polygons(count: int, seed: int, clockwise: bool) -> None:
    random = np.random.default_rng(seed)
    vertices = random_polygon(count, random)
    check_rings([vertices[::-1] if clockwise else vertices], random, literals=count)


@settings(max_examples=25)
@given(st.integers(3, 60), st.integers(0, 10_000), st.sampled_from([0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-7]))
def test_nearly_collinear_edges(count: int, seed: int, shift: float) -> None:
    random = np.random.default_rng(seed)
    vertices = with_flat_vertices(random_polygon(count, random), shift, random)
    check_rings([vertices], random, literals=None)


@settings(max_examples=25)
@given(st.lists(st.integers(1, 4), min_size=2, max_size=60), st.integers(0, 100))
def test_many_edges_on_common_lines(heights: list[int], seed: int) -> None:
    corners = [(x, h) for x, h in enumerate(heights) for x in (x, x + 1)]
    kept = [p for i, p in enumerate(corners) if i == 0 or p != corners[i - 1]]
    base = [(x, 0) for x in range(len(heights), -1, -1)]
    check_rings([np.array([*kept, *base], dtype=float)], np.random.default_rng(seed), literals=None)


SQUARE = np.array([(0, 0), (6, 0), (6, 6), (0, 6)], dtype=float)


@settings(max_examples=20)
@given(st.integers(3, 40), st.integers(0, 10_000), st.booleans())
def test_holes_and_islands(count: int, seed: int, clockwise: bool) -> None:
    random = np.random.default_rng(seed)
    hole = 1.0 + 4.0 * np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    star = 2.0 + 2.0 * random_polygon(count, random)
    rings = [SQUARE, hole[::-1] if clockwise else hole, star[::-1] if clockwise else star]
    check_rings(rings, random, literals=8 + count)


def test_windows_on_common_lines() -> None:
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    holes = [corners + np.array([x, y]) for x in (1, 4) for y in (1, 4)]
    shape = g.polygon(SQUARE, holes)
    assert len(shape.surfaces) == 12
    check_rings([SQUARE, *holes], np.random.default_rng(0), literals=None)
    assert shape.part("hole1.edge0").where is not None
    named = shape.named("frame")
    assert {"frame.edge3", "frame.hole2", "frame.hole2.edge1"} <= set(named.parts)
    assert len(named.part("frame.hole2").surfaces) == 4


@pytest.mark.parametrize(
    ("holes", "message"),
    [
        ([[(7, 1), (8, 1), (8, 2)]], "hole0 is not inside the polygon: its vertex 0 [7, 1] lies outside"),
        (
            [[(5, 1), (7, 1), (5, 2)]],
            "the polygon is not simple: edge1 and hole0.edge0 cross at [6, 1]",
        ),
        (
            [[(1, 1), (3, 1), (3, 3)], [(2, 0.5), (4, 0.5), (2.5, 3.5)]],
            "the polygon is not simple: hole0.edge0 and hole1.edge2 cross at [2.08333, 1]",
        ),
        ([[(0, 1), (1, 1), (1, 2)]], "the polygon is not simple: edge3 and hole0.edge0 touch at [0, 1]"),
        ([[(1, 1), (2, 1)]], "hole0: a polygon needs at least 3 vertices, got 2"),
        (
            [[(1, 1), (1, 1), (2, 1)]],
            "hole0: vertices 0 and 1 are the same point [1, 1]: edge0 has no length",
        ),
    ],
)
def test_holes_refused(holes: list[list[tuple[float, float]]], message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        g.polygon(SQUARE, holes)
    assert str(caught.value) == message
