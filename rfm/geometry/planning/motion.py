r"""Moving shapes and whether they meet.

A shape that moves rigidly is the set omega(A(t)^T (x - b(t))) >= 0 in space and time, A(t) a rotation by an angle
theta(t) about the moving origin b(t).  Two moving shapes i and j meet at the time t when some x lies in both, so with

.. math:: \sigma_{ij}(x, t) = \omega_i(x, t) \wedge \omega_j(x, t)

they never meet when sigma_ij < 0 for all x and all t: a statement about one function of n + 1 variables, which
intervals prove (:func:`clearance`); and the time of first contact is the least t with sigma_ij >= 0 for some x, a
constrained optimum (:func:`first_contact`).  Shapiro, Acta Numerica 16 (2007), section 6.4.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import cos, minimum, sin
from rfm.calculus.r_systems import R0
from rfm.calculus.types import Array, Field, Value
from rfm.errors import GeometryError
from rfm.geometry.box import Box
from rfm.geometry.planning.bounds import upper_bound
from rfm.geometry.planning.search import SAMPLES, STARTS, Region, monotone_search
from rfm.geometry.shape import Shape
from rfm.geometry.spread import spread

Path = Callable[[Value], Sequence[Value]]


@dataclass(frozen=True, eq=False)
class Motion:
    """A rigid motion of the plane or of space.

    Attributes
    ----------
    path
        From the time to the position of the shape's origin.
    angle
        From the time to the angle in radians, about the origin and, in space, about the z axis; no turn by default.
    """

    path: Path
    angle: Callable[[Value], Value] | None = None


@dataclass(frozen=True, eq=False)
class Moving:
    """The function of a moving shape in the coordinates and the time, which comes last."""

    membership: Field
    motion: Motion

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates and the time."""
        *x, t = coords
        local = [a - b for a, b in zip(x, self.motion.path(t), strict=True)]
        if self.motion.angle is not None:
            turn = self.motion.angle(t)
            c, s = cos(turn), sin(turn)
            local[:2] = [c * local[0] + s * local[1], c * local[1] - s * local[0]]
        return self.membership(*local)


@dataclass(frozen=True)
class Clash:
    """Where and when two moving shapes first touch.

    Attributes
    ----------
    time
        The time.
    point
        A common point at that time, shape (n,).
    """

    time: float
    point: Array


def moving(shape: Shape, motion: Motion) -> Field:
    """Return the function of a moving shape: positive inside at the time that follows the coordinates."""
    return Moving(shape.membership, motion)


def clearance(first: Field, second: Field, box: Box, tolerance: float = 1e-3) -> float:
    """Prove a bound of sigma: two moving shapes never meet when it is negative.

    Parameters
    ----------
    first, second
        Functions of coordinates and time (:func:`moving`).
    box
        Box in space and time in which they could meet; its last side is the time.
    tolerance
        How close the bound is wanted to the largest value of sigma.

    Returns
    -------
    float
        min(first, second) is nowhere larger in the box.
    """
    smaller = _Smaller(first, second)
    return upper_bound(_anything, smaller, box, _reached(smaller, box), tolerance).value


def first_contact(
    first: Field, second: Field, box: Box, tolerance: float = 1e-6, starts: Array | int = STARTS
) -> Clash | None:
    """Find when two moving shapes first touch.

    Parameters
    ----------
    first, second, box
        As in :func:`clearance`.
    tolerance
        Of the time, relative to the box.
    starts
        Points in space and time to search from, or how many.

    Returns
    -------
    Clash or None
        None when no start leads to a common point; :func:`clearance` then proves that there is none.
    """
    both = Region((first, second, _Within(box)), R0)
    try:
        found = monotone_search(both, _Earlier(), box, tolerance * 1e-3, starts)
    except GeometryError:
        return None
    return Clash(float(found.point[-1]), found.point[:-1])


def _anything(*coords: Value) -> Value:
    return 1.0


def _reached(smaller: Field, box: Box) -> float:
    """The largest value at points spread over the box."""
    points = np.array(box.lower) + spread(SAMPLES, box.dimension) * np.array(box.size)
    return float(np.nanmax(np.asarray(smaller(*points.T))))


@dataclass(frozen=True, eq=False)
class _Smaller:
    """min(f, g)."""

    first: Field
    second: Field

    def __call__(self, *coords: Value) -> Value:
        return minimum(self.first(*coords), self.second(*coords))


@dataclass(frozen=True)
class _Earlier:
    """The objective -t."""

    def __call__(self, *coords: Value) -> Value:
        return -coords[-1]


@dataclass(frozen=True)
class _Within:
    """Positive inside a box: the R-conjunction of its sides."""

    box: Box

    def __call__(self, *coords: Value) -> Value:
        sides = [
            (x - low) * (high - x) * (1.0 / (high - low))
            for x, low, high in zip(coords, self.box.lower, self.box.upper, strict=True)
        ]
        return R0.conjunction(*sides)
