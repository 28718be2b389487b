"""Polyhedra with plane faces as Boolean expressions of half-spaces.

The planes of the faces alone separate a polyhedron: it is a union of cells of their arrangement.  A convex one
is the intersection of its half-spaces.  Otherwise the expression is found from the signs of the planes
on all flats of the arrangement (``synthesis``): faces of the hull are intersected, faces of pockets united, every
plane once where that is possible; not every polyhedron has such an expression.  Where it is not found, the
planes of the convex hull that carry no face are tried as separators; they may lead to an expression without them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.r_systems import R0
from rfm.calculus.types import Array, Field
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.carriers import Plane, plane
from rfm.geometry.expression import Expression, Literal, conjunction
from rfm.geometry.outlines.chains import tree_of_chains
from rfm.geometry.outlines.faces import FLAT, Solid, checked_solid
from rfm.geometry.outlines.flats import representatives
from rfm.geometry.outlines.synthesis import Table, synthesised
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Piece, Surface
from rfm.geometry.vanishing import Composition

_ASIDE = 1e-7
_SOMEWHERE = np.array([0.6391, 0.5472, 0.5405])

MOST_PLANES = 32
"""Most planes of a polyhedron that is not convex: their arrangement has n^3 / 6 vertices."""


def polyhedron(vertices: Sequence[Sequence[float]] | Array, faces: Sequence[Sequence[int]]) -> Shape:
    """Polyhedron with the given vertices and plane faces.

    Parameters
    ----------
    vertices
        Points ``(n, 3)``.
    faces
        For each face the numbers of its vertices in order, in either sense; they need not be convex.  A shell inside
        a shell is a cavity.  The parts are ``face0``, ``face1``, ...

    Raises
    ------
    GeometryError
        For faces that are not plane (which, how far), an open or non-manifold surface (which edge), faces that cross
        (where), and polyhedra of more than 32 planes that are not convex.
    """
    solid = checked_solid(vertices, faces)
    surfaces, normals, offsets = _planes(solid)
    reach = support.points(solid.vertices)
    depth = solid.vertices @ normals.T - offsets
    if (depth >= -FLAT * solid.extent).all():
        return Shape(3, conjunction([Literal(surface) for surface in surfaces]), reach)
    if len(surfaces) > MOST_PLANES:
        raise GeometryError(
            f"a polyhedron that is not convex may have {MOST_PLANES} planes, got {len(surfaces)}; divide it"
        )
    expression = synthesised(_table(solid, surfaces, normals, offsets))
    if expression is None or len(expression.literals()) > len(surfaces):
        # the planes of the hull, where they carry no face, may be worth having as separators
        lids = _lids(solid, normals, offsets)
        if lids and len(surfaces) + len(lids) <= MOST_PLANES:
            more = (
                *surfaces,
                *(Surface(("separator",), lid, degree=1, normalised=True, auxiliary=True) for lid in lids),
            )
            rows = np.concatenate([normals, [lid.normal for lid in lids]])
            separated = synthesised(
                _table(solid, more, rows, np.append(offsets, [lid.offset for lid in lids]))
            )
            found = [one for one in (expression, separated) if one is not None]
            expression = min(found, key=lambda one: len(one.literals()), default=None)
    if expression is None:
        raise GeometryError("found no expression of the polyhedron that is zero on it only; divide it")
    return Shape(3, expression, reach)


def _separator(lid: Plane) -> Surface:
    return Surface(("separator",), lid, degree=1, normalised=True, auxiliary=True)


def _lids(solid: Solid, normals: Array, offsets: Array) -> list[Plane]:
    """Planes of the convex hull, positive inside, that carry no face."""
    from scipy.spatial import ConvexHull

    equations = -ConvexHull(solid.vertices).equations
    _, first = np.unique(np.round(equations, 8), axis=0, return_index=True)
    lids = []
    for *normal, shift in equations[np.sort(first)]:
        same = np.abs(np.cross(normals, normal)).max(axis=1) <= FLAT
        level = np.sign(normals @ normal) * offsets + shift
        if not (same & (np.abs(level) <= FLAT * solid.extent)).any():
            lids.append(plane(np.array(normal), -float(shift)))
    return lids


def _planes(solid: Solid) -> tuple[tuple[Surface, ...], Array, Array]:
    """One surface for every plane, positive where most of the solid is (for a face of the hull, inside)."""
    surfaces: list[Surface] = []
    rows: list[tuple[Array, float]] = []
    left = list(range(len(solid.faces)))
    while left:
        face = left[0]
        normal = solid.normal(face)
        middle = solid.vertices[list(solid.faces[face])].mean(axis=0)
        if ((solid.vertices - middle) @ normal).sum() < 0.0:
            normal = -normal
        offset = float(normal @ middle)
        flat = np.abs(solid.vertices @ normal - offset) <= FLAT * solid.extent
        members = [k for k in left if flat[list(solid.faces[k])].all()]
        left = [k for k in left if k not in members]
        pieces = tuple(Piece((f"face{k}",), _within(solid, k)) for k in members) if len(members) > 1 else ()
        label = "+".join(f"face{k}" for k in members)
        size = 0.5 * float(np.abs(solid.vertices @ normal - offset).max())
        function = plane(normal, offset)
        surfaces.append(Surface((label,), function, degree=1, size=size, normalised=True, pieces=pieces))
        rows.append((normal, offset))
    return tuple(surfaces), np.array([n for n, _ in rows]), np.array([q for _, q in rows])


def _within(solid: Solid, face: int) -> Field:
    """Field that is positive, in the plane of a face, in the face."""
    ring, rows = solid.ring(face)
    corners = ring.vertices if ring.area > 0.0 else ring.vertices[::-1]
    literals: list[Expression] = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = (b - a) / np.linalg.norm(b - a)
        left = np.array([-along[1], along[0]])
        literals.append(Literal(Surface((), plane(left @ rows, float(left @ a)), degree=1)))
    return Composition(tree_of_chains(corners).expression(literals), R0, lambda surface: surface.function)


def _table(solid: Solid, surfaces: tuple[Surface, ...], normals: Array, offsets: Array) -> Table:
    points = representatives(normals, offsets, solid.extent)
    depth = points @ normals.T - offsets
    signs = np.where(np.abs(depth) <= FLAT * solid.extent, 0, np.sign(depth)).astype(np.int8)
    signs, first = np.unique(signs, axis=0, return_index=True)
    points = points[first]
    # a little off the planes, where the solid angle is well defined; the boundary is told apart below
    aside = np.where((signs == 0).any(axis=1), _ASIDE * solid.extent, 0.0)[:, None] * _SOMEWHERE
    wanted = np.where(solid.contains(points + aside), 1, -1).astype(np.int8)
    for face in range(len(solid.faces)):
        height = (points - solid.vertices[solid.faces[face][0]]) @ solid.normal(face)
        near = np.flatnonzero(np.abs(height) <= FLAT * solid.extent)
        wanted[near[solid.on_face(face, points[near])]] = 0
    return Table(surfaces, np.ascontiguousarray(signs.T), wanted)
