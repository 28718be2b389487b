"""Extrusion: a plane profile swept along a vector.

Notation: the profile lies in the plane z = 0, the vector is ``d`` with ``d_z != 0``; the solid is
``{(p, 0) + t d : p in the profile, 0 < t < 1}``, a cylinder with the functions ``f(x - z d_x/d_z, y - z d_y/d_z)``
cut by the planes z = 0 and z = d_z (Shapiro, Acta Numerica 2007, section 6).  The support function is
``h(n_x, n_y) + max(0, n . d)``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.carriers import plane
from rfm.geometry.checks import shown, vector
from rfm.geometry.expression import Expression, Literal, conjunction
from rfm.geometry.shape import Shape
from rfm.geometry.support import Support
from rfm.geometry.surface import Surface
from rfm.geometry.transforms.mapping import LinearMapping

_FLAT = 1e-13


class Prism(LinearMapping):
    """The infinite cylinder along a direction."""

    def image(self, reach: Support) -> Support:
        """Nothing is known of it but across the direction; :func:`extrude` knows better."""
        return support.everything


def extrude(of: Shape, direction: Sequence[float] | Array) -> Shape:
    """Sweep a plane shape along a vector.

    Parameters
    ----------
    of
        Shape of the plane; it lies at z = 0.
    direction
        Vector of three components from the first copy to the last; its length counts.

    Returns
    -------
    Shape
        With the surfaces of the profile, and the plane ones ``start`` (z = 0) and ``end``.

    Raises
    ------
    GeometryError
        When the profile is not plane or the direction lies in its plane.
    """
    require_plane(of, "extruded")
    along = vector("direction", direction, 3)
    if abs(along[2]) <= _FLAT * float(np.linalg.norm(along)):
        raise GeometryError(f"direction must leave the plane of the profile, z is not 0, got {shown(along)}")
    slope = along[:2] / along[2]
    prism = Prism(np.column_stack([np.eye(2), -slope]), np.zeros(2))
    sides = of.expression.mapped(prism.surface)
    return capped(sides, float(along[2]), swept_reach(of.reach, along))


def capped(sides: Expression, height: float, reach: Support) -> Shape:
    """Cut a solid with the planes z = 0 and z = height; the surfaces ``start`` and ``end``."""
    up = np.array([0.0, 0.0, np.sign(height)])
    size = 0.5 * abs(height)
    start = Surface(("start",), plane(up, 0.0), degree=1, size=size, normalised=True)
    end = Surface(("end",), plane(-up, -abs(height)), degree=1, size=size, normalised=True)
    return Shape(3, conjunction([sides, Literal(start), Literal(end)]), reach)


def swept_reach(reach: Support, along: Array) -> Support:
    """Reach of ``{(p, 0) + t along, 0 < t < 1}``."""
    return support.minkowski_sum(flat(reach), support.points(np.array([np.zeros(3), along])))


def flat(reach: Support) -> Support:
    """Reach of a set of the plane z = 0."""

    def lifted(directions: Array) -> Array:
        result = np.zeros(len(directions))
        lengths = np.linalg.norm(directions[:, :2], axis=1)
        seen = lengths > 0.0
        result[seen] = lengths[seen] * reach(directions[seen, :2] / lengths[seen, None])
        return result

    return lifted


def require_plane(profile: Shape, how: str) -> None:
    """Refuse a profile that is no shape of the plane."""
    if profile.dimension != 2:
        raise GeometryError(f"a profile to be {how} must be two-dimensional, got a solid")
