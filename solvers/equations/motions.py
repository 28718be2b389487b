"""Affine fields without energy: a constant temperature, the rigid motions of a body, the tilts of a plate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array


@dataclass(frozen=True, eq=False)
class Motion:
    """The field ``u_c(x) = shift[c] + slope[c] . x``.

    Attributes
    ----------
    name
        What it is, for messages.
    shift
        Constants, shape (n_components,).
    slope
        Gradients, shape (n_components, d).
    """

    name: str
    shift: Array
    slope: Array

    def values(self, coords: Sequence[Array]) -> Array:
        """Return the components at points, shape (n_components, *points)."""
        where = np.stack(np.broadcast_arrays(*coords))
        found: Array = np.tensordot(self.slope, where, axes=1)
        found += self.shift.reshape((-1,) + (1,) * (found.ndim - 1))
        return found


def constants(dimension: int, components: int) -> list[Motion]:
    """Return the translations, one for each component."""
    letters = "xyz"
    return [
        Motion(f"the translation along {letters[c]}", row, np.zeros((components, dimension)))
        for c, row in enumerate(np.eye(components))
    ]


def rotations(dimension: int) -> list[Motion]:
    """Return the infinitesimal rotations of a vector field about the origin."""
    found = []
    for i in range(dimension):
        for j in range(i + 1, dimension):
            slope = np.zeros((dimension, dimension))
            slope[i, j], slope[j, i] = -1.0, 1.0
            found.append(
                Motion(f"the rotation in the {'xyz'[i]}{'xyz'[j]} plane", np.zeros(dimension), slope)
            )
    return found


def tilts(dimension: int) -> list[Motion]:
    """Return the scalar fields x, y (, z)."""
    return [
        Motion(f"the tilt along {'xyz'[i]}", np.zeros(1), np.eye(dimension)[i : i + 1])
        for i in range(dimension)
    ]
