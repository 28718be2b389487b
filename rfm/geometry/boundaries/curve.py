r"""Regions of the plane inside a closed curve of lines, arcs, Bezier and B-spline curves.

Notation: piece k runs from where piece k - 1 ends.  The region is {F > 0}, F the signed function of the
joint boundary (``signed``), which is normalised on it.  Part ``piece<k>`` of the boundary is where piece k is nearer
than the others: where the joint function of the others exceeds its own.

F is analytic on each piece but not at the joints, and it is one function for the whole boundary: not a polynomial, and
as costly as there are pieces.  Where lines and arcs will do, ``outline`` gives polynomials.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any, cast

import numpy as np

from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.boundaries.arcs import arc_through
from rfm.geometry.boundaries.beziers import bezier, spline
from rfm.geometry.boundaries.pieces import Curves, Joined
from rfm.geometry.boundaries.segments import SAME_POINT, checked_points, segment
from rfm.geometry.boundaries.signed import signed
from rfm.geometry.shape import Shape, single
from rfm.geometry.surface import Piece, Surface

ORDER = 2
"""Of the R-equivalence.

With 4 the function is closer to the distance but bends more sharply inside: measured on a region between two
parabolas, cubic splines lose an order.
"""


@dataclass(frozen=True, eq=False)
class Nearer:
    """Positive where `own` is nearer than `others`."""

    own: Joined
    others: Joined

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.others(*coords) - self.own(*coords)


def curve(start: Sequence[float], pieces: Sequence[Mapping[str, Any]]) -> Shape:
    """Region inside a closed curve; ``piece<i>`` is piece i.

    Parameters
    ----------
    start
        Where the curve starts.
    pieces
        Each a mapping of one key: ``line`` (its end), ``arc`` (a point on it and its end), ``bezier`` or ``spline``
        (the control points after the current one, the last of which is the end; splines are cubic,
        uniform and clamped).  A line closes the curve when it does not end where it started.

    Raises
    ------
    GeometryError
        When a piece is degenerate (which one), there is none, or the curve encloses nothing.
    """
    if not pieces:
        raise GeometryError("pieces must not be empty")
    place = np.asarray(start, dtype=np.float64)
    path = [place]
    joined: list[Joined] = []
    for i, piece in enumerate(pieces):
        (kind, given), *more = piece.items()
        if more or kind not in BUILDERS:
            raise GeometryError(f"piece {i} must be one of {', '.join(BUILDERS)}, got {', '.join(piece)}")
        try:
            points = checked_points(
                [path[-1].tolist(), *([given] if kind == "line" else given)], "a piece", 2
            )
            joined.append(BUILDERS[kind](points))
        except GeometryError as error:
            raise GeometryError(f"piece {i}: {error}") from None
        path.append(points[-1])
    extent = float(np.ptp(np.array(path), axis=0).max())
    if np.linalg.norm(path[-1] - path[0]) > SAME_POINT * extent:
        joined.append(segment(path[-1].tolist(), path[0].tolist()))
    return region(joined)


def region(pieces: Sequence[Joined]) -> Shape:
    """Region inside closed curves; ``piece<i>`` is the i-th of the given parts.

    Raises
    ------
    GeometryError
        When the curves are open or enclose nothing.
    """
    whole = reduce(lambda a, b: a | b, pieces)
    boundary = signed(Joined(whole.batches, ORDER))
    if not any(inward.any() for inward in boundary.inward):
        raise GeometryError("the curve encloses nothing: it runs back on itself")

    def reach(directions: Array) -> Array:
        bounds = [cast(Curves, batch).reach(directions) for batch in whole.batches]
        return np.asarray(np.max(bounds, axis=0))

    labels = [f"piece{i}" for i in range(len(pieces))]
    parts = []
    if len(pieces) > 1:
        for i, label in enumerate(labels):
            others = reduce(lambda a, b: a | b, [piece for k, piece in enumerate(pieces) if k != i])
            parts.append(Piece((label,), Nearer(pieces[i], others)))
    surface = Surface(
        ("+".join(labels),),
        boundary,
        size=0.5 * min(support.bounding_box(reach, 2).size),
        normalised=True,
        pieces=tuple(parts),
    )
    return single(surface, 2, reach)


def _arc(points: Array) -> Joined:
    if len(points) != 3:
        raise GeometryError("an arc has a point on it and its end")
    return arc_through(*points.tolist())


BUILDERS: dict[str, Callable[[Array], Joined]] = {
    "line": lambda points: segment(*points.tolist()),
    "arc": _arc,
    "bezier": bezier,
    "spline": lambda points: spline(points, min(3, len(points) - 1)),
}
