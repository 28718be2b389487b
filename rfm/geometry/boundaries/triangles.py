r"""Triangles in space and surfaces made of them.

Notation: f is the signed distance to the plane of a triangle, e_1, e_2, e_3 the signed distances to the three planes
through its sides perpendicular to it, positive inside.  The *trim volume* is their conjunction.  A plain
R_0-conjunction would have a kink along the whole perpendicular through each corner, far from the triangle
too; but only its values where f = 0 matter, so the conjunction is made under that condition:

    c(a, b) = a + b - sqrt(a^2 + b^2 + q^2),   q = f^2 / sqrt(l^2 + f^2),   t = c(c(e_1, e_2), e_3),

the R_0-conjunction in the plane f = 0 and analytic off it.  (Shapiro calls R-functions that are asked for under a
condition *conditional*, [1], (3.7), and trims faces with one, section 5.)  The plane is then trimmed by t.

Reference: [1] Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), sections 3 and 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry.boundaries.ends import conjunction_on_carrier, trimmed_carrier
from rfm.geometry.boundaries.pieces import Joined, Sided, dot
from rfm.geometry.boundaries.segments import checked_points
from rfm.geometry.checks import shown

FLAT = 1e-10
"""Height of a triangle, relative to its longest side, below which it is degenerate."""


@dataclass(frozen=True, eq=False)
class Triangles(Sided):
    """Triangles with corners (n, 3, 3), unit normals (n, 3) and, in their planes, inward normals of the sides.

    Side k runs from corner k to the next; `inward` is (n, 3, 3), `height` (n,) the value of the second side's
    function at the first corner.
    """

    corners: Array
    normal: Array
    inward: Array
    height: Array

    @property
    def size(self) -> Array:
        """Longest side."""
        return np.asarray(np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=1), axis=2).max(axis=1))

    def functions(self, *coords: Value) -> Value:
        """See :class:`Pieces`."""
        offsets = [x - c for x, c in zip(coords, self.corners[:, 0].T, strict=True)]
        f = dot(offsets, self.normal.T)
        first, second, third = (dot(offsets, self.inward[:, k].T) for k in range(3))
        squared, size = f * f, self.size
        t = conjunction_on_carrier(first, second + self.height, squared, size)
        return trimmed_carrier(f, conjunction_on_carrier(t, third, squared, size), size)

    def side(self, *coords: Array) -> Array:
        """Signed distance to the planes."""
        side: Array = dot([x - c for x, c in zip(coords, self.corners[:, 0].T, strict=True)], self.normal.T)
        return side

    def samples(self) -> tuple[Array, Array]:
        """Centroids and normals."""
        return self.corners.mean(axis=1), self.normal


def triangle(a: Sequence[float], b: Sequence[float], c: Sequence[float]) -> Joined:
    """Triangle in space by its corners.

    Raises
    ------
    GeometryError
        When the corners lie on a line.
    """
    return surface([a, b, c], [[0, 1, 2]])


def surface(
    vertices: Sequence[Sequence[float]] | Array,
    triangles: Sequence[Sequence[int]] | NDArray[np.integer],
    *,
    p: int = 2,
) -> Joined:
    """Join triangles in space: any set of them, open or closed, manifold or not.

    Parameters
    ----------
    vertices
        Points (m, 3).
    triangles
        Indices of the corners of each (n, 3).
    p
        Order of the R-equivalence (5.3).

    Raises
    ------
    GeometryError
        For a degenerate triangle and indices that are none, by the number of the triangle.
    """
    points = checked_points(vertices, "a surface", 3)
    if points.shape[1] != 3:
        raise GeometryError("the vertices of a surface must be triples of numbers")
    indices = np.asarray(triangles)
    if indices.ndim != 2 or indices.shape[1] != 3 or not len(indices) or indices.dtype.kind not in "iu":
        raise GeometryError("the triangles of a surface must be a list of triples of vertex numbers")
    wrong = np.flatnonzero(((indices < 0) | (indices >= len(points))).any(axis=1))
    if len(wrong):
        raise GeometryError(
            f"triangle {wrong[0]} has the corners {shown(indices[wrong[0]])}, but the vertices are numbered "
            f"from 0 to {len(points) - 1}"
        )
    return Joined((faces(points[indices]),), p)


def faces(corners: Array) -> Triangles:
    """Batch of the triangles with corners (n, 3, 3); refuses degenerate ones."""
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(sides, axis=2)
    crosses = np.cross(sides[:, 0], sides[:, 1])
    areas = np.linalg.norm(crosses, axis=1)
    flat = np.flatnonzero(areas <= FLAT * lengths.max(axis=1) ** 2)
    if len(flat):
        raise GeometryError(
            f"triangle {flat[0]} is degenerate: its corners {shown(corners[flat[0]])} lie on a line; leave it out"
        )
    normal = crosses / areas[:, None]
    inward = np.cross(normal[:, None], sides / lengths[:, :, None])
    height = areas / lengths[:, 1]
    return Triangles(corners, normal, inward, height)
