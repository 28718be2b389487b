"""Taper: cross-sections that shrink or grow with the height.

Notation: the height z is the last coordinate; the section at height z is scaled about the axis by the linear
``s(z)``, so the image of f has the functions ``f(x/s(z), y/s(z), z)``.  A box becomes the convex hull of the images
of its corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import maximum
from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.box import Box
from rfm.geometry.checks import number, positive, shown
from rfm.geometry.shape import Shape
from rfm.geometry.support import Support
from rfm.geometry.transforms.mapping import Mapping, mapped


@dataclass(frozen=True, eq=False)
class Taper(Mapping):
    """The map back of a taper; ``box`` contains the shape, ``scale`` is 1 at ``start``."""

    start: float
    growth: float
    box: Box

    @property
    def dimension(self) -> int:
        """Of the shape."""
        return self.box.dimension

    @property
    def stretch(self) -> float:
        """Smallest scale, less what the slant of the sides takes."""
        lean = abs(self.growth) * max(np.abs([*self.box.lower[:-1], *self.box.upper[:-1]]))
        return float(min(self.smallest, 1.0) / np.hypot(1.0, lean))

    @property
    def smallest(self) -> float:
        """Smallest scale in the shape."""
        return float(
            min(1.0 + self.growth * (z - self.start) for z in (self.box.lower[-1], self.box.upper[-1]))
        )

    def back(self, *coords: Value) -> tuple[Value, ...]:
        """Preimage of a point; beyond the shape the scale stays away from 0."""
        *across, height = coords
        scale = maximum(1.0 + (height - self.start) * self.growth, 0.5 * self.smallest)
        return (*(x / scale for x in across), height)

    def image(self, reach: Support) -> Support:
        """Reach of the image of the box."""
        corners = self.box.corners()
        scales: Array = 1.0 + self.growth * (corners[:, -1:] - self.start)
        return support.points(np.column_stack([corners[:, :-1] * scales, corners[:, -1]]))


def taper(shape: Shape, start: float, end: float, factor: float) -> Shape:
    """Scale the sections of a bounded shape linearly from 1 at height ``start`` to ``factor`` at ``end``.

    Raises
    ------
    GeometryError
        For a factor that is not positive, heights that coincide, an unbounded shape, or one that reaches
        to where the scale vanishes.
    """
    start, end, factor = number("start", start), number("end", end), positive("factor", factor)
    if start == end:
        raise GeometryError(f"end must differ from start, both are {shown(start)}")
    if not shape.box.finite:
        raise GeometryError("only a bounded shape can be tapered; intersect it with a box")
    mapping = Taper(start, (factor - 1.0) / (end - start), shape.box)
    if mapping.smallest <= 0.0:
        tip = start - 1.0 / mapping.growth
        raise GeometryError(
            f"the taper comes to its tip at height {tip:.6g}, inside the shape, which reaches from "
            f"{shown(shape.box.lower[-1] + 0.0)} to {shown(shape.box.upper[-1])}"
        )
    return mapped(shape, mapping)
