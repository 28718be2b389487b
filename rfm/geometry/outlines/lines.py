"""Half-planes of edges: one literal for each edge, one surface for each line.

Edges on a common line share the surface, of which they are named pieces, so that no boundary function
occurs under two names.  An edge without a label is a chord of an arc: it bounds nothing, and a line of
chords only is an auxiliary surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array, Value
from rfm.geometry.carriers import Plane, plane
from rfm.geometry.expression import Literal
from rfm.geometry.outlines.rings import TOLERANCE
from rfm.geometry.similarity import Similarity
from rfm.geometry.surface import Label, Piece, Surface


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


@dataclass(frozen=True, eq=False)
class Edges:
    """Directed segments, the solid to the left; ``labels`` has None for chords of arcs."""

    start: Array
    end: Array
    labels: tuple[Label | None, ...]

    def literals(self) -> list[Literal]:
        """One literal for every edge, positive to its left."""
        tangents = self.end - self.start
        tangents /= np.linalg.norm(tangents, axis=1)[:, None]
        normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
        origin = self.start.mean(axis=0)
        offsets = np.einsum("ij,ij->i", normals, 0.5 * (self.start + self.end) - origin)
        extent = float(np.ptp(self.start, axis=0).max())
        literals: dict[int, Literal] = {}
        for index, (normal, offset) in enumerate(zip(normals, offsets, strict=True)):
            if index in literals:
                continue
            same = np.sign(normals @ normal)
            on_line = np.abs(normal[0] * normals[:, 1] - normal[1] * normals[:, 0]) < TOLERANCE
            on_line &= np.abs(same * offsets - offset) < TOLERANCE * extent
            members = np.flatnonzero(on_line)
            surface = self._line(normal, members)
            literals |= {int(member): Literal(surface, bool(same[member] > 0.0)) for member in members}
        return [literals[index] for index in range(len(self.start))]

    def _line(self, normal: Array, members: NDArray[np.intp]) -> Surface:
        """Surface of the edges on one line."""
        middle = 0.5 * (self.start[members[0]] + self.end[members[0]])
        depth = (self.start - middle) @ normal
        named = sorted((label, int(index)) for index in members if (label := self.labels[index]) is not None)
        pieces = tuple(Piece(label, self._segment(index)) for label, index in named)
        together = "+".join(".".join(piece.label) for piece in pieces)
        return Surface(
            pieces[0].label if len(pieces) == 1 else (together or "chord",),
            plane(normal, float(normal @ middle)),
            degree=1,
            size=0.5 * float(np.abs(depth).max()),
            normalised=True,
            pieces=pieces if len(pieces) > 1 else (),
            auxiliary=not pieces,
        )

    def _segment(self, index: int) -> Segment:
        chord = self.end[index] - self.start[index]
        length = float(np.linalg.norm(chord))
        middle = 0.5 * (self.end[index] + self.start[index])
        return Segment(plane(chord / length, float(chord @ middle) / length), length)


def numbered(prefix: Sequence[str], ring: Array, clockwise: bool) -> tuple[Array, list[Label]]:
    """Counter-clockwise vertices of a ring, and the label of the edge that starts at each.

    Edge i of the ring as it was given keeps its number: walked backwards, the edge that starts at vertex i
    is the given edge i - 1.
    """
    count = len(ring)
    numbers = np.arange(count)
    if clockwise:
        ring, numbers = ring[::-1], (numbers[::-1] - 1) % count
    return ring, [(*prefix, f"edge{number}") for number in numbers]
