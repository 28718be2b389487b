"""Data known at scattered points only, and properties of materials between features.

Points are features of dimension zero; transfinite interpolation (7.10) over points is Shepard's inverse
distance weighting,

    f(x) = sum_i f_i |x - p_i|^-mu / sum_j |x - p_j|^-mu,

which with an even mu is smooth and has vanishing derivatives below order mu at the points (flat spots) unless
slopes are given as well: f_i + s_i . (x - p_i).  All weights are positive with sum one, so no value leaves
the range of the data: a conductivity stays positive.

Notation: p_i, f_i points and values; mu exponent; W_i weights.  References: Shepard, Proc. ACM 23 (1968);
Shapiro, Acta Numerica 16 (2007), section 7; Biswas, Shapiro and Tsukanov, CAGD 21 (2004) (material
properties).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jet import value_of
from rfm.calculus.types import Array, Field, Value
from rfm.errors import StructureError
from structures.features import Feature
from structures.field_expression import Constant, FieldExpr, field
from structures.transfinite import interpolate


@dataclass(frozen=True, eq=False)
class Scattered:
    """Inverse distance interpolation of values (and slopes) at points, for coordinates of any kind but intervals.

    Attributes
    ----------
    points
        ``(n, d)``, distinct.
    values
        ``(n,)``.
    slopes
        ``(n, d)``, zero where nothing is known.
    half
        mu / 2.
    """

    points: Array
    values: Array
    slopes: Array
    half: int

    def __call__(self, *coords: Value) -> Value:
        """Evaluate; relative to the nearest point, whose weight would be infinite at the point itself."""
        where = np.stack(np.broadcast_arrays(*(np.asarray(value_of(x), float) for x in coords)), axis=-1)
        gaps = ((where[..., None, :] - self.points) ** 2).sum(axis=-1)
        nearest = self.points[gaps.argmin(axis=-1)]
        smallest = self._squared(coords, [nearest[..., axis] for axis in range(len(coords))])
        above: Value = 0.0
        below: Value = 0.0
        for i, point in enumerate(self.points):
            own = gaps.argmin(axis=-1) == i
            # the nearest point's own weight is one; keep its quotient away from 0/0
            squared = self._squared(
                coords, [np.where(own, point[a] + 1.0, point[a]) for a in range(len(point))]
            )
            share = (smallest / (squared + own * 1.0)) ** self.half
            share = share * (~own * 1.0) + own * 1.0
            datum: Value = self.values[i]
            for x, c, slope in zip(coords, point, self.slopes[i], strict=True):
                datum = datum + slope * (x - c) if slope else datum
            above, below = above + share * datum, below + share
        return above / below

    @staticmethod
    def _squared(coords: Sequence[Value], center: Sequence[Array]) -> Value:
        total: Value = 0.0
        for x, c in zip(coords, center, strict=True):
            total = total + (x - c) * (x - c)
        return total


def scattered(
    points: Sequence[Sequence[float]] | Array,
    values: Sequence[float] | Array,
    slopes: Sequence[Sequence[float]] | Array | None = None,
    exponent: int = 4,
) -> FieldExpr:
    """Return a smooth field through values at scattered points.

    Parameters
    ----------
    points, values
        ``(n, d)`` and ``(n,)``.
    slopes
        Gradients ``(n, d)`` at the points, where known.
    exponent
        mu, even; above d it is dominated by near points.

    Raises
    ------
    StructureError
        Without points, when numbers do not match, when points coincide or mu is not even and positive.
    """
    where, data = np.atleast_2d(np.asarray(points, float)), np.asarray(values, float)
    if not data.size or where.shape[0] != data.shape[0]:
        raise StructureError(f"{len(where)} points need as many values, got {data.size}")
    if exponent <= 0 or exponent % 2:
        raise StructureError(f"the exponent for scattered points must be even and positive, got {exponent}")
    if len(np.unique(where, axis=0)) < len(where):
        raise StructureError("two scattered points coincide: keep one value for each point")
    gradients = np.zeros_like(where) if slopes is None else np.asarray(slopes, float)
    if gradients.shape != where.shape:
        raise StructureError(f"slopes must have the shape of the points {where.shape}, got {gradients.shape}")
    return field(Scattered(where, data, gradients, exponent // 2))


def material(
    features: Sequence[tuple[Field | FieldExpr | float, Feature]], exponents: Sequence[float] | float = 2.0
) -> FieldExpr:
    """Return a positive property that takes given values on features and blends between them.

    Parameters
    ----------
    features
        Pairs (value, feature): points, curves, regions.
    exponents
        Smoothness of the blend, see :func:`structures.transfinite.weights`; even ones keep the weights
        positive on both sides of a curve.

    Raises
    ------
    StructureError
        When a constant value is not positive.
    """
    for value, where in features:
        datum = field(value)
        if isinstance(datum, Constant) and datum.value <= 0.0:
            raise StructureError(
                f"the property of a material must be positive, got {datum.value:g} on {where.name}"
            )
    return interpolate(features, exponents)
