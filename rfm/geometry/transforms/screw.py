"""Screws and twists: cross-sections that turn with the height.

Notation: the section at height z is turned about the z axis by ``rate z``; the image of f has the functions
``f(x cos(rate z) + y sin(rate z), y cos(rate z) - x sin(rate z), z)``.  A screw (Shapiro, Acta Numerica 2007,
equation (6.3)) does that to a plane profile, ``rate = 2 pi/pitch``; a twist to a solid.  At distance r from the
axis lengths shrink by no more than ``sqrt(1 + k^2/4) - k/2``, ``k = |rate| r``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import cos, sin
from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.checks import number
from rfm.geometry.shape import Shape
from rfm.geometry.support import Support
from rfm.geometry.transforms.extrude import capped, require_plane
from rfm.geometry.transforms.mapping import Mapping, mapped

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Twist(Mapping):
    """The map back of a twist; with ``flat`` it leads to the plane.

    Parameters
    ----------
    rate
        Angle per unit of height.
    radius
        Distance from the axis within which the shape lies.
    bottom, top
        Its heights.
    flat
        Whether the shape that is twisted is plane.
    """

    rate: float
    radius: float
    bottom: float
    top: float
    flat: bool = False

    @property
    def dimension(self) -> int:
        """Of space."""
        return 3

    @property
    def stretch(self) -> float:
        """See the module's docstring."""
        shear = abs(self.rate) * self.radius
        return math.hypot(1.0, 0.5 * shear) - 0.5 * shear if math.isfinite(shear) else 1.0

    def back(self, *coords: Value) -> tuple[Value, ...]:
        """Preimage of a point."""
        x, y, z = coords
        angle = z * self.rate
        c, s = cos(angle), sin(angle)
        turned = (x * c + y * s, y * c - x * s)
        return turned if self.flat else (*turned, z)

    def image(self, reach: Support) -> Support:
        """Reach of the cylinder in which the shape turns."""
        return cylinder_reach(self.radius, self.bottom, self.top)


def screw(of: Shape, pitch: float, length: float) -> Shape:
    """Move a plane shape along the z axis from 0 to ``length`` while it turns once in every ``pitch``.

    Parameters
    ----------
    of
        Shape of the plane, in the section z = 0.
    pitch
        Height of a full turn; negative for a left-handed screw.
    length
        Height of the solid, positive.

    Returns
    -------
    Shape
        With the surfaces of the profile, and ``start`` and ``end``.

    Raises
    ------
    GeometryError
        For a pitch of zero or a length that is not positive.
    """
    require_plane(of, "screwed")
    pitch, length = number("pitch", pitch), number("length", length)
    if pitch == 0.0:
        raise GeometryError("pitch must not be 0: it is the height of a full turn")
    if length <= 0.0:
        raise GeometryError(f"length must be positive, got {length:g}")
    turned = Twist(2.0 * math.pi / pitch, radius_about_axis(of), 0.0, length, flat=True)
    return capped(of.expression.mapped(turned.surface), length, turned.image(of.reach))


def twist(shape: Shape, rate: float) -> Shape:
    """Turn every section z = constant of a solid by ``rate * z`` radians about the z axis.

    Raises
    ------
    GeometryError
        For a shape of the plane.
    """
    if shape.dimension != 3:
        raise GeometryError("only a solid can be twisted; the shape is two-dimensional")
    bottom, top = shape.box.lower[2], shape.box.upper[2]
    return mapped(shape, Twist(number("rate", rate), radius_about_axis(shape), bottom, top))


def radius_about_axis(shape: Shape) -> float:
    """Bound of the distance of a shape from the origin (of its plane) or the z axis."""
    directions = [[math.cos(t), math.sin(t)] for t in 2.0 * math.pi * np.arange(64) / 64]
    flat = np.array([[*pair, *[0.0] * (shape.dimension - 2)] for pair in directions])
    # the polygon of the tangents at 64 directions has its corners a little farther out
    return float(shape.reach(flat).max()) / math.cos(math.pi / 64)


def cylinder_reach(radius: float, bottom: float, top: float) -> Support:
    """Reach of a cylinder about the z axis, possibly infinite."""

    def reach(directions: Array) -> Array:
        across = np.linalg.norm(directions[:, :2], axis=1)
        heights = directions[:, 2]
        with np.errstate(invalid="ignore"):
            side = np.where(across > 0.0, radius * across, 0.0)
            ends = np.where(heights > 0.0, heights * top, np.where(heights < 0.0, heights * bottom, 0.0))
        return np.asarray(side + ends)

    return reach if math.isfinite(radius) else support.everything
