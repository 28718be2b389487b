"""Similarities: ``x -> scale * matrix x + shift`` with an orthogonal matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.checks import positive, unit, vector


@dataclass(frozen=True, eq=False)
class Similarity:
    """The map ``x -> scale * matrix @ x + shift``; matrix orthogonal, scale positive."""

    matrix: Array
    scale: float
    shift: Array

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.shift)

    def __call__(self, points: Array) -> Array:
        """Image of points ``(..., d)``."""
        return np.asarray(self.scale * (points @ self.matrix.T) + self.shift)

    def inverse(self) -> Similarity:
        """Return the inverse map."""
        matrix = self.matrix.T
        return Similarity(matrix, 1.0 / self.scale, -(matrix @ self.shift) / self.scale)


def translation(shift: Sequence[float], dimension: int) -> Similarity:
    """Return the map ``x -> x + shift``."""
    return Similarity(np.eye(dimension), 1.0, vector("vector", shift, dimension))


def rotation(
    angle: float, dimension: int, axis: Sequence[float] | None = None, center: Sequence[float] | None = None
) -> Similarity:
    """Rotation by ``angle`` (radians, counter-clockwise; in 3D about ``axis``) that keeps ``center``."""
    if dimension == 2:
        if axis is not None:
            raise GeometryError("a rotation in the plane takes no axis")
        cos, sin = np.cos(angle), np.sin(angle)
        matrix = np.array([[cos, -sin], [sin, cos]])
    else:
        if axis is None:
            raise GeometryError("a rotation in space needs an axis, e.g. axis=(0, 0, 1)")
        matrix = rodrigues(unit("axis", axis, dimension), angle)
    pivot = vector("center", center if center is not None else (0.0,) * dimension, dimension)
    return Similarity(matrix, 1.0, pivot - matrix @ pivot)


def scaling(factor: float, dimension: int, center: Sequence[float] | None = None) -> Similarity:
    """Uniform scaling by ``factor`` that keeps ``center``."""
    factor = positive("factor", factor)
    pivot = vector("center", center if center is not None else (0.0,) * dimension, dimension)
    return Similarity(np.eye(dimension), factor, pivot * (1.0 - factor))


def rodrigues(axis: Array, angle: float) -> Array:
    """Rotation matrix (3, 3) about the unit vector ``axis`` (Rodrigues' formula)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross))


def frame(axis: Array) -> Array:
    """Orthonormal rows: two vectors across the unit vector ``axis`` (3,), then the axis itself.

    For an axis along a coordinate the rows are coordinate vectors, so that the linear forms built
    from them stay sparse (and cheap on jets).
    """
    start = np.eye(3)[(int(np.argmax(np.abs(axis))) + 1) % 3]
    first = start - (start @ axis) * axis
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(axis, first), axis])
