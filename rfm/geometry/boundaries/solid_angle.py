r"""Signed functions of closed triangulated surfaces, by the solid angle.

Notation: a, b, c are the vectors from a point to the corners of a triangle; it subtends the solid angle O with

    tan(O/2) = a . (b x c) / (|a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b|)          [1]

and the winding number of the surface about the point is sum O / (4 pi): 1 inside a closed surface whose
normals point outward, -1 when they point inward, 0 outside; for nested surfaces the sum.

Reference: [1] A. van Oosterom, J. Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 30
(1983) 125-126.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.boundaries.pieces import Joined, dot, in_chunks
from rfm.geometry.boundaries.signed import Signed, with_sign
from rfm.geometry.boundaries.triangles import Triangles
from rfm.geometry.checks import shown

SAME_POINT = 1e-10
"""Corners closer than this, relative to the extent of the surface, are one vertex."""


def signed_surface(boundary: Joined) -> Signed:
    """Signed field of closed surfaces made of triangles, positive inside.

    The surfaces may have their normals outward or inward; corners that coincide are one vertex, as in files
    that list every triangle by itself.

    Raises
    ------
    GeometryError
        When the pieces are not triangles, when an edge has only one triangle (the surface is open) or more than
        two (it is no manifold), or when two neighbours have opposite orientations; each names the edge.
    """
    batches = [batch for batch in boundary.batches if isinstance(batch, Triangles)]
    if len(batches) != len(boundary.batches):
        raise GeometryError("the signed function of a surface needs triangles only")
    corners = np.concatenate([batch.corners for batch in batches])
    _check_closed(corners)

    def winding(x: Array, y: Array, z: Array) -> Array:
        return winding_number(batches, x, y, z)

    return with_sign(boundary, winding, float(np.abs(corners).max()))


def winding_number(batches: list[Triangles], x: Array, y: Array, z: Array) -> Array:
    """Winding number of triangles about points: a whole number when they form closed surfaces."""

    def number(*coords: Array) -> Array:
        wide = [c[:, None] for c in coords]
        blocks = (block for batch in batches for block in batch.blocks(coords[0].size))
        return np.asarray(sum(_half_angles(block, wide) for block in blocks)) * (0.5 / np.pi)

    return in_chunks(number, (x, y, z))


def _half_angles(block: Triangles, coords: list[Array]) -> Array:
    a, b, c = ([p - x for p, x in zip(block.corners[:, k].T, coords, strict=True)] for k in range(3))
    lengths = [np.sqrt(dot(v, v)) for v in (a, b, c)]
    cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
    below = lengths[0] * lengths[1] * lengths[2]
    below = below + dot(a, b) * lengths[2] + dot(b, c) * lengths[0] + dot(c, a) * lengths[1]
    angles: Array = np.arctan2(dot(a, cross), below).sum(axis=1)
    return angles


def _check_closed(corners: Array) -> None:
    """Refuse a surface that is open, branches or is not oriented, by the edge."""
    indices, points = _merged(corners)
    edges = np.stack([indices, np.roll(indices, -1, axis=1)], axis=2).reshape(-1, 2)
    keys, of_edge, counts = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    of_edge = of_edge.reshape(-1)
    balance = np.bincount(of_edge, weights=np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0))
    tests = (
        (counts == 1, "the surface is open: the edge from {} to {} belongs to triangle {} only"),
        (counts > 2, "the surface is no manifold: the edge from {} to {} belongs to triangles {}"),
        (
            balance != 0,
            "the edge from {} to {} is run through in the same sense by triangles {}; reverse one",
        ),
    )
    for wrong, message in tests:
        if wrong.any():
            edge = int(np.flatnonzero(wrong)[0])
            owners = ", ".join(str(i // 3) for i in np.flatnonzero(of_edge == edge))
            ends = (shown(points[vertex]) for vertex in keys[edge])
            raise GeometryError(message.format(*ends, owners))


def _merged(corners: Array) -> tuple[NDArray[np.intp], Array]:
    """Vertex number of each corner (n, 3), and the points; corners that coincide have one number."""
    from scipy.spatial import cKDTree

    points = corners.reshape(-1, 3)
    extent = float(np.ptp(points, axis=0).max())
    unique, inverse = np.unique(points, axis=0, return_inverse=True)
    near = cKDTree(unique).query_ball_point(unique, SAME_POINT * extent)
    first = np.array([min(group) for group in near])
    return first[inverse.reshape(-1)].reshape(-1, 3), unique
