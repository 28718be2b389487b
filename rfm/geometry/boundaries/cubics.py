r"""Arcs of plane cubics: Bezier curves of degree three, by implicitisation.

Notation: the arc is ``P(r) = sum_i a_i r^i``, 0 <= r <= 1; (ij) is the cross product of a_i and a_j, and
``L_i(x) = a_i x (a_0 - x)`` for i = 1, 2, 3.  Eliminating r from P(r) = x by Bezout's determinant [1] gives

    F = A (L_3 + C) L_1 - A L_2^2 - B^2 L_1 + 2 B L_2 L_3 - L_3^3 - C L_3^2,   A = (32), B = (31), C = (21),

a cubic polynomial that vanishes on the whole curve (r any real number) and in its double point, which may lie
off it.  The carrier is F normalised by (4.9), ``f = F / sqrt(F^2 + |grad F|^2)``, lengths being measured in half
chords R from the middle of the chord, so that F keeps its digits.

The arc is trimmed by a lens: the intersection of two disks through both ends, whose boundaries meet the chord
under an angle.  With (x, y) along and across the chord and k the cotangent of the angle,

    t = (2 a - sqrt(2 (a^2 + b^2))) / (2 + sqrt 2),   (a, b) = (1 - x^2 - y^2, 2 k y) / sqrt(2 (1 + x^2 + y^2)),

is the R_0-conjunction of the disks.  ``cubic_arcs`` cuts a curve so that each lens holds its arc and nothing else
of F = 0.

Reference: [1] T. W. Sederberg, Computer Aided Geometric Design (2012), chapter 17 (implicitisation by Bezout).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import guarded_power, sqrt
from rfm.calculus.types import Array, Value
from rfm.geometry.boundaries.ends import trimmed_around, trimmed_carrier
from rfm.geometry.boundaries.pieces import Curves, dot

ROOT = np.sqrt(2.0)

DOUBLE_POINT = 1e-200
"""Only felt where F and its gradient vanish together: the function is zero there, not undefined."""


@dataclass(frozen=True, eq=False)
class Cubics(Curves):
    """Arcs with ends, orthonormal frames (n, 2, d), coefficients (n, 4, 2), senses and k (n,).

    The first vector of a frame points along the chord; the coefficients are those of P in the frame, from
    the middle of the chord and in half chords.  The sense is +1 where F is positive on the left.
    """

    frame: Array
    coefficients: Array
    sense: Array
    cotangent: Array

    @property
    def size(self) -> Array:
        """Half the chord."""
        return np.asarray(0.5 * np.linalg.norm(self.end - self.start, axis=1))

    def functions(self, *coords: Value) -> Value:
        """See :class:`Pieces`."""
        size = self.size
        offsets = self._offsets(coords)
        x, y = (dot(offsets, self.frame[:, k].T) * (1.0 / size) for k in (0, 1))
        value, slope = self._carrier(x, y)
        f = value / sqrt(value * value + dot(slope, slope) + DOUBLE_POINT) * (size * self.sense)
        t = _lens(x, y, self.cotangent) * size
        if len(coords) == 2:
            return trimmed_carrier(f, t, size)
        height = dot(offsets, np.cross(self.frame[:, 0], self.frame[:, 1]).T)
        return trimmed_around(f * f + height * height, t, size)

    def side(self, *coords: Array) -> Array:
        """Sign of F, positive on the left."""
        offsets = self._offsets(coords)
        x, y = (dot(offsets, self.frame[:, k].T) / self.size for k in (0, 1))
        return np.asarray(self._carrier(x, y)[0] * self.sense)

    def samples(self) -> tuple[Array, Array]:
        """Points at r = 1/2 and left normals."""
        point = np.einsum("k,nkd->nd", [1.0, 0.5, 0.25, 0.125], self.coefficients)
        speed = np.einsum("k,nkd->nd", [0.0, 1.0, 1.0, 0.75], self.coefficients)
        points = (
            0.5 * (self.start + self.end) + np.einsum("nk,nkd->nd", point, self.frame) * self.size[:, None]
        )
        along = np.einsum("nk,nkd->nd", speed, self.frame)
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
        return points, normal / np.linalg.norm(normal, axis=1)[:, None]

    def bulge(self, x: Array, y: Array, left: Array) -> Array:
        """+1 in the lens between arc and chord on the left of the arc, -1 on the right."""
        offsets = self._offsets((x, y))
        local = [dot(offsets, self.frame[:, k].T) / self.size for k in (0, 1)]
        beside = self.side(x, y) > 0.0
        inside = _lens(local[0], local[1], self.cotangent) > 0.0
        return np.where(inside, beside.astype(np.float64) - left, 0.0)

    def reach(self, directions: Array) -> Array:
        """See :class:`Curves`; the stationary points of ``n . P(r)`` that are on the arc."""
        local = np.einsum("kd,njd->knj", directions, self.frame) * self.size[:, None]
        a = np.einsum("knj,nij->ikn", local, self.coefficients)
        with np.errstate(divide="ignore", invalid="ignore"):
            # 3 a_3 r^2 + 2 a_2 r + a_1 = 0, without the difference of nearly equal numbers
            root = np.sqrt(a[2] ** 2 - 3.0 * a[1] * a[3])
            q = -(a[2] + np.where(a[2] < 0.0, -root, root))
            stationary = (q / (3.0 * a[3]), a[1] / q)
        result = super().reach(directions)
        middle = directions @ (0.5 * (self.start + self.end)).T
        for r in stationary:
            r = np.clip(np.nan_to_num(r), 0.0, 1.0)
            result = np.maximum(result, (middle + a[0] + (a[1] + (a[2] + a[3] * r) * r) * r).max(axis=1))
        return result

    def _offsets(self, coords: tuple[Value, ...]) -> list[Value]:
        middle = 0.5 * (self.start + self.end)
        return [x - c for x, c in zip(coords, middle.T, strict=True)]

    def _carrier(self, x: Value, y: Value) -> tuple[Value, list[Value]]:
        """F and its gradient."""
        a = self.coefficients
        px, py = x - a[:, 0, 0], y - a[:, 0, 1]
        first, second, third = (a[:, i, 1] * px - a[:, i, 0] * py for i in (1, 2, 3))
        big_a, big_b, big_c = _cross(a[:, 3], a[:, 2]), _cross(a[:, 3], a[:, 1]), _cross(a[:, 2], a[:, 1])
        # F is quadratic in L_1, L_2 and cubic in L_3: written as a sum, and differentiated in them
        by_first = big_a * (third + big_c) - big_b * big_b
        mixed = 2.0 * (big_b * third - big_a * second)
        value = by_first * first + second * (2.0 * big_b * third - big_a * second)
        value = value - third * third * (third + big_c)
        by_third = big_a * first + 2.0 * big_b * second - third * (3.0 * third + 2.0 * big_c)
        parts = (by_first, mixed, by_third)
        slope = [dot(parts, a[:, 1:, 1].T), dot(parts, -a[:, 1:, 0].T)]
        return value, slope


def _lens(x: Value, y: Value, cotangent: Array) -> Value:
    squared = x * x + y * y
    scale = 1.0 / sqrt(2.0 * (squared + 1.0))
    a, b = (1.0 - squared) * scale, 2.0 * cotangent * y * scale
    return (2.0 * a - ROOT * guarded_power(a * a + b * b, 0.5)) * (1.0 / (2.0 + ROOT))


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
