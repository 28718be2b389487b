r"""Cutting a plane cubic into arcs, each alone in its lens.

Notation: ``P(r) = sum_i a_i r^i`` for all real r is the whole curve, of which the piece 0 <= r <= 1 is wanted.  Its
implicit polynomial also vanishes on the rest of the curve and in the double point.  A polynomial cubic has one
double point P(u) = P(v); with sigma = u + v, pi = u v it follows from

    a_1 + a_2 sigma + a_3 (sigma^2 - pi) = 0:   sigma = -(a_3 x a_1) / (a_3 x a_2).

u and v are real (the curve crosses itself), equal (a cusp) or complex (an isolated point).  A piece is cut where it
passes the double point, and then in halves until a lens fits: it must hold the arc, its wider
neighbour nothing else of the zero set.  Both are questions about the real roots of polynomials of degree six, the
functions of the two disks of a lens along the curve.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

import numpy as np
from numpy.polynomial import Polynomial

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.boundaries.cubics import Cubics
from rfm.geometry.boundaries.pieces import Pieces, gathered
from rfm.geometry.checks import shown

LENSES = tuple(np.radians([(4, 7, 9), (8, 12, 15), (20, 27, 33), (35, 44, 52), (50, 60, 68), (62, 71, 78)]))
"""Half angles of three lenses: one that must hold the arc, the one to trim with, one that nothing else may enter.

The narrowest that will do is taken: outside of it the function grows, also where F vanishes again.
"""

DEEPEST = 16
"""Halvings after which the curve is given up."""

END = 1e-7
"""A parameter this close to an end is the end."""


BESIDE = 1e-3
"""Distance, in half chords, at which the sign of the polynomial on the left is looked up."""


@dataclass(frozen=True)
class Arc:
    """A candidate: coefficients (4, 2) in its local frame, from the middle of the chord, in half chords."""

    middle: Array
    frame: Array
    half: float
    local: Array

    def disks(self, angle: float) -> tuple[Polynomial, Polynomial]:
        """Return the functions of the two disks of a lens along the whole curve."""
        x, y = (Polynomial(self.local[:, k]) for k in (0, 1))
        level, tilt = 1.0 - x * x - y * y, 2.0 / np.tan(angle) * y
        return level + tilt, level - tilt

    def inside(self, angle: float) -> bool:
        """Tell whether the arc lies in the lens."""
        inner = np.linspace(0.0, 1.0, 65)[1:-1]
        turns = np.abs(np.arctan2(*_tangents(self.local)[:, ::-1].T))
        return bool(turns.max() < angle and all((disk(inner) > 0.0).all() for disk in self.disks(angle)))

    def alone(self, angle: float, isolated: Array | None) -> bool:
        """Tell whether nothing else of the zero set lies in the lens."""
        disks = self.disks(angle)
        roots = np.concatenate([disk.roots() for disk in disks])
        real = np.sort(roots[np.abs(roots.imag) <= END * (1.0 + np.abs(roots))].real)
        for before, after in pairwise(
            [-np.inf, *real[real < -END], 0.0, 1.0, *real[real > 1.0 + END], np.inf]
        ):
            if (before, after) != (0.0, 1.0) and all(disk(_between(before, after)) > 0.0 for disk in disks):
                return False
        if isolated is None:
            return True
        x, y = self.frame @ (isolated - self.middle) / self.half
        return bool(1.0 - x * x - y * y <= 2.0 / np.tan(angle) * abs(y))


def cubic_arcs(coefficients: Array) -> Cubics:
    """Arcs of the piece 0 <= r <= 1 of a plane cubic with coefficients a_0 .. a_3 (4, 2), a_3 not zero.

    Raises
    ------
    GeometryError
        When the curve has a cusp in the piece, or passes itself too closely for a lens to tell the branches apart.
    """
    breaks, isolated = _double_point(coefficients)
    stack = [(first, last, 0) for first, last in pairwise([0.0, *breaks, 1.0])][::-1]
    arcs: list[Pieces] = []
    while stack:
        first, last, depth = stack.pop()
        arc = _arc(_restricted(coefficients, first, last))
        angles = [] if arc is None else [b for a, b, c in LENSES if arc.inside(a) and arc.alone(c, isolated)]
        if arc is not None and angles:
            arcs.append(_batch(arc, coefficients, first, last, angles[0]))
            continue
        if depth == DEEPEST:
            place = _value(coefficients, first)
            raise GeometryError(
                f"the curve passes itself, or bends, too sharply at {shown(np.round(place, 6))} "
                f"(parameter {first:.4g}); split it there or move its control points"
            )
        middle = 0.5 * (first + last)
        stack += [(middle, last, depth + 1), (first, middle, depth + 1)]
    return cast(Cubics, gathered(arcs)[0])


def _double_point(a: Array) -> tuple[list[float], Array | None]:
    """Parameters inside the piece at which it passes its double point; the point itself when it is isolated."""
    cross = _cross(a[3], a[2])
    if abs(cross) <= 1e-14 * np.linalg.norm(a[3]) * np.linalg.norm(a[1:], axis=1).max():
        return [], None  # it is at infinity
    total = -_cross(a[3], a[1]) / cross
    product = total**2 + (a[3] @ (a[2] * total + a[1])) / (a[3] @ a[3])
    spread = 0.25 * total**2 - product
    if abs(spread) <= 1e-12 * (1.0 + total**2):
        cusp = 0.5 * total + 0.0  # not -0
        if -END < cusp < 1.0 + END:
            place = shown(np.round(_value(a, cusp), 6))
            raise GeometryError(
                f"the curve has a cusp at {place} (parameter {cusp:.4g}), where it has no tangent; "
                "move a control point"
            )
        return [], None
    if spread < 0.0:
        # r^2 = total r - product for either parameter, and the terms linear in r cancel
        return [], np.asarray(a[0] - product * a[2] - total * product * a[3])
    ends = sorted((0.5 * total - np.sqrt(spread), 0.5 * total + np.sqrt(spread)))
    return [r for r in ends if END < r < 1.0 - END], None


def _arc(a: Array) -> Arc | None:
    """Return the piece in its local frame; None when its ends meet."""
    end = a.sum(axis=0)
    chord = end - a[0]
    half = 0.5 * float(np.linalg.norm(chord))
    if half <= 1e-3 * np.abs(a[1:]).max():
        return None
    along = 0.5 * chord / half
    frame = np.array([along, [-along[1], along[0]]])
    middle = 0.5 * (a[0] + end)
    local = np.array([a[0] - middle, *a[1:]]) @ frame.T / half
    return Arc(middle, frame, half, local)


def _batch(arc: Arc, a: Array, first: float, last: float, angle: float) -> Cubics:
    start, end = _value(a, first), _value(a, last)
    piece = Cubics(
        start[None],
        end[None],
        arc.frame[None],
        arc.local[None],
        np.ones(1),
        np.array([1.0 / np.tan(angle)]),
    )
    points, normals = piece.samples()
    left = piece.side(*(points + BESIDE * arc.half * normals).T)
    return replace(piece, sense=np.sign(left))


def _restricted(a: Array, first: float, last: float) -> Array:
    """Coefficients of the piece from `first` to `last`, as 0 <= r <= 1."""
    step = Polynomial([first, last - first])
    columns = [Polynomial(a[:, k])(step).coef for k in range(a.shape[1])]
    return np.array([np.pad(c, (0, 4 - len(c))) for c in columns]).T


def _value(a: Array, r: float) -> Array:
    return np.asarray(r ** np.arange(4) @ a)


def _tangents(a: Array) -> Array:
    """Directions at both ends."""
    return np.array([a[1], a[1] + 2.0 * a[2] + 3.0 * a[3]])


def _between(before: float, after: float) -> float:
    if np.isinf(before):
        return after - 1.0
    return before + 1.0 if np.isinf(after) else 0.5 * (before + after)


def _cross(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
