from __future__ import annotations

import numpy as np
import pytest
from boundary_checks import check_jets
from scipy.spatial import ConvexHull

from rfm.calculus import Interval, partials
from rfm.errors import GeometryError
from rfm.geometry.boundaries import segment, signed_surface, surface
from rfm.geometry.boundaries.solid_angle import winding_number

# an L-shaped prism: the polygon's triangles below and above, two triangles for every side
OUTLINE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
LID = np.array([[0, 1, 3], [1, 2, 3], [0, 3, 5], [3, 4, 5]])


def prism():
    vertices = np.concatenate([np.column_stack([OUTLINE, np.full(6, z)]) for z in (0.0, 1.0)])
    i = np.arange(6)
    j = (i + 1) % 6
    sides = np.concatenate([np.stack([i, j, j + 6], axis=1), np.stack([i, j + 6, i + 6], axis=1)])
    return vertices, np.concatenate([LID[:, ::-1], LID + 6, sides])


def polyhedron(seed=0, count=40):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull = ConvexHull(points)
    faces = hull.simplices.copy()
    normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    wrong = (normals * hull.equations[:, :3]).sum(axis=1) < 0
    faces[wrong] = faces[wrong][:, ::-1]
    return points, faces, hull.equations


@pytest.mark.parametrize("reverse", [False, True])
def test_a_body_that_is_not_convex(reverse):
    vertices, faces = prism()
    w = signed_surface(surface(vertices, faces[:, ::-1] if reverse else faces))
    x = np.random.default_rng(0).uniform(-0.5, 2.5, (3, 4000))
    inside = (
        (x[0] > 0)
        & (x[1] > 0)
        & (x[0] < 2)
        & (x[1] < 2)
        & ((x[0] < 1) | (x[1] < 1))
        & (x[2] > 0)
        & (x[2] < 1)
    )
    np.testing.assert_array_equal(w(*x) > 0.0, inside)
    number = winding_number(list(w.boundary.batches), *x[:, :500])
    np.testing.assert_allclose(number, np.where(inside[:500], -1.0 if reverse else 1.0, 0.0), atol=1e-12)


def test_slope_on_the_faces_themselves():
    points, faces, planes = polyhedron()
    w = signed_surface(surface(points, faces))
    weights = np.random.default_rng(1).dirichlet([3, 3, 3], len(faces))
    on = np.einsum("nk,nkd->nd", weights, points[faces])
    jet = partials(w, tuple(on.T), 1)
    assert np.abs(jet[0]).max() < 1e-15
    np.testing.assert_allclose(jet[1:].T, -planes[:, :3], atol=1e-13)


def test_jets_and_intervals():
    points, faces, planes = polyhedron()
    w = signed_surface(surface(points, faces))
    x = np.random.default_rng(0).uniform(-1.2, 1.2, (200, 3))
    depth = -(x @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    np.testing.assert_array_equal(w(*x.T) > 0.0, depth > 0.0)
    check_jets(w, x[np.abs(depth) > 0.02][:20])
    bounds = w(*[Interval(c - 0.01, c + 0.01) for c in x.T])
    clear = np.abs(depth) > 0.1
    np.testing.assert_array_equal((bounds.lo > 0.0)[clear], (depth > 0.0)[clear])
    np.testing.assert_array_equal((bounds.hi < 0.0)[clear], (depth < 0.0)[clear])


def test_triangles_listed_by_themselves_share_vertices():
    points, faces, _ = polyhedron()
    soup = points[faces].reshape(-1, 3) + 1e-13 * np.random.default_rng(0).normal(size=(3 * len(faces), 3))
    assert signed_surface(surface(soup, np.arange(len(soup)).reshape(-1, 3)))(0.0, 0.0, 0.0) > 0.0


TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        (
            FACES[:3],
            r"the surface is open: the edge from \[0, 0, 1\] to \[0, 1, 0\] belongs to triangle 2 only",
        ),
        (
            np.vstack([FACES, FACES[3, ::-1]]),
            r"the surface is no manifold: the edge from \[0, 0, 1\] to \[0, 1, 0\] belongs to triangles 2, 3, 4",
        ),
        (
            np.vstack([FACES[:3], FACES[3, ::-1]]),
            r"the edge from \[0, 0, 1\] to \[0, 1, 0\] is run through in the same sense by triangles 2, 3; "
            "reverse one",
        ),
    ],
)
def test_surfaces_without_inside(faces, message):
    with pytest.raises(GeometryError, match=f"^{message}$"):
        signed_surface(surface(TETRAHEDRON, faces))


def test_only_triangles_have_a_solid_angle():
    with pytest.raises(GeometryError, match=r"^the signed function of a surface needs triangles only$"):
        signed_surface(surface(TETRAHEDRON, FACES) | segment((0, 0, 0), (1, 1, 1)))
