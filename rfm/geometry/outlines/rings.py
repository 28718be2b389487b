"""Checks of closed rings of vertices: simple, apart from each other, one inside the other.

Notation: edge i of a ring runs from vertex i to vertex i + 1, the last one back to vertex 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.checks import shown

TOLERANCE = 1e-12
"""Relative to the extent: points closer than this are one point, lines closer than this one line."""


@dataclass(frozen=True, eq=False)
class Ring:
    """A closed chain of vertices ``(n, 2)`` with the name of the ring (empty for the outermost one)."""

    name: str
    vertices: Array

    @property
    def area(self) -> float:
        """Signed area, positive when walked counter-clockwise."""
        x, y = (self.vertices - self.vertices[0]).T
        return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))

    def edge(self, index: int) -> str:
        """Name of an edge."""
        return f"{self.name}.edge{index}" if self.name else f"edge{index}"

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Which of the points ``(n, 2)`` lie inside, by the even-odd rule."""
        start, end = self.vertices, np.roll(self.vertices, -1, axis=0)
        x, y = points[:, :1], points[:, 1:]
        across = (start[:, 1] > y) != (end[:, 1] > y)
        rise = np.where(end[:, 1] == start[:, 1], 1.0, end[:, 1] - start[:, 1])
        at = start[:, 0] + (end[:, 0] - start[:, 0]) * ((y - start[:, 1]) / rise)
        return np.asarray((across & (x < at)).sum(axis=1) % 2 == 1)


def checked_ring(vertices: Sequence[Sequence[float]] | Array, name: str = "", fewest: int = 3) -> Ring:
    """Ring of distinct, finite vertices.

    Raises
    ------
    GeometryError
        For what is no list of pairs, too few vertices, or a vertex given twice.
    """
    prefix = f"{name}: " if name else ""
    try:
        points = np.asarray(vertices, dtype=np.float64)
    except (TypeError, ValueError):
        raise GeometryError(f"{prefix}vertices must be a list of pairs of numbers") from None
    if points.ndim != 2 or points.shape[1] != 2:
        raise GeometryError(f"{prefix}vertices must be a list of pairs of numbers")
    if not np.isfinite(points).all():
        raise GeometryError(f"{prefix}vertices must be finite")
    if len(points) < fewest:
        raise GeometryError(f"{prefix}a polygon needs at least {fewest} vertices, got {len(points)}")
    extent = float(np.ptp(points, axis=0).max())
    gaps = np.abs(points[:, None] - points[None]).max(axis=2)
    close = np.argwhere(np.triu(gaps <= TOLERANCE * extent, k=1))
    if len(close):
        first, second = (int(index) for index in close[0])
        count = len(points)
        edge = first if second == first + 1 else second if (second + 1) % count == first else None
        remark = "" if edge is None else f": edge{edge} has no length"
        message = f"vertices {first} and {second} are the same point {shown(points[first])}"
        raise GeometryError(prefix + message + remark)
    return Ring(name, points)


def check_simple(rings: Sequence[Ring]) -> None:
    """Refuse edges that cross, touch or fold back, within a ring or between two.

    Raises
    ------
    GeometryError
        With the names of the two edges and the point.
    """
    names = [ring.edge(index) for ring in rings for index in range(len(ring.vertices))]
    start = np.concatenate([ring.vertices for ring in rings])
    end = np.concatenate([np.roll(ring.vertices, -1, axis=0) for ring in rings])
    lengths = [len(ring.vertices) for ring in rings]
    following = np.concatenate(
        [
            total - count + (np.arange(count) + 1) % count
            for count, total in zip(lengths, np.cumsum(lengths), strict=True)
        ]
    )
    first, second = _near_pairs(start, end)
    a, b, c, d = start[first], end[first], start[second], end[second]
    scale = float(np.ptp(start, axis=0).max()) ** 2 * TOLERANCE
    sides = [_side(a, b, c, scale), _side(a, b, d, scale), _side(c, d, a, scale), _side(c, d, b, scale)]
    ahead, behind = following[first] == second, following[second] == first
    neighbours = ahead | behind

    def refuse(wrong: NDArray[np.bool_], how: str, where: Array) -> None:
        if wrong.any():
            pair = int(np.flatnonzero(wrong)[0])
            edges = f"{names[first[pair]]} and {names[second[pair]]}"
            raise GeometryError(f"the polygon is not simple: {edges} {how} at {shown(where[pair])}")

    # neighbours share a vertex; they are wrong only when one folds back onto the other
    shared = np.where(ahead[:, None], b, a)
    out, back = np.where(ahead[:, None], a, b) - shared, np.where(ahead[:, None], d, c) - shared
    folded = neighbours & (sides[0] == 0.0) & (sides[1] == 0.0) & ((out * back).sum(axis=1) > 0.0)
    refuse(folded, "fold back on each other", shared)
    crosses = ~neighbours & (sides[0] * sides[1] < 0.0) & (sides[2] * sides[3] < 0.0)
    refuse(crosses, "cross", _crossing(a, b, c, d))
    corners = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    on = [(side == 0.0) & _between(p, q, r) for side, (p, q, r) in zip(sides, corners, strict=True)]
    where = np.select([one[:, None] for one in on], [r for _, _, r in corners])
    refuse(~neighbours & np.any(on, axis=0), "touch", where)


def nesting(rings: Sequence[Ring]) -> list[list[int]]:
    """Rings directly inside each ring (rings that neither cross nor touch); the first holds all others.

    Raises
    ------
    GeometryError
        When a ring lies outside the first one.
    """
    inside = np.array([ring.contains(np.array([other.vertices[0] for other in rings])) for ring in rings])
    np.fill_diagonal(inside, False)
    for index in range(1, len(rings)):
        if not inside[0, index]:
            where = shown(rings[index].vertices[0])
            raise GeometryError(
                f"{rings[index].name} is not inside the polygon: its vertex 0 {where} lies outside"
            )
    depth = inside.sum(axis=0)
    return [
        [inner for inner in range(len(rings)) if inside[outer, inner] and depth[inner] == depth[outer] + 1]
        for outer in range(len(rings))
    ]


def _near_pairs(start: Array, end: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pairs of edges whose boxes meet."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    margin = TOLERANCE * float(np.ptp(start, axis=0).max())
    apart = np.zeros((len(start), len(start)), dtype=bool)
    for axis in range(2):
        gap = low[:, None, axis] > high[None, :, axis] + margin
        apart |= gap | gap.T
    first, second = np.nonzero(np.triu(~apart, k=1))
    return first, second


def _side(p: Array, q: Array, r: Array, scale: float) -> Array:
    turn = (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]
    return np.asarray(np.where(np.abs(turn) <= scale, 0.0, np.sign(turn)))


def _between(p: Array, q: Array, r: Array) -> NDArray[np.bool_]:
    return np.asarray((np.minimum(p, q) <= r).all(axis=1) & (r <= np.maximum(p, q)).all(axis=1))


def _crossing(a: Array, b: Array, c: Array, d: Array) -> Array:
    across = (b - a)[:, 0] * (d - c)[:, 1] - (b - a)[:, 1] * (d - c)[:, 0]
    share = (c - a)[:, 0] * (d - c)[:, 1] - (c - a)[:, 1] * (d - c)[:, 0]
    return np.asarray(a + (share / np.where(across == 0.0, 1.0, across))[:, None] * (b - a))
