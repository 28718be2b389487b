"""Axis-parallel boxes, possibly infinite, possibly empty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError


@dataclass(frozen=True)
class Box:
    """The product of the intervals ``[lower_j, upper_j]``; empty when some lower exceeds its upper."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]

    def __post_init__(self) -> None:
        """Store plain floats and check the lengths."""
        object.__setattr__(self, "lower", tuple(float(value) for value in self.lower))
        object.__setattr__(self, "upper", tuple(float(value) for value in self.upper))
        if len(self.lower) != len(self.upper):
            raise GeometryError(
                f"a box needs as many lower as upper bounds, got {len(self.lower)} and {len(self.upper)}"
            )

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.lower)

    @property
    def finite(self) -> bool:
        """Whether every bound is finite."""
        return bool(np.isfinite([*self.lower, *self.upper]).all())

    @property
    def empty(self) -> bool:
        """Whether the box contains no point."""
        return any(low > high for low, high in zip(self.lower, self.upper, strict=True))

    @property
    def size(self) -> tuple[float, ...]:
        """Length of every side."""
        return tuple(high - low for low, high in zip(self.lower, self.upper, strict=True))

    @property
    def center(self) -> tuple[float, ...]:
        """Midpoint."""
        return tuple(0.5 * (high + low) for low, high in zip(self.lower, self.upper, strict=True))

    def intersect(self, other: Box) -> Box:
        """Return the common part (empty when the boxes are disjoint)."""
        self._compatible(other)
        return Box(tuple(map(max, self.lower, other.lower)), tuple(map(min, self.upper, other.upper)))

    def hull(self, other: Box) -> Box:
        """Return the smallest box around both."""
        self._compatible(other)
        if self.empty or other.empty:
            return other if self.empty else self
        return Box(tuple(map(min, self.lower, other.lower)), tuple(map(max, self.upper, other.upper)))

    def contains(self, other: Box | Sequence[float], tolerance: float = 0.0) -> bool:
        """Whether a point or a whole box lies in the closed box (widened by ``tolerance``)."""
        inner = other if isinstance(other, Box) else Box(tuple(other), tuple(other))
        self._compatible(inner)
        if inner.empty:
            return True
        below = all(a <= b + tolerance for a, b in zip(self.lower, inner.lower, strict=True))
        return below and all(b - tolerance <= a for a, b in zip(self.upper, inner.upper, strict=True))

    def disjoint(self, other: Box) -> bool:
        """Whether the closed boxes have no point in common (touching ones have)."""
        return self.intersect(other).empty

    def padded(self, margin: float) -> Box:
        """Widen every side by ``margin`` at both ends."""
        return Box(tuple(low - margin for low in self.lower), tuple(high + margin for high in self.upper))

    def corners(self) -> Array:
        """Return the vertices, shape ``(2**d, d)``."""
        axes = [np.array(pair) for pair in zip(self.lower, self.upper, strict=True)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, self.dimension)

    def _compatible(self, other: Box) -> None:
        if self.dimension != other.dimension:
            raise GeometryError(
                f"boxes of dimension {self.dimension} and {other.dimension} cannot be combined"
            )
