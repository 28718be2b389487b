"""Scaling fields into [-1, 1] by their interval bounds over a box: nothing is cut off, signs and smoothness stay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError


@dataclass(frozen=True, eq=False)
class Scaled:
    """The field f / size."""

    field: Field
    size: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.field(*coords) * (1.0 / self.size)


def magnitude(field: Field, lower: Sequence[float], upper: Sequence[float], cells: int = 16) -> float:
    """Return a number that abs(f) does not exceed in a box.

    Parameters
    ----------
    field
        The field.
    lower, upper
        Corners of the box.
    cells
        Parts of each side over which f is bounded: the more, the tighter.

    Raises
    ------
    GeometryError
        When the field has no finite bound there.
    """
    sides = [np.linspace(low, high, cells + 1) for low, high in zip(lower, upper, strict=True)]
    starts = np.meshgrid(*[side[:-1] for side in sides], indexing="ij")
    ends = np.meshgrid(*[side[1:] for side in sides], indexing="ij")
    value = Interval.of(field(*[Interval(a, b) for a, b in zip(starts, ends, strict=True)]))
    size = float(np.max(np.maximum(np.abs(value.lo), np.abs(value.hi))))
    if not np.isfinite(size):
        raise GeometryError(f"the field has no bound in the box from {tuple(lower)} to {tuple(upper)}")
    return size


def scaled(field: Field, lower: Sequence[float], upper: Sequence[float], cells: int = 16) -> Scaled:
    """Return the field divided by its :func:`magnitude` in a box, so that its values there lie in [-1, 1]."""
    size = magnitude(field, lower, upper, cells)
    return Scaled(field, size if size > 0.0 else 1.0)
