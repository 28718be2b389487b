from __future__ import annotations

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
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rfm.calculus import partials
from rfm.errors import GeometryError
from rfm.geometry.boundaries import surface, triangle

CORNERS = np.array([[0.1, 0.2, -0.3], [1.0, 0.1, 0.2], [0.3, 1.1, 0.5]])
NORMAL = np.cross(CORNERS[1] - CORNERS[0], CORNERS[2] - CORNERS[0])
NORMAL /= np.linalg.norm(NORMAL)


def distance_to_triangle(corners):
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal /= np.linalg.norm(normal)

    def distance(points):
        inside, result = np.ones(len(points), dtype=bool), np.full(len(points), np.inf)
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            chord, rays = b - a, points - a
            share = np.clip(rays @ chord / (chord @ chord), 0.0, 1.0)
            result = np.minimum(result, np.linalg.norm(rays - np.outer(share, chord), axis=1))
            inside &= rays @ np.cross(normal, chord) >= 0.0
        return np.where(inside, np.abs((points - corners[0]) @ normal), result)

    return distance


def interior(corners, count=40):
    return np.random.default_rng(0).dirichlet([3, 3, 3], count) @ corners


def test_zero_on_it_unit_slope_across_it():
    w, inner = triangle(*CORNERS), interior(CORNERS)
    s = np.linspace(0, 1, 9)[:, None]
    edges = [a + s * (b - a) for a, b in zip(CORNERS, np.roll(CORNERS, 1, axis=0), strict=True)]
    check_zero(w, np.concatenate([inner, *edges]))
    normals = np.broadcast_to(NORMAL, inner.shape)
    check_slope(w, inner, normals)
    check_slope_on(w, inner, normals)
    points = cloud(CORNERS.mean(axis=0), 1.0)
    check_ratio(w, distance_to_triangle(CORNERS), points, 0.9, 3.5)
    check_jets(w, points[:50])
    check_intervals(w, points[:200], 0.02, least=0.5)


def test_smooth_above_the_corners():
    """Off the plane nothing happens on the perpendiculars through the corners, where R0 would have a kink."""
    w = triangle(*CORNERS)
    above = CORNERS[0] + 0.2 * NORMAL
    around = CORNERS - CORNERS[0]
    steps = np.concatenate([around[1:], -around[1:]]) * 1e-7
    slopes = partials(w, tuple((above + steps).T), 1)[1:]
    assert np.ptp(slopes, axis=1).max() < 1e-5
    assert np.abs(partials(w, tuple(above), 3)).max() < 1e3


def test_homogeneous_of_degree_one():
    points = cloud(CORNERS.mean(axis=0), 1.0)
    expected = 1e5 * triangle(*CORNERS)(*points.T)
    np.testing.assert_allclose(triangle(*(1e5 * CORNERS))(*(1e5 * points).T), expected, rtol=1e-9)


@settings(max_examples=30)
@given(arrays(np.float64, (3, 3), elements=st.floats(-3, 3, width=16)))
def test_random_triangles(corners):
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
    if area < 0.1 * sides.max() ** 2 or sides.max() < 1e-2:
        return  # the lower bound of the ratio depends on the smallest angle
    check_zero(triangle(*corners), interior(corners), 1e-13)
    points = np.random.default_rng(0).uniform(-6, 6, (200, 3))
    check_ratio(triangle(*corners), distance_to_triangle(corners), points, 0.1, 8.5)


def test_faces_that_share_an_edge():
    """Two faces under an angle: normalised on both, and zero on the edge."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0.4, 1, 0.2], [0.5, -0.2, 1]], dtype=float)
    faces = [[0, 1, 2], [0, 1, 3]]
    w = surface(vertices, faces)
    for face in faces:
        corners = vertices[face]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal = np.broadcast_to(normal / np.linalg.norm(normal), (40, 3))
        check_zero(w, interior(corners))
        check_slope(w, interior(corners), normal)
    check_zero(w, np.array([[0.3, 0, 0], [0.9, 0, 0]]))


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (
            [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]],
            [[0, 1, 2], [0, 1, 3]],
            r"triangle 1 is degenerate: its corners \[\[0, 0, 0\], \[1, 0, 0\], \[2, 0, 0\]\] lie on a line; "
            "leave it out",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [1, 0, 0]],
            [[0, 1, 2]],
            r"triangle 0 is degenerate: its corners .* lie on a line; leave it out",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
            [[0, 1, 3]],
            r"triangle 0 has the corners \[0, 1, 3\], but the vertices are numbered from 0 to 2",
        ),
        ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], "the vertices of a surface must be triples of numbers"),
        (
            [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
            [[0, 1]],
            "the triangles of a surface must be a list of triples of vertex numbers",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
            [[0, 1, 1.5]],
            "the triangles of a surface must be a list of triples of vertex numbers",
        ),
    ],
)
def test_bad_surfaces(vertices, faces, message):
    with pytest.raises(GeometryError, match=f"^{message}$"):
        surface(vertices, faces)
