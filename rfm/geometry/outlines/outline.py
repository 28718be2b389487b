"""Outlines of lines and circular arcs as Boolean expressions of half-planes and disks.

Notation: P is the polygon of the chords, c_i its half-plane at edge i, d_i the disk of an arc.  The arcs are
bisected until P is simple and the lenses between arcs and chords are apart; then the set is
``(P | lenses of outward arcs) - lenses of inward arcs``.  As it stands, that is zero on the chords, inside
the set.  So in the expression of P (every c_i once, ``chains``) the literal of an arc is replaced,

    c_i  ->  c_i | d_i   (outward arc),        c_i  ->  c_i & ~d_i   (inward arc),

which is right outside all lenses and positive across the chords.  Where another half-plane cuts a lens off,
the lens is joined, ``| (d_i & ~c_i)``, or taken away, ``& (~d_i | ~c_i)``, as well.  Chords are separators
(Shapiro, Acta Numerica 16 (2007), Theorem 6; Shapiro and Vossler, ACM Trans. Graphics 12 (1993)): they are kept
only where they are needed, which is decided on the faces, edges and vertices of the arrangement of all curves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.carriers import Sphere, plane
from rfm.geometry.checks import shown
from rfm.geometry.expression import Expression, Literal, conjunction, disjunction
from rfm.geometry.outlines.arcs import Edge, bulge_of, meeting
from rfm.geometry.outlines.arrangement import curve, representatives
from rfm.geometry.outlines.chains import tree_of_chains
from rfm.geometry.outlines.lines import Edges
from rfm.geometry.outlines.reduction import reduced
from rfm.geometry.outlines.rings import TOLERANCE, Ring, checked_ring
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Piece, Surface

MOST_CURVES = 80
"""With more curves their arrangement is not listed: every chord and every lens is kept."""

_NEAR = 1e-9
_BISECTIONS = 8
_ATTEMPTS = 4


def outline(
    vertices: Sequence[Sequence[float]] | Array, arcs: Mapping[int, Mapping[str, Any]] | None = None
) -> Shape:
    """Set bounded by lines and circular arcs.

    Parameters
    ----------
    vertices
        Vertices ``(n, 2)`` in order, either orientation, at least two; edge i runs from vertex i to i + 1.
    arcs
        Edges that are arcs, each with one of ``bulge`` (tangent of a quarter of the swept angle, positive
        counter-clockwise), ``through`` (a point on the arc), ``radius`` (the shorter arc, positive when it runs
        counter-clockwise), ``center`` (counter-clockwise, or with ``clockwise: True``).

    Raises
    ------
    GeometryError
        For arcs that do not exist, edges that cross, touch or form a cusp (with the edges and the point), and what
        a polygon refuses.
    """
    edges = _checked(vertices, arcs or {})
    pieces = _separated(edges)
    for attempt in range(_ATTEMPTS):
        found = _expression(pieces, edges)
        if found is not None:
            return Shape(2, found, _reach(edges))
        turned = 1.0 if attempt % 2 else -1.0  # not all arcs at once: two may have one chord's line in common
        pieces = [
            part for piece in pieces for part in (piece.halves() if turned * piece.bulge > 0.0 else (piece,))
        ]
    raise GeometryError("found no expression of the outline that is zero on it only; move a vertex a little")


def _expression(pieces: list[Edge], edges: list[Edge]) -> Expression | None:
    """Expression without superfluous separators; None when it is zero elsewhere than on the outline.

    That happens when a chord lies on the line of an edge: bisected, its arc has other chords.
    """
    labels = tuple(None if piece.bulge else (f"edge{piece.index}",) for piece in pieces)
    path = np.array([piece.start for piece in pieces])
    sides = Edges(path, np.roll(path, -1, axis=0), labels).literals()
    expression = _joined(pieces, sides, _disks(edges))
    surfaces = expression.surfaces()
    if len(surfaces) > MOST_CURVES or not any(edge.bulge for edge in edges):
        return expression
    extent = _extent(edges)
    points = representatives([curve(surface.function) for surface in surfaces], extent)  # type: ignore[arg-type]
    signs = {surface: _signs(surface, points, extent) for surface in surfaces}
    wanted = _expected(pieces, points, extent)

    def correct(attempt: Expression) -> bool:
        return bool((attempt.evaluate(signs) == wanted).all())

    return reduced(expression, correct) if correct(expression) else None


def _joined(pieces: list[Edge], sides: list[Literal], disks: dict[int, Literal]) -> Expression:
    """Expression with every chord and every lens."""
    literals: list[Expression] = list(sides)
    added: list[Expression] = []
    removed: list[Expression] = []
    for position, (piece, side) in enumerate(zip(pieces, sides, strict=True)):
        if piece.bulge > 0.0:
            disk = disks[piece.index]
            literals[position] = disjunction([side, disk])
            added.append(conjunction([disk, side.negated()]))
        elif piece.bulge < 0.0:
            outside = disks[piece.index].negated()
            literals[position] = conjunction([side, outside])
            removed.append(disjunction([outside, side.negated()]))
    tree = tree_of_chains(np.array([piece.start for piece in pieces]))
    return conjunction([disjunction([tree.expression(literals), *added]), *removed])


def _signs(surface: Surface, points: Array, extent: float) -> Array:
    values = np.asarray(surface.function(*points.T))
    distance = curve(surface.function).distance(points)  # type: ignore[arg-type]
    return np.where(distance <= _NEAR * extent, 0.0, np.sign(values))


def _expected(pieces: list[Edge], points: Array, extent: float) -> Array:
    """Sign that the function must have: 0 on the boundary, 1 inside, -1 outside."""
    inside = Ring("", np.array([piece.start for piece in pieces])).contains(points)
    for piece in pieces:
        lens = piece.in_lens(points, _NEAR * extent)  # the chord belongs to its lens
        inside = (inside | lens) if piece.bulge > 0.0 else (inside & ~lens)
    border = np.min([piece.distance(points) for piece in pieces], axis=0) <= _NEAR * extent
    return np.where(border, 0.0, np.where(inside, 1.0, -1.0))


def _checked(
    vertices: Sequence[Sequence[float]] | Array, arcs: Mapping[int, Mapping[str, Any]]
) -> list[Edge]:
    """Counter-clockwise edges that meet in the vertices only."""
    points = checked_ring(vertices, fewest=2 if arcs else 3).vertices
    count = len(points)
    for index in arcs:
        if not 0 <= index < count:
            raise GeometryError(f"there is no edge{index}: the edges are edge0 to edge{count - 1}")
    ends = np.roll(points, -1, axis=0)
    edges = [
        Edge(a, b, bulge_of(a, b, arcs[index], f"edge{index}") if index in arcs else 0.0, index)
        for index, (a, b) in enumerate(zip(points, ends, strict=True))
    ]
    for edge in edges:
        if edge.index in arcs and abs(edge.bulge) < TOLERANCE:
            raise GeometryError(f"edge{edge.index}: the arc is straight; leave it out of arcs")
    tolerance = TOLERANCE * 10.0 * _extent(edges)
    for i, first in enumerate(edges):
        for second in edges[i + 1 :]:
            point = meeting(first, second, tolerance)
            if point is not None:
                raise GeometryError(
                    f"the outline is not simple: edge{first.index} and edge{second.index} meet at {shown(point)}"
                )
    area = Ring("", points).area + sum(edge.lens_area for edge in edges)
    return edges if area > 0.0 else [edge.reversed() for edge in reversed(edges)]


def _separated(edges: list[Edge]) -> list[Edge]:
    """Edges with arcs bisected until no chord meets another edge and every lens is free of vertices."""
    pieces, tolerance = list(edges), TOLERANCE * 10.0 * _extent(edges)
    for _ in range(_BISECTIONS):
        bad = {k for k in range(len(pieces)) if pieces[k].bulge and _entangled(pieces, k, tolerance)}
        if len(pieces) < 3:
            bad = {k for k in range(len(pieces)) if pieces[k].bulge}
        if not bad:
            return pieces
        pieces = [
            part for k, piece in enumerate(pieces) for part in (piece.halves() if k in bad else (piece,))
        ]
    narrow = pieces[min(bad)]
    raise GeometryError(
        f"edge{narrow.index} comes too close to another edge near {shown(narrow.middle)} (a cusp, or almost)"
    )


def _entangled(pieces: list[Edge], k: int, tolerance: float) -> bool:
    """Whether the chord of an arc meets another edge, or a vertex lies in the lens."""
    chord = pieces[k].straight()
    others = [piece for i, piece in enumerate(pieces) if i != k]
    ends = np.array([piece.start for piece in pieces])
    ends = ends[np.minimum(np.hypot(*(ends - chord.start).T), np.hypot(*(ends - chord.end).T)) > tolerance]
    if len(ends) and pieces[k].in_lens(ends, tolerance).any():
        return True
    return any(
        meeting(chord, other, tolerance) is not None
        or meeting(chord, other.straight(), tolerance) is not None
        for other in others
    )


def _disks(edges: list[Edge]) -> dict[int, Literal]:
    """Disk of every arc, by the edge; arcs on one circle share it."""
    arcs = [edge for edge in edges if edge.bulge]
    near = _NEAR * _extent(edges)
    literals: dict[int, Literal] = {}
    for arc in arcs:
        if arc.index in literals:
            continue
        members = [
            other
            for other in arcs
            if abs(other.radius - arc.radius) <= near and np.hypot(*(other.center - arc.center)) <= near
        ]
        members.sort(key=lambda member: member.index)
        pieces = tuple(Piece((f"edge{member.index}",), _side_of(member)) for member in members)
        surface = Surface(
            ("+".join(piece.label[0] for piece in pieces),),
            Sphere(tuple(arc.center.tolist()), arc.radius),
            degree=2,
            size=arc.radius,
            normalised=True,
            peak=0.5 * arc.radius,
            pieces=pieces if len(pieces) > 1 else (),
        )
        literals |= {member.index: Literal(surface) for member in members}
    return literals


def _side_of(arc: Edge) -> Any:
    """Field that is positive, on the circle, along the arc."""
    normal = -np.sign(arc.bulge) * arc.left
    return plane(normal, float(normal @ arc.start))


def _reach(edges: list[Edge]) -> support.Support:
    """Reach of the outline: of its vertices, and of the arcs whose outermost point belongs to them."""

    def reach(directions: Array) -> Array:
        found = [directions @ edge.start for edge in edges]
        for edge in edges:
            if edge.bulge:
                outermost = edge.center + edge.radius * directions
                found.append(
                    np.where(edge.beyond(outermost) >= 0.0, (outermost * directions).sum(axis=1), -np.inf)
                )
        return np.asarray(np.max(found, axis=0))

    return reach


def _extent(edges: list[Edge]) -> float:
    points = np.array([point for edge in edges for point in (edge.start, edge.middle)])
    return float(np.ptp(points, axis=0).max())
