"""Sweep: what a moving shape passes through, as the union of the shape at some times.

Notation: M(t), 0 <= t <= 1, is a motion; the swept set is the R-disjunction of ``f(M(t)^-1 x)`` over t (Shapiro,
Acta Numerica 2007, section 6).  With finitely many times its boundary shows scallops, of a depth that falls
with the square of their number where the boundary is smooth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.carriers import composed
from rfm.geometry.checks import number, shown, vector
from rfm.geometry.shape import Shape
from rfm.geometry.similarity import Similarity, rotation, translation

Motion = Callable[[float], Similarity]


def sweep(
    of: Shape,
    move: Sequence[float] | Array | None = None,
    angle: float = 0.0,
    axis: Sequence[float] | None = None,
    center: Sequence[float] | None = None,
    samples: int = 8,
) -> Shape:
    """Sweep a shape that turns by ``angle`` (radians) about ``center`` and moves by a vector, both evenly.

    Raises
    ------
    GeometryError
        When it does not move at all, or for less than two samples.
    """
    return sweep_along(of, helix(of.dimension, move, angle, axis, center), samples)


def sweep_along(shape: Shape, motion: Motion, samples: int = 8) -> Shape:
    """Union of a shape at the times 0, 1/(samples - 1), ..., 1.

    Raises
    ------
    GeometryError
        For less than two samples.
    """
    if samples != int(samples) or samples < 2:
        raise GeometryError(f"samples must be a whole number of at least 2, got {shown(samples)}")
    places = [shape.transformed(motion(float(t))) for t in np.linspace(0.0, 1.0, int(samples))]
    return reduce(lambda first, second: first | second, places)


def helix(
    dimension: int,
    move: Sequence[float] | Array | None = None,
    angle: float = 0.0,
    axis: Sequence[float] | None = None,
    center: Sequence[float] | None = None,
) -> Motion:
    """Return the motion that turns by ``angle`` (radians) about ``center`` and moves by a vector, both evenly.

    Raises
    ------
    GeometryError
        When it does not move at all.
    """
    shift = vector("move", move if move is not None else (0.0,) * dimension, dimension)
    angle = number("angle", angle)
    if angle == 0.0 and not shift.any():
        raise GeometryError("a sweep needs a motion: a vector to move by, an angle to rotate by, or both")

    def motion(t: float) -> Similarity:
        moved = translation((t * shift).tolist(), dimension)
        if angle == 0.0:
            return moved
        return composed(moved, rotation(t * angle, dimension, axis, center))

    return motion
