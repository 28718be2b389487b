"""Polyhedra given by vertices and faces: checks, planes, and which points lie inside.

Notation: face k is a closed chain of vertices in one plane; edge i-j is the segment between vertices i and
j, and belongs to exactly two faces.  The winding number of a surface about a point is its solid angle over
``4 pi``; the solid angle of a triangle seen from the origin is ``2 atan2(a . (b x c), |a||b||c| + (a . b)|c|
+ (b . c)|a| + (c . a)|b|)`` (A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983), 125-126).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.checks import shown
from rfm.geometry.outlines.rings import TOLERANCE, Ring, check_simple
from rfm.geometry.similarity import frame

FLAT = 1e-9
"""How far, relative to the extent, a vertex may lie off the plane of its face."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed surface of plane faces, ``normals`` outward or inward, oriented along each shell."""

    vertices: Array
    faces: tuple[tuple[int, ...], ...]

    @property
    def extent(self) -> float:
        """Longest side of the bounding box."""
        return float(np.ptp(self.vertices, axis=0).max())

    def normal(self, face: int) -> Array:
        """Unit normal by Newell's rule: seen from its tip the face runs counter-clockwise."""
        return _area(self.vertices[list(self.faces[face])])[1]

    def ring(self, face: int) -> tuple[Ring, Array]:
        """Face in coordinates ``(x @ rows.T)`` of its plane, and the rows."""
        rows = frame(self.normal(face))[:2]
        return Ring("", self.vertices[list(self.faces[face])] @ rows.T), rows

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Which points ``(n, 3)``, off the surface, lie inside an odd number of shells."""
        return np.asarray(np.rint(self._solid_angle(points) / (4.0 * np.pi)).astype(int) % 2 == 1)

    def on_face(self, face: int, points: Array) -> NDArray[np.bool_]:
        """Which points of the face's plane lie in the closed face."""
        ring, rows = self.ring(face)
        flat = points @ rows.T
        inside = ring.contains(flat)
        for a, b in zip(ring.vertices, np.roll(ring.vertices, -1, axis=0), strict=True):
            along = np.clip((flat - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
            inside |= np.hypot(*(flat - a - along[:, None] * (b - a)).T) <= FLAT * self.extent
        return inside

    def _solid_angle(self, points: Array) -> Array:
        total = np.zeros(len(points))
        for face in self.faces:
            for second, third in pairwise(face[1:]):
                a, b, c = (self.vertices[k] - points for k in (face[0], second, third))
                p, q, r = (np.linalg.norm(x, axis=1) for x in (a, b, c))
                bottom = p * q * r + _dot(a, b) * r + _dot(b, c) * p + _dot(c, a) * q
                total += 2.0 * np.arctan2(_dot(a, np.cross(b, c)), bottom)
        return total


def checked_solid(vertices: Sequence[Sequence[float]] | Array, faces: Sequence[Sequence[int]]) -> Solid:
    """Solid of plane faces that meet in common edges only, consistently oriented.

    Raises
    ------
    GeometryError
        Naming the vertices, the face or the edge that is wrong.
    """
    points = _checked_vertices(vertices)
    extent = float(np.ptp(points, axis=0).max())
    if len(faces) < 4:
        raise GeometryError(f"a polyhedron needs at least 4 faces, got {len(faces)}")
    chains = tuple(_checked_face(points, k, face, extent) for k, face in enumerate(faces))
    solid = Solid(points, _oriented(chains))
    for k in range(len(chains)):
        try:
            check_simple([solid.ring(k)[0]])
        except GeometryError as error:
            text = str(error).split(": ", 1)[1].rsplit(" at ", 1)[0]
            raise GeometryError(f"face{k} is not simple: its {text}") from None
    _check_crossings(solid)
    return solid


def _checked_vertices(vertices: Sequence[Sequence[float]] | Array) -> Array:
    try:
        points = np.asarray(vertices, dtype=np.float64)
    except (TypeError, ValueError):
        raise GeometryError("vertices must be a list of triples of numbers") from None
    if points.ndim != 2 or points.shape[1] != 3:
        raise GeometryError("vertices must be a list of triples of numbers")
    if not np.isfinite(points).all():
        raise GeometryError("vertices must be finite")
    gaps = np.abs(points[:, None] - points[None]).max(axis=2)
    close = np.argwhere(np.triu(gaps <= TOLERANCE * np.ptp(points, axis=0).max(), k=1))
    if len(close):
        i, j = close[0]
        raise GeometryError(f"vertices {i} and {j} are the same point {shown(points[i])}")
    return points


def _checked_face(points: Array, number: int, face: Sequence[int], extent: float) -> tuple[int, ...]:
    chain = tuple(int(index) for index in face)
    if len(chain) < 3:
        raise GeometryError(f"face{number} needs at least 3 vertices, got {len(chain)}")
    for position, index in enumerate(chain):
        if not 0 <= index < len(points):
            raise GeometryError(f"face{number} has vertex {index}: the vertices are 0 to {len(points) - 1}")
        if index in chain[:position]:
            raise GeometryError(f"face{number} has vertex {index} twice")
    corners = points[list(chain)]
    size, normal = _area(corners)
    if size <= TOLERANCE * extent**2:
        raise GeometryError(f"face{number} has no area")
    off = np.abs((corners - corners.mean(axis=0)) @ normal)
    if off.max() > FLAT * extent:
        worst = int(np.argmax(off))
        raise GeometryError(
            f"face{number} is not plane: vertex {chain[worst]} lies {shown(float(off[worst]))} off its mean plane"
        )
    return chain


def _oriented(chains: tuple[tuple[int, ...], ...]) -> tuple[tuple[int, ...], ...]:
    """Faces turned so that every edge is walked once in each direction."""
    users: dict[tuple[int, int], list[tuple[int, bool]]] = {}
    for number, chain in enumerate(chains):
        for i, j in zip(chain, (*chain[1:], chain[0]), strict=True):
            users.setdefault((min(i, j), max(i, j)), []).append((number, i < j))
    for (i, j), pairs in users.items():
        named = ", ".join(f"face{number}" for number, _ in pairs)
        if len(pairs) == 1:
            raise GeometryError(f"the polyhedron is open: edge {i}-{j} belongs to {named} only")
        if len(pairs) > 2:
            raise GeometryError(f"the polyhedron is not a manifold: edge {i}-{j} belongs to {named}")
    turned: dict[int, bool] = {}
    for start in range(len(chains)):
        if start in turned:
            continue
        turned[start], queue = False, [start]
        while queue:
            face = queue.pop()
            for (i, j), pairs in users.items():
                if face not in (pairs[0][0], pairs[1][0]):
                    continue
                (first, along), (second, other) = pairs if pairs[0][0] == face else pairs[::-1]
                wanted = turned[first] ^ (along == other)
                if second not in turned:
                    turned[second] = wanted
                    queue.append(second)
                elif turned[second] != wanted:
                    raise GeometryError(
                        f"the polyhedron has only one side: face{first} and face{second} at edge {i}-{j}"
                    )
    return tuple(chain[::-1] if turned[k] else chain for k, chain in enumerate(chains))


def _check_crossings(solid: Solid) -> None:
    """Refuse edges that pierce faces."""
    owner: dict[tuple[int, int], int] = {}
    for number, chain in enumerate(solid.faces):
        for i, j in zip(chain, (*chain[1:], chain[0]), strict=True):
            owner.setdefault((min(i, j), max(i, j)), number)
    pairs = np.array(list(owner))
    start, end = solid.vertices[pairs[:, 0]], solid.vertices[pairs[:, 1]]
    for number, chain in enumerate(solid.faces):
        normal = solid.normal(number)
        first, second = (((x - solid.vertices[chain[0]]) @ normal) for x in (start, end))
        margin = FLAT * solid.extent
        across = np.flatnonzero((np.minimum(first, second) < -margin) & (np.maximum(first, second) > margin))
        share = (first[across] / (first[across] - second[across]))[:, None]
        points = start[across] + share * (end[across] - start[across])
        if len(points) and (hit := solid.on_face(number, points)).any():
            place = int(np.flatnonzero(hit)[0])
            i, j = pairs[across[place]]
            other = owner[(int(i), int(j))]
            raise GeometryError(
                f"face{number} and face{other} cross: edge {i}-{j} meets face{number} at {shown(points[place])}"
            )


def _area(corners: Array) -> tuple[float, Array]:
    shifted = corners - corners.mean(axis=0)
    total = 0.5 * np.cross(shifted, np.roll(shifted, -1, axis=0)).sum(axis=0)
    size = float(np.linalg.norm(total))
    return size, total / size if size else total


def _dot(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=1))
