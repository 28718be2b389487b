r"""Twisted cubics: Bezier curves of degree three in space that lie in no plane.

Notation: the curve is ``P(r) = o + r a_1 + r^2 a_2 + r^3 a_3``, 0 <= r <= 1.  In the skew coordinates (r, s, q) with
``x = o + r a_1 + s a_2 + q a_3`` it is s = r^2, q = r^3, exactly the common zeros of ``v = (s - r^2, q - r^3)``,
whose gradients J (2 x 3) are independent everywhere.  Hence

    f^2 = v . (J J^T)^(-1) v

is a quotient of polynomials without poles, zero on the curve only, and f has unit slope in every normal direction,
as (4.9) gives in codimension one.  Far away f grows like a square, so f^2 is replaced by
``f^2 / sqrt(1 + (f/m)^4)``, with m a distance to the middle of the piece that is smoothed there.  The slab
0 <= r <= 1 holds the piece and nothing else of the curve; it is trimmed as a parabola is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import sqrt
from rfm.calculus.types import Array, Value
from rfm.geometry.boundaries.ends import trimmed_around
from rfm.geometry.boundaries.parabolas import ball_around, slab
from rfm.geometry.boundaries.pieces import Pieces, dot


@dataclass(frozen=True, eq=False)
class TwistedCubics(Pieces):
    """Curves with start points (n, 3), dual vectors of a_1, a_2, a_3 (n, 3, 3), lengths (n,) and balls around them."""

    start: Array
    dual: Array
    length: Array
    center: Array
    radius: Array

    def functions(self, *coords: Value) -> Value:
        """See :class:`Pieces`."""
        offsets = [x - c for x, c in zip(coords, self.start.T, strict=True)]
        r, s, q = (dot(offsets, self.dual[:, k].T) for k in range(3))
        squared = r * r
        v = (s - squared, q - squared * r)
        first, second, third = self.dual.transpose(1, 2, 0)
        slopes = [
            [b - 2.0 * r * a for a, b in zip(first, second, strict=True)],
            [c - 3.0 * squared * a for a, c in zip(first, third, strict=True)],
        ]
        aa, ab, bb = dot(slopes[0], slopes[0]), dot(slopes[0], slopes[1]), dot(slopes[1], slopes[1])
        # the gradient of v_1 and that of v_2 made perpendicular to it: a sum of squares also in rounding
        rest = v[1] - v[0] * (ab / aa)
        level = v[0] * v[0] / aa + rest * rest / (bb - ab * ab / aa)
        rays = [x - c for x, c in zip(coords, self.center.T, strict=True)]
        share = level / (dot(rays, rays) + self.radius * self.radius)
        level = level / sqrt(share * share + 1.0)
        t = slab(r, self.length, self.center, self.radius, level, coords)
        return trimmed_around(level, t, 0.5 * self.length)


def twisted_cubic(control: Array, coefficients: Array) -> TwistedCubics:
    """Curve with four control points (4, 3) in no plane and coefficients o, a_1, a_2, a_3, as a batch of one."""
    _, first, second, third = coefficients
    length = 0.5 * (np.linalg.norm(first) + np.linalg.norm(first + 2.0 * second + 3.0 * third))
    dual = np.asarray(np.linalg.inv(coefficients[1:]).T)
    return TwistedCubics(control[:1], dual[None], np.array([length]), *ball_around(control))
