"""Checks of the arguments of shapes; each says which argument is wrong and what it must be."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError


def shown(value: object) -> str:
    """Short text of a value for a message: ``-1`` rather than ``-1.0`` or ``np.float64(-1.0)``."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(shown(item) for item in value) + "]"
    return f"{value:g}" if isinstance(value, (int, float, np.number)) else repr(value)


def number(name: str, value: float) -> float:
    """Return a finite number."""
    try:
        result = float(value)
    except (TypeError, ValueError):
        raise GeometryError(f"{name} must be a number, got {shown(value)}") from None
    if not np.isfinite(result):
        raise GeometryError(f"{name} must be finite, got {shown(value)}")
    return result


def positive(name: str, value: float) -> float:
    """Return a finite positive number."""
    result = number(name, value)
    if result <= 0.0:
        raise GeometryError(f"{name} must be positive, got {shown(value)}")
    return result


def vector(name: str, value: Sequence[float] | Array, dimension: int) -> Array:
    """Return a finite vector of the given length."""
    try:
        result = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise GeometryError(f"{name} must be {dimension} numbers, got {shown(value)}") from None
    if result.shape != (dimension,):
        raise GeometryError(f"{name} must have {dimension} components, got {shown(value)}")
    if not np.isfinite(result).all():
        raise GeometryError(f"{name} must be finite, got {shown(value)}")
    return result


def unit(name: str, value: Sequence[float] | Array, dimension: int) -> Array:
    """Return a vector scaled to length one."""
    result = vector(name, value, dimension)
    length = float(np.linalg.norm(result))
    if length == 0.0:
        raise GeometryError(f"{name} must not be the zero vector")
    return np.asarray(result / length)
