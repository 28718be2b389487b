"""Simple polygons as Boolean expressions of half-planes.

Every edge is used exactly once (D. Dobkin, L. Guibas, J. Hershberger, J. Snoeyink, *An efficient
algorithm for finding the CSG representation of a simple polygon*, SIGGRAPH 1988): along the convex
hull the expression is the intersection of the hull's edges and, for every pocket, of the union of
the edges of the pocket's own hull, and so on, intersection and union in turn.

Edges on a common line share one surface, of which they are named pieces, so that no boundary
function occurs under two names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.carriers import Plane, plane
from rfm.geometry.checks import shown
from rfm.geometry.expression import Expression, Literal, conjunction, disjunction
from rfm.geometry.shape import Shape
from rfm.geometry.similarity import Similarity
from rfm.geometry.surface import Piece, Surface

Indices: TypeAlias = NDArray[np.intp]

_SAME_LINE = 1e-12
_SAME_DIRECTION = 1e-12


def polygon(vertices: Sequence[Sequence[float]] | Array) -> Shape:
    """Polygon with the given vertices (either orientation); ``edge<i>`` runs from vertex i to i + 1.

    Raises
    ------
    GeometryError
        For less than three vertices, repeated vertices, edges that cross, touch or fold back.
    """
    corners = _checked(vertices)
    count = len(corners)
    numbers = np.arange(count)
    path = corners
    if _signed_area(corners) < 0.0:
        # walked backwards, the edge that starts at vertex i is the user's edge i - 1
        path, numbers = corners[::-1], (numbers[::-1] - 1) % count
    literals = _literals(path, numbers)
    hull = _hull_of_cycle(path)
    chains = [
        (first, second if second > first else second + count)
        for first, second in zip(hull, [*hull[1:], hull[0]], strict=True)
    ]
    terms = [_chain(path, list(range(first, last + 1)), literals, inside=False) for first, last in chains]
    return Shape(2, conjunction(terms), support.points(corners))


@dataclass(frozen=True)
class Segment:
    """``(L^2/4 - s^2) / L``: positive along a segment of length L, s measured from its middle."""

    along: Plane
    length: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        distance = self.along(*coords)
        return (0.25 * self.length**2 - distance * distance) * (1.0 / self.length)

    def moved(self, similarity: Similarity) -> Segment:
        """See :class:`rfm.geometry.carriers.Carrier`."""
        return Segment(self.along.moved(similarity), self.length * similarity.scale)


def _chain(path: Array, chain: list[int], literals: list[Literal], inside: bool) -> Expression:
    """Region to the left of a chain of vertices (indices modulo the path's length).

    ``inside``: whether the pieces are to be intersected (they alternate with the level).
    """
    if len(chain) == 2:
        return literals[chain[0] % len(path)]
    breaks = _hull_of_chain(path[np.array(chain) % len(path)], right=inside)
    terms = [_chain(path, chain[first : last + 1], literals, not inside) for first, last in pairwise(breaks)]
    return conjunction(terms) if inside else disjunction(terms)


def _hull_of_cycle(path: Array) -> list[int]:
    """Indices of the vertices on the convex hull (collinear ones too) of a counter-clockwise polygon."""
    start = int(np.lexsort((path[:, 1], path[:, 0]))[0])
    cycle = [(start + step) % len(path) for step in range(len(path) + 1)]
    breaks = _hull_of_chain(path[cycle], right=True)
    return sorted(cycle[index] for index in breaks[:-1])


def _hull_of_chain(points: Array, right: bool) -> list[int]:
    """Positions of the hull's vertices along a simple chain between two of them.

    With ``right`` the hull lies to the left of its edges walked along the chain (the chain is convex
    seen from its right), otherwise to the right.  Collinear vertices count as the hull's.
    """
    sign = 1.0 if right else -1.0
    position, breaks = 0, [0]
    last = len(points) - 1
    while position < last:
        rays = points[position + 1 :] - points[position]
        lengths = np.linalg.norm(rays, axis=1)
        turns = np.arctan2(_cross(rays[0], rays), rays @ rays[0]) * sign
        # straight back (the way we came) is the last choice, on whichever side rounding puts it
        turns = np.where((lengths == 0.0) | (turns < _SAME_DIRECTION - np.pi), np.pi, turns)
        first = turns <= turns.min() + _SAME_DIRECTION
        position += 1 + int(np.argmin(np.where(first, lengths, np.inf)))
        breaks.append(position)
    return breaks


def _literals(path: Array, numbers: Indices) -> list[Literal]:
    """One literal per edge of the counter-clockwise path; edges on one line share the surface."""
    following = np.roll(path, -1, axis=0)
    tangents = following - path
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
    offsets = np.einsum("ij,ij->i", normals, 0.5 * (path + following))
    extent = float(np.ptp(path, axis=0).max())
    literals: dict[int, Literal] = {}
    for index, (normal, offset) in enumerate(zip(normals, offsets, strict=True)):
        if index in literals:
            continue
        same = np.sign(normals @ normal)
        on_line = np.abs(_cross(normal, normals)) < _SAME_LINE
        on_line &= np.abs(same * offsets - offset) < _SAME_LINE * extent
        members = np.flatnonzero(on_line)
        surface = _side(path, following, normal, float(offset), members, numbers)
        literals |= {int(member): Literal(surface, bool(same[member] > 0.0)) for member in members}
    return [literals[index] for index in range(len(path))]


def _side(
    path: Array, following: Array, normal: Array, offset: float, members: Indices, numbers: Indices
) -> Surface:
    """Surface of the edges on one line."""
    depth = (path - path[members[0]]) @ normal
    members = members[np.argsort(numbers[members])]
    pieces = []
    for index in members:
        chord = following[index] - path[index]
        length = float(np.linalg.norm(chord))
        middle = 0.5 * (following[index] + path[index])
        along = plane(chord / length, float(chord @ middle) / length)
        pieces.append(Piece((f"edge{numbers[index]}",), Segment(along, length)))
    label = "+".join(piece.label[0] for piece in pieces)
    return Surface(
        (label,),
        plane(normal, offset),
        degree=1,
        size=0.5 * float(np.abs(depth).max()),
        normalised=True,
        pieces=tuple(pieces) if len(pieces) > 1 else (),
    )


def _checked(vertices: Sequence[Sequence[float]] | Array) -> Array:
    """Vertices as an array ``(n, 2)`` of a simple polygon."""
    try:
        points = np.asarray(vertices, dtype=np.float64)
    except (TypeError, ValueError):
        raise GeometryError("vertices must be a list of pairs of numbers") from None
    if points.ndim != 2 or points.shape[1] != 2:
        raise GeometryError("vertices must be a list of pairs of numbers")
    if not np.isfinite(points).all():
        raise GeometryError("vertices must be finite")
    if len(points) < 3:
        raise GeometryError(f"a polygon needs at least 3 vertices, got {len(points)}")
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    close = np.argwhere(np.triu(gaps <= _SAME_LINE * gaps.max(), k=1))
    if len(close):
        first, second = close[0]
        raise GeometryError(f"vertices {first} and {second} are the same point {shown(points[first])}")
    _check_simple(points)
    return points


def _check_simple(points: Array) -> None:
    """Refuse edges that cross, touch or overlap, naming them."""
    count = len(points)
    start, end = points, np.roll(points, -1, axis=0)
    first, second = np.triu_indices(count, k=1)
    a, b, c, d = start[first], end[first], start[second], end[second]
    scale = float(np.ptp(points, axis=0).max()) ** 2 * _SAME_LINE

    def side(p: Array, q: Array, r: Array) -> Array:
        turn = (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]
        return np.where(np.abs(turn) <= scale, 0.0, np.sign(turn))

    def within(p: Array, q: Array, r: Array) -> NDArray[np.bool_]:
        return np.asarray((np.minimum(p, q) <= r).all(axis=1) & (r <= np.maximum(p, q)).all(axis=1))

    turns = [side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b)]
    meets = (turns[0] * turns[1] < 0.0) & (turns[2] * turns[3] < 0.0)
    touches = np.zeros(len(first), dtype=bool)
    for turn, (p, q, r) in zip(turns, ((a, b, c), (a, b, d), (c, d, a), (c, d, b)), strict=True):
        touches |= (turn == 0.0) & within(p, q, r)
    following, preceding = second == first + 1, (first == 0) & (second == count - 1)
    neighbours = following | preceding
    # neighbours share a vertex; they are wrong only when one folds back onto the other
    shared = np.where(following[:, None], b, a)
    back = np.einsum(
        "ij,ij->i", np.where(following[:, None], a, b) - shared, np.where(following[:, None], d, c) - shared
    )
    folded = neighbours & (turns[0] == 0.0) & (turns[1] == 0.0) & (back > 0.0)
    wrong = np.flatnonzero(np.where(neighbours, folded, meets | touches))
    if len(wrong):
        pair = wrong[0]
        raise GeometryError(
            f"the polygon is not simple: edge{first[pair]} and edge{second[pair]} "
            + ("fold back on each other" if neighbours[pair] else "cross or touch")
        )


def _signed_area(points: Array) -> float:
    following = np.roll(points, -1, axis=0)
    return 0.5 * float(np.sum(points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0]))


def _cross(first: Array, second: Array) -> Array:
    """Cross product of one vector with vectors ``(..., 2)``."""
    return np.asarray(first[0] * second[..., 1] - first[1] * second[..., 0])
