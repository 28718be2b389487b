"""Points in every cell, face, edge and vertex of an arrangement of planes."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from rfm.calculus.types import Array

_SAME = 1e-9
_MOST_TRIPLES = 2000


def representatives(normals: Array, offsets: Array, extent: float) -> Array:
    """At least one point on every flat of the planes ``normals . x = offsets`` (not all parallel to a line).

    Every flat has a vertex of the arrangement; near a vertex the cells, faces and edges are spanned by three, two
    and one of the lines in which planes through the vertex meet.
    """
    found = [_near(vertex, normals, offsets, extent) for vertex in _vertices(normals, offsets, extent)]
    return np.concatenate(found)


def _vertices(normals: Array, offsets: Array, extent: float) -> Array:
    triples = np.array(list(combinations(range(len(normals)), 3)))
    matrices = normals[triples]
    regular = np.abs(np.linalg.det(matrices)) > _SAME
    points = np.linalg.solve(matrices[regular], offsets[triples[regular]][..., None])[..., 0]
    _, first = np.unique(np.round(points / (_SAME * extent * 10.0)), axis=0, return_index=True)
    return np.asarray(points[first])


def _near(vertex: Array, normals: Array, offsets: Array, extent: float) -> Array:
    """Points at and around a vertex, nearer than every plane that does not pass through it."""
    distances = np.abs(normals @ vertex - offsets)
    through = distances <= _SAME * extent
    room = float(np.min(distances[~through], initial=extent))
    lines = np.array([np.cross(a, b) for a, b in combinations(normals[through], 2)])
    lengths = np.linalg.norm(lines, axis=1)
    lines = lines[lengths > _SAME] / lengths[lengths > _SAME, None]
    rays = np.unique(np.round(np.concatenate([lines, -lines]), 12), axis=0)
    pairs = np.array(list(combinations(range(len(rays)), 2)))
    triples = np.array(list(combinations(range(len(rays)), 3)))
    if len(triples) > _MOST_TRIPLES:
        triples = np.random.default_rng(0).permutation(triples)[:_MOST_TRIPLES]
    directions = np.concatenate([rays, rays[pairs].sum(axis=1), rays[triples].sum(axis=1)])
    lengths = np.linalg.norm(directions, axis=1)
    directions = directions[lengths > _SAME] / lengths[lengths > _SAME, None]
    return np.concatenate([vertex[None], vertex + 0.3 * room * directions])
