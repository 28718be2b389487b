"""Cyclic symmetry: n shapes around a point (in the plane) or the z axis (in space).

Notation: (r, theta) polar coordinates about the center.  The folded point is ``(r cos w, r sin w)`` with

    w(theta) = triangle wave onto [0, pi/n]                                   exact, kinks at the rays pi k/n
             ~ pi/(2n) - (4/(pi n)) sum over i < K of cos((2i + 1) n theta)/(2i + 1)^2   its Fourier series, analytic

(Shapiro, Acta Numerica 2007, section 6, example 6.1).  The wave reflects: what the shape has in the sector
0 <= theta <= pi/n is seen 2n times, so a shape that is symmetric about the ray theta = 0 is seen n times.
The wave is even in theta, so theta may be taken in [0, pi], which has no branch cut.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from types import MappingProxyType

import numpy as np

from rfm.calculus.functions import absolute, atan2, cos, hypot, sin, where
from rfm.calculus.types import Array, Value
from rfm.calculus.waves import fold_series, triangle
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.checks import shown, vector
from rfm.geometry.shape import Shape
from rfm.geometry.support import Support
from rfm.geometry.transforms.mapping import Mapping, mapped
from rfm.geometry.transforms.screw import cylinder_reach, radius_about_axis

Wave = Callable[[Value], Value]

_BESIDE = 1e-14


@dataclass(frozen=True, eq=False)
class Kaleidoscope(Mapping):
    """The map of all sectors onto one; ``radius``, ``bottom`` and ``top`` bound the shape, the center is 0."""

    size: int
    wave: Wave
    radius: float
    bottom: float = 0.0
    top: float = 0.0

    @property
    def dimension(self) -> int:
        """Of the shape."""
        return self.size

    def back(self, *coords: Value) -> tuple[Value, ...]:
        """Folded point."""
        x, y, *height = coords
        # at the center the angle has no derivative; a point beside it stands for the center
        x = x + where((x == 0.0) & (y == 0.0), _BESIDE, 0.0)
        angle = self.wave(atan2(absolute(y), x))
        distance = hypot(x, y)
        return (distance * cos(angle), distance * sin(angle), *height)

    def image(self, reach: Support) -> Support:
        """Reach of the disk or cylinder in which the shapes turn."""
        if not math.isfinite(self.radius):
            return support.everything
        if self.size == 2:
            return support.ball(np.zeros(2), self.radius)
        return cylinder_reach(self.radius, self.bottom, self.top)


def cyclic(
    of: Shape,
    count: int,
    center: Sequence[float] | Array | None = None,
    by: str = "copies",
    terms: int = 8,
) -> Shape:
    """Return a shape and its images, ``count`` in all, evenly turned about ``center``.

    Parameters
    ----------
    of
        In space, the turns are about the line through ``center`` along z.
    count
        At least 2.
    center
        The origin by default.
    by
        ``copies``: Boolean union of turned shapes.  ``wave`` and ``fourier``: one set of functions for all, folded by
        the triangle wave or its Fourier series; the shape should be symmetric about the ray from the
        center along x.
    terms
        Number of terms of the series, for ``fourier``.

    Raises
    ------
    GeometryError
        For a count below 2, less than one term, or an unknown way.
    """
    if count != int(count) or count < 2:
        raise GeometryError(f"count must be a whole number of at least 2, got {shown(count)}")
    if terms < 1:
        raise GeometryError(f"terms must be at least 1, got {shown(terms)}")
    if by not in WAYS:
        raise GeometryError(f"by must be one of {', '.join(WAYS)}, got {by!r}")
    middle = vector("center", center if center is not None else (0.0,) * of.dimension, of.dimension)
    return WAYS[by](of.move((-middle).tolist()), int(count), terms).move(middle.tolist())


def _copies(shape: Shape, count: int, terms: int) -> Shape:
    axis = None if shape.dimension == 2 else (0.0, 0.0, 1.0)
    turned = [shape, *(shape.rotate(2.0 * math.pi * k / count, axis=axis) for k in range(1, count))]
    return reduce(lambda first, second: first | second, turned)


def _exact(shape: Shape, count: int, terms: int) -> Shape:
    half = 0.5 * math.pi / count
    # sectors of width pi/n, the first around pi/(2n): a triangle wave that starts in its trough
    return _folded(shape, lambda angle: triangle(angle - half, half) + half)


def _series(shape: Shape, count: int, terms: int) -> Shape:
    half = 0.5 * math.pi / count
    return _folded(shape, lambda angle: fold_series(angle - half, half, terms) + half)


def _folded(shape: Shape, wave: Wave) -> Shape:
    radius = radius_about_axis(shape)
    if shape.dimension == 2:
        return mapped(shape, Kaleidoscope(2, wave, radius))
    return mapped(shape, Kaleidoscope(3, wave, radius, shape.box.lower[2], shape.box.upper[2]))


WAYS: MappingProxyType[str, Callable[[Shape, int, int], Shape]] = MappingProxyType(
    {"copies": _copies, "wave": _exact, "fourier": _series}
)
"""How a shape is turned, by name."""
