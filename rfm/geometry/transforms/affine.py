"""Affine maps and reflections.

Notation: the image of x is ``A x + b``.  Polynomial surfaces keep their degree, planes keep their unit
slope; a circle becomes an ellipse, whose function is normalised no more (Shapiro, Acta Numerica 2007,
section 6).  The support function of the image is ``h(A^T n) + n . b``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.checks import shown, unit, vector
from rfm.geometry.shape import Shape
from rfm.geometry.similarity import Similarity
from rfm.geometry.support import Support
from rfm.geometry.transforms.mapping import LinearMapping, mapped

LARGEST_CONDITION = 1e10
"""Of the matrix: beyond it the image is flat to rounding."""


@dataclass(frozen=True, eq=False)
class Affine(LinearMapping):
    """The map ``x -> matrix x + offset``."""

    matrix: Array
    offset: Array

    def image(self, reach: Support) -> Support:
        """Support function of the image."""

        def image(directions: Array) -> Array:
            turned = directions @ self.matrix
            lengths = np.linalg.norm(turned, axis=1)
            return np.asarray(lengths * reach(turned / lengths[:, None]) + directions @ self.offset)

        return image


def affine(
    shape: Shape, matrix: Sequence[Sequence[float]] | Array, shift: Sequence[float] | Array | None = None
) -> Shape:
    """Image of a shape under ``x -> matrix x + shift``.

    Parameters
    ----------
    shape
        Any shape of dimension d.
    matrix
        Nonsingular, (d, d); it may reverse the orientation.
    shift
        Vector (d,), zero by default.

    Raises
    ------
    GeometryError
        For a singular matrix or a wrong shape of the arguments.
    """
    d = shape.dimension
    rows = [vector("each row of matrix", row, d) for row in matrix]
    if len(rows) != d:
        raise GeometryError(f"matrix must have {d} rows, got {len(rows)}")
    forward = np.array(rows)
    largest, *_, smallest = np.linalg.svd(forward, compute_uv=False)
    if smallest * LARGEST_CONDITION <= largest:
        raise GeometryError(
            f"matrix must be nonsingular, got {shown(forward)} with determinant {np.linalg.det(forward):.3g}"
        )
    offset = vector("shift", shift if shift is not None else (0.0,) * d, d)
    inverse: Array = np.asarray(np.linalg.inv(forward), dtype=np.float64)
    mapping = Affine(inverse, -inverse @ offset, matrix=forward, offset=offset)
    return replace(mapped(shape, mapping), outer_reach=mapping.image(shape.outer_reach))


def mirror(shape: Shape, point: Sequence[float] | Array, normal: Sequence[float] | Array) -> Shape:
    """Reflect a shape in the line or plane through ``point``, perpendicular to ``normal``."""
    base, direction = vector("point", point, shape.dimension), unit("normal", normal, shape.dimension)
    matrix = np.eye(shape.dimension) - 2.0 * np.outer(direction, direction)
    return shape.transformed(Similarity(matrix, 1.0, 2.0 * float(direction @ base) * direction))
