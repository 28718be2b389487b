"""Outlines of lines and arcs: the set, the parts, the separators, the notations, what is refused."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from boundary_sampling import boundary_points
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.path import Path
from random_polygons import distances, random_polygon

import rfm.geometry as g
from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.outlines.arcs import bulge_of

Arcs = dict[int, dict[str, Any]]
HEXAGON = [(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)) for k in range(6)]
BAR = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 2), (0, 2)]
GALLERY: dict[str, tuple[list[tuple[float, float]], Arcs, int, int]] = {
    # vertices, arcs, literals, separators
    "circle": ([(-1, 0), (1, 0)], {0: {"bulge": 1}, 1: {"bulge": 1}}, 1, 0),
    "half disk": ([(-1, 0), (1, 0)], {1: {"bulge": 1}}, 2, 0),
    "lune": ([(0, -1), (0, 1)], {0: {"bulge": 1.5}, 1: {"bulge": -0.5}}, 2, 0),
    "three quarters": ([(0, 0), (1, 0), (0, -1)], {1: {"center": (0, 0)}}, 3, 0),
    "notch": (BAR, {1: {"bulge": -1}}, 5, 0),
    "bump": (BAR, {1: {"bulge": 1}}, 5, 0),
    "notch in a clockwise bar": (BAR[::-1], {3: {"bulge": 1}}, 5, 0),
    "slot": ([(0, 0), (3, 0), (3, 1), (0, 1)], {1: {"bulge": 1}, 3: {"bulge": 1}}, 6, 2),
    "mushroom": ([(0, 0), (1, 0), (1, 1), (0, 1)], {2: {"bulge": 3}}, 5, 1),
    "flower": (HEXAGON, {k: {"bulge": 1.2} for k in range(6)}, 12, 6),
    "star": (HEXAGON, {k: {"bulge": -0.3} for k in range(6)}, 9, 3),
}


def fine(vertices: Any, arcs: Arcs, steps: int = 2000) -> Array:
    """Polygon with many vertices on the arcs, from their bulges."""
    points: list[Array] = []
    corners = np.array(vertices, dtype=float)
    for index, (a, b) in enumerate(zip(corners, np.roll(corners, -1, axis=0), strict=True)):
        if index not in arcs:
            points.append(a[None])
            continue
        bulge = bulge_of(a, b, arcs[index], "arc")
        half = 2.0 * math.atan(bulge)
        # the point that sees a after s and b after (1 - s) of the sweep, by the law of sines
        s = np.linspace(0.0, 1.0, steps)[:-1, None]
        reach = np.sin(s * half) / math.sin(half) if abs(math.sin(half)) > 1e-9 else np.sin(s * half)
        angle = -(1.0 - s) * half
        x, y = b - a
        turned = np.hstack([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y])
        points.append(a + reach * turned)
    return np.concatenate(points)


def check(vertices: Any, arcs: Arcs, random: np.random.Generator) -> g.Shape:
    shape, border = g.outline(vertices, arcs), fine(vertices, arcs, 600)
    low, high = border.min(axis=0), border.max(axis=0)
    np.testing.assert_allclose([shape.box.lower, shape.box.upper], [low, high], atol=1e-4)
    near, far = random.uniform(low - 0.1, high + 0.1, (4000, 2)), random.uniform(low - 9, high + 9, (1000, 2))
    points = np.concatenate([near, far])
    values = shape.sign(*points.T)
    clear = np.abs(values) > 1e-4
    assert clear.mean() > 0.99
    np.testing.assert_array_equal((values > 0)[clear], Path(border).contains_points(points)[clear])
    return shape


@pytest.mark.parametrize("name", GALLERY)
def test_gallery(name: str) -> None:
    vertices, arcs, literals, separators = GALLERY[name]
    shape = check(vertices, arcs, np.random.default_rng(0))
    assert len(shape.expression.literals()) == literals
    assert sum(surface.auxiliary for surface in shape.surfaces) == separators
    assert set(shape.parts) == {f"edge{k}" for k in range(len(vertices))}


def test_an_inflection_without_corner() -> None:
    vertices = [(0, 0), (2, 0), (4, 0), (4, 2), (0, 2)]
    shape = check(vertices, {0: {"bulge": 0.5}, 1: {"bulge": -0.5}}, np.random.default_rng(0))
    for surface in shape.surfaces:
        if not surface.auxiliary:
            assert len(boundary_points(shape, surface, 200)[0]) > 3


@settings(max_examples=25)
@given(st.integers(3, 10), st.integers(0, 10_000), st.sampled_from([0.1, 0.4, 1.0]), st.booleans())
def test_random_outlines(count: int, seed: int, size: float, clockwise: bool) -> None:
    random = np.random.default_rng(seed)
    vertices = random_polygon(count, random)[:: -1 if clockwise else 1]
    arcs = {k: {"bulge": size * float(random.uniform(-1, 1))} for k in range(count) if random.random() < 0.6}
    try:
        shape = check(vertices, arcs, random)
    except GeometryError as error:
        assert re.fullmatch(  # noqa: PT017
            r"the outline is not simple: edge\d+ and edge\d+ meet at \[.*\]", str(error)
        )
        return
    # zero on the outline only: not on its lines and circles where they leave it
    points = np.concatenate([_on(surface, random) for surface in shape.surfaces])
    border = fine(vertices, arcs, 60)
    points = points[distances(border, points) > 0.05]
    expected = np.where(Path(border).contains_points(points), 1.0, -1.0)
    values = shape.sign(*points.T)
    assert (np.abs(values) > 1e-12).all()
    np.testing.assert_array_equal(np.sign(values), expected)


def _on(surface: g.Surface, random: np.random.Generator) -> Array:
    """Points on a line or circle."""
    carrier: Any = surface.function
    if hasattr(carrier, "radius"):
        angle = random.uniform(0, 2 * np.pi, 10)
        return np.asarray(carrier.center + carrier.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    normal = np.array(carrier.normal)
    along = np.array([-normal[1], normal[0]])
    middle = normal * (carrier.offset - normal @ [0.5, 0.5]) + [0.5, 0.5]
    return np.asarray(middle + random.uniform(-1, 1, (10, 1)) * along)


@pytest.mark.parametrize(
    "arc",
    [
        {"bulge": -1.0},
        {"through": (0, -1)},
        {"radius": -1},
        {"center": (0, 0), "clockwise": True},
        {"through": (-math.sqrt(0.5), -math.sqrt(0.5))},
    ],
)
def test_notations_of_a_half_circle(arc: dict[str, Any]) -> None:
    start, end = np.array([1.0, 0.0]), np.array([-1.0, 0.0])
    assert bulge_of(start, end, arc, "edge0") == pytest.approx(-1.0)


@given(st.floats(-3, 3).filter(lambda b: abs(b) > 0.01))
def test_notations_agree(bulge: float) -> None:
    from rfm.geometry.outlines.arcs import Edge

    start, end = np.array([1.0, 0.5]), np.array([-1.0, 0.2])
    edge = Edge(start, end, bulge, 0)
    assert bulge_of(start, end, {"through": edge.middle}, "e") == pytest.approx(bulge)
    assert bulge_of(start, end, {"center": edge.center, "clockwise": bulge < 0}, "e") == pytest.approx(bulge)
    if abs(bulge) < 0.99:
        radius = math.copysign(edge.radius, bulge)
        assert bulge_of(start, end, {"radius": radius}, "e") == pytest.approx(bulge)
    first, second = edge.halves()
    assert (first.center, first.radius) == (pytest.approx(edge.center), pytest.approx(edge.radius))
    assert second.radius == pytest.approx(edge.radius)


def test_arcs_on_one_circle_are_pieces_of_it() -> None:
    vertices = [(1, 0), (0, 1), (-1, 0), (0, -2)]
    shape = check(vertices, {0: {"radius": 1}, 1: {"center": (0, 0)}}, np.random.default_rng(0))
    (circle,) = (surface for surface in shape.surfaces if surface.pieces)
    assert circle.name == "edge0+edge1"
    points, _ = boundary_points(shape, circle)
    np.testing.assert_array_equal(shape.part("edge1").selects(points), points[:, 0] < 0)


@pytest.mark.parametrize(
    ("vertices", "arcs", "message"),
    [
        (BAR, {1: {}}, "edge1: an arc needs exactly one of bulge, through, radius, center"),
        (
            BAR,
            {1: {"bulge": 1, "radius": 2}},
            "edge1: an arc needs exactly one of bulge, through, radius, center",
        ),
        (
            BAR,
            {1: {"radius": 0.4}},
            "edge1: radius 0.4 is too small, its ends are 1 apart: at least 0.5 is needed",
        ),
        (
            BAR,
            {1: {"center": (1, 1)}},
            "edge1: the arc about [1, 1] does not reach its end: its ends are 1 and 1.41421 away",
        ),
        (BAR, {1: {"through": (3, 0)}}, "edge1: no arc passes through [3, 0] between its ends"),
        (BAR, {1: {"through": (1.5, 0)}}, "edge1: the arc is straight; leave it out of arcs"),
        (BAR, {7: {"bulge": 1}}, "there is no edge7: the edges are edge0 to edge5"),
        (BAR, {1: {"bulge": float("nan")}}, "edge1: bulge must be finite, got nan"),
        (BAR, {0: {"bulge": -5}}, "the outline is not simple: edge0 and edge4 meet at [1.5247, 2]"),
        (
            [(0, 0), (4, 0), (4, 1), (0, 1)],
            {0: {"bulge": -0.5}},
            "the outline is not simple: edge0 and edge2 meet at [2, 1]",
        ),
        ([(0, 0), (1, 0)], {}, "a polygon needs at least 3 vertices, got 2"),
        ([(0, 0)], {0: {"bulge": 1}}, "a polygon needs at least 2 vertices, got 1"),
        (
            [(0, 0), (1, 0), (1, 0), (0, 1)],
            {0: {"bulge": 0.1}},
            "vertices 1 and 2 are the same point [1, 0]: edge1 has no length",
        ),
    ],
)
def test_refused(vertices: Any, arcs: Arcs, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        g.outline(vertices, arcs)
    assert str(caught.value) == message


def test_a_cusp_is_refused() -> None:
    arcs = {0: {"center": (0, 1)}, 2: {"center": (0, 2), "clockwise": True}}
    with pytest.raises(GeometryError, match=r"edge2 comes too close to another edge near \[.*\] \(a cusp"):
        g.outline([(0, 0), (1, 1), (2, 2)], arcs)


@pytest.mark.parametrize(
    ("name", "area", "length"),
    [
        ("half disk", math.pi / 2, math.pi + 2),
        ("slot", 3 + math.pi / 4, 6 + math.pi),
        ("notch", 6 - math.pi / 8, 9 + math.pi / 2),
        ("bump", 6 + math.pi / 8, 9 + math.pi / 2),
        ("three quarters", 0.75 * math.pi, 2 + 1.5 * math.pi),
    ],
)
def test_areas_and_lengths(name: str, area: float, length: float) -> None:
    from solvers.shape_integrals.properties import properties

    vertices, arcs, _, _ = GALLERY[name]
    found = properties(g.outline(vertices, arcs))
    assert found.volume == pytest.approx(area, rel=1e-7)
    assert found.surface == pytest.approx(length, rel=1e-6)
