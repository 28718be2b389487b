"""Simple polygons with holes as Boolean expressions of half-planes; every edge occurs exactly once.

With E(r) the expression of a ring (``chains``), a ring with the rings directly inside it is
``E(r) & ~S(h1) & ~S(h2) ...``, and S(h) of each of them is formed in the same way: a ring in a hole is an
island again (the even-odd rule).

E(r) of the outer ring is an intersection of the half-planes that hold all of it, and of what the other edges leave:
an edge of a pocket whose line supports the ring (y = -1 of an L) would otherwise be joined with the pocket by
R-operations, and every weight would have a kink at its convex corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry import support
from rfm.geometry.expression import Expression, Literal, assuming, conjunction
from rfm.geometry.outlines.chains import tree_of_chains
from rfm.geometry.outlines.lines import Edges, numbered
from rfm.geometry.outlines.rings import check_simple, checked_ring, nesting
from rfm.geometry.shape import Shape

Vertices: TypeAlias = Sequence[Sequence[float]] | Array

SUPPORTS = 1e-12
"""How far a vertex may lie beyond a line that supports the ring, relative to the size of the ring."""


def polygon(vertices: Vertices, holes: Sequence[Vertices] = ()) -> Shape:
    """Polygon with the given vertices, without holes given in the same way.

    Parameters
    ----------
    vertices
        Vertices ``(n, 2)`` in order, either orientation; ``edge<i>`` runs from vertex i to i + 1.
    holes
        Rings of vertices; their edges are ``hole<k>.edge<i>``.  A ring inside a hole is an island.

    Raises
    ------
    GeometryError
        For less than three vertices, repeated vertices, edges that cross, touch or fold back (with the two
        edges and the point), and holes outside the polygon.
    """
    rings = [checked_ring(vertices), *(checked_ring(hole, f"hole{k}") for k, hole in enumerate(holes))]
    check_simple(rings)
    inner = nesting(rings)
    walked = [
        numbered([ring.name] if ring.name else [], ring.vertices, clockwise=ring.area < 0.0) for ring in rings
    ]
    literals = Edges(
        np.concatenate([path for path, _ in walked]),
        np.concatenate([np.roll(path, -1, axis=0) for path, _ in walked]),
        tuple(label for _, labels in walked for label in labels),
    ).literals()
    ends = np.cumsum([len(path) for path, _ in walked])
    own = [literals[end - len(path) : end] for (path, _), end in zip(walked, ends, strict=True)]

    def region(index: int) -> Expression:
        """Expression of a ring less the rings inside it."""
        outer = tree_of_chains(walked[index][0]).expression(own[index])
        if index == 0:
            outer = _supported(outer, own[0], rings[0].vertices)
        return conjunction([outer, *(region(hole).negated() for hole in inner[index])])

    return Shape(2, region(0), support.points(rings[0].vertices))


def _supported(expression: Expression, edges: Sequence[Literal], vertices: Array) -> Expression:
    """Return ``E & h1 & h2 ...`` for the half-planes h of edges that hold all vertices, these taken out of E."""
    scale = float(np.ptp(vertices, axis=0).max())
    supporting: list[Expression] = []
    for literal in dict.fromkeys(edges):
        values = literal.surface.function(*vertices.T) * (1.0 if literal.positive else -1.0)
        if values.min() < -SUPPORTS * scale or literal in getattr(expression, "terms", ()):
            continue
        rest = assuming(expression, literal.surface, literal.positive)
        if isinstance(rest, Expression):
            supporting.append(literal)
            expression = rest
    return conjunction([expression, *supporting])
