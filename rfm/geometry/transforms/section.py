"""Sections of a solid by planes, and its shadow as the union of them.

Notation: the plane through p with the unit normal n has the coordinates ``(u, v)``, ``x = p + u e1 + v e2``; the
section has the functions ``f(p + u e1 + v e2)`` (Shapiro, Acta Numerica 2007, section 6).  For a normal along x, y, z
the coordinates are (y, z), (z, x), (x, y).  A projection is the R-disjunction of all sections across
its direction; here of finitely many.

The support function of a section is the least of ``h(m + s n) - s n . p`` over s (exact for convex solids), taken over
a set of s, so a bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.carriers import Plane
from rfm.geometry.checks import shown, unit, vector
from rfm.geometry.expression import Expression, Literal, substituted
from rfm.geometry.shape import Shape
from rfm.geometry.similarity import frame
from rfm.geometry.support import Support
from rfm.geometry.surface import Surface
from rfm.geometry.transforms.mapping import LinearMapping

_TILTS = np.tan(np.linspace(-0.5, 0.5, 81) * np.pi * 0.98)
_PARALLEL = 1e-12


@dataclass(frozen=True, eq=False)
class Cut(LinearMapping):
    """The plane as a map from its two coordinates; ``normal`` is its unit normal."""

    normal: Array

    def image(self, reach: Support) -> Support:
        """Bound of the reach of the section."""

        def image(directions: Array) -> Array:
            bounds = []
            for tilt in _TILTS:
                inclined = directions @ self.rows.T + tilt * self.normal
                lengths = np.linalg.norm(inclined, axis=1)
                bounds.append(lengths * reach(inclined / lengths[:, None]) - inclined @ self.shift)
            return np.asarray(np.min(bounds, axis=0))

        return image


def section(of: Shape, point: Sequence[float] | Array, normal: Sequence[float] | Array) -> Shape:
    """Cut a solid with the plane through ``point`` across ``normal``; a shape of the plane.

    Raises
    ------
    GeometryError
        When the shape is no solid or the plane misses it.
    """
    _require_solid(of, "cut")
    found = _cut(of, vector("point", point, 3), unit("normal", normal, 3))
    if found is None:
        raise GeometryError(
            f"the plane through {shown(list(point))} across {shown(list(normal))} misses the solid"
        )
    return found


def projection(of: Shape, direction: Sequence[float] | Array, sections: int = 16) -> Shape:
    """Shadow of a bounded solid: the union of sections at evenly spaced heights along ``direction``.

    What the sections miss between them is missing, so the shape is too small, by an error that
    falls with their number.

    Raises
    ------
    GeometryError
        When the shape is no bounded solid, or there are no sections.
    """
    _require_solid(of, "projected")
    if sections < 1:
        raise GeometryError(f"sections must be at least 1, got {shown(sections)}")
    along = unit("direction", direction, 3)
    low, high = -float(of.reach(-along[None, :])[0]), float(of.reach(along[None, :])[0])
    if not np.isfinite([low, high]).all():
        raise GeometryError("only a solid that is bounded along the direction can be projected")
    heights = low + (high - low) * (np.arange(sections) + 0.5) / sections
    cuts = [_cut(of, height * along, along) for height in heights]
    return reduce(lambda first, second: first | second, [cut for cut in cuts if cut is not None])


def _cut(solid: Shape, point: Array, normal: Array) -> Shape | None:
    """Section, None when it is certainly empty."""
    height = float(normal @ point)
    above, below = solid.reach(np.array([normal, -normal]))
    if above <= height or below <= -height:
        return None
    cut = Cut(frame(normal)[:2].T, point, normal)
    done: dict[Surface, Expression | bool] = {}

    def leaf(surface: Surface, positive: bool) -> Expression | bool:
        if surface not in done:
            done[surface] = _trace(cut, surface)
        found = done[surface]
        if isinstance(found, Expression):
            return found if positive else found.negated()
        return found is positive

    expression = substituted(solid.expression, leaf)
    if not isinstance(expression, Expression):
        return None
    return Shape(2, expression, cut.image(solid.reach), system=solid.system)


def _trace(cut: Cut, surface: Surface) -> Expression | bool:
    """The line or curve in which a surface is cut; a truth value for a plane parallel to the cut."""
    if isinstance(surface.function, Plane):
        normal = np.array(surface.function.normal)
        if np.linalg.norm(normal @ cut.rows) <= _PARALLEL * np.linalg.norm(normal):
            return bool(float(surface.function(*cut.shift)) > 0.0)
    return Literal(cut.surface(surface))


def _require_solid(solid: Shape, how: str) -> None:
    if solid.dimension != 3:
        raise GeometryError(f"only a solid can be {how}; the shape is two-dimensional")
