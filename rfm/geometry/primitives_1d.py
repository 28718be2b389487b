"""The primitive of the line: an interval, a factor of Cartesian products (``disk @ interval`` is a cylinder)."""

from __future__ import annotations

import numpy as np

from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.carriers import plane
from rfm.geometry.checks import number, shown
from rfm.geometry.shape import Shape, meet
from rfm.geometry.surface import Surface


def interval(min: float, max: float) -> Shape:
    """Numbers between two ends; surfaces bottom and top."""
    low, high = number("min", min), number("max", max)
    if high <= low:
        raise GeometryError(f"max must exceed min, got {shown(high)} and min {shown(low)}")
    half = 0.5 * (high - low)
    bottom = Surface(("bottom",), plane(np.array([1.0]), low), degree=1, size=half, normalised=True)
    top = Surface(("top",), plane(np.array([-1.0]), -high), degree=1, size=half, normalised=True)
    return meet([bottom, top], 1, support.points(np.array([[low], [high]])))
