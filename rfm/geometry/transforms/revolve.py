"""Solids of revolution.

Notation: the profile lives in the half-plane of the coordinates (r, t), r >= 0 the distance from the axis and
t the height along it; the solid has the functions ``f(r, t)`` (Shapiro, Acta Numerica 2007, section 6).  Only the
half r > 0 of the profile is revolved.

``r = sqrt(p^2 + q^2)`` has a kink on the axis, so wherever the carrier allows it a polynomial with the same
sign takes the place of ``f(r, t)``: a line becomes a plane, a cylinder ``(R^2 - r^2)/(2R)`` or a cone
``(s^2 - a^2 r^2)/(2L)`` with a plane through its tip, a circle a sphere or a torus (with a sphere that parts its
sheets where the circle crosses the axis), an ellipse with an axis on the axis an ellipsoid.  Other functions
are composed with r.  The support function is ``h(|n_across|, n_along)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from rfm.calculus.functions import hypot
from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError
from rfm.geometry.carriers import Plane, Quadric, Sphere, Torus, plane
from rfm.geometry.checks import unit, vector
from rfm.geometry.expression import Conjunction, Disjunction, Expression, Literal, substituted
from rfm.geometry.shape import Shape
from rfm.geometry.similarity import frame
from rfm.geometry.support import Support
from rfm.geometry.surface import Surface
from rfm.geometry.transforms.extrude import require_plane
from rfm.geometry.transforms.mapping import Mapping


@dataclass(frozen=True, eq=False)
class Revolution(Mapping):
    """The map back: a point of space to its distance from an axis and its height along it."""

    point: Array
    rows: Array

    @property
    def dimension(self) -> int:
        """Of space."""
        return 3

    @property
    def isometric(self) -> bool:
        """The gradient keeps its length."""
        return True

    @cached_property
    def forms(self) -> tuple[Plane, Plane, Plane]:
        """Two coordinates across the axis and the height along it."""
        first, second, along = (plane(row, float(row @ self.point)) for row in self.rows)
        return first, second, along

    def back(self, *coords: Value) -> tuple[Value, ...]:
        """Distance from the axis and height."""
        first, second, along = (form(*coords) for form in self.forms)
        return hypot(first, second), along

    def image(self, reach: Support) -> Support:
        """Support function of the solid."""

        def image(directions: Array) -> Array:
            along = directions @ self.rows[2]
            across = np.linalg.norm(directions - along[:, None] * self.rows[2], axis=1)
            return np.asarray(reach(np.column_stack([across, along])) + directions @ self.point)

        return image

    def literal(self, given: Surface) -> Expression | bool:
        """Revolve the inner side of a surface; a truth value when it has no boundary where r > 0."""
        if isinstance(given.function, Plane):
            return self._line(given, given.function)
        if isinstance(given.function, Sphere):
            return self._circle(given, given.function)
        if isinstance(given.function, Quadric) and _even(given.function):
            return Literal(replace(self.surface(given), function=self._quadric(given.function), degree=2))
        return Literal(self.surface(given))

    def _circle(self, given: Surface, circle: Sphere) -> Expression:
        """Revolve a disk: a ball, a torus, or what a disk across the axis sweeps with its half r > 0."""
        (distance, height), radius = circle.center, circle.radius
        first, second, along = self.forms
        center = tuple((self.point + height * self.rows[2]).tolist())
        if distance == 0.0:
            return Literal(replace(self.surface(given), function=Sphere(center, radius), degree=2))
        function = Torus(abs(distance), radius, (first, second), replace(along, offset=along.offset + height))
        surface = replace(self.surface(given), function=function, degree=4, normalised=False)
        if distance >= radius:
            return Literal(surface)
        if distance <= -radius:  # nothing of it at r > 0: an intersection that is empty
            return Conjunction((Literal(surface), Literal(surface, False)))
        # the ball through the points where the circles cross parts the two sheets of the quartic
        waist = (radius**2 - distance**2) ** 0.5
        parting = Surface(given.label, Sphere(center, waist), degree=2, size=waist, auxiliary=True)
        if distance > 0.0:
            return Disjunction((Literal(surface), Literal(parting)))
        return Conjunction((Literal(surface, False), Literal(parting)))

    def _quadric(self, given: Quadric) -> Quadric:
        """Revolve a quadric that is even in the distance from the axis."""
        first, second, along = self.forms
        factors: list[float] = []
        forms: list[Plane] = []
        for factor, form in zip(given.factors, given.forms, strict=True):
            a, b = form.normal
            if b == 0.0:
                factors += [factor * a * a] * 2
                forms += [first, second]
            else:
                factors.append(factor)
                forms.append(Plane(tuple(b * n for n in along.normal), b * along.offset + form.offset))
        return Quadric(given.constant, tuple(factors), tuple(forms))

    def _line(self, given: Surface, line: Plane) -> Expression | bool:
        """Revolve ``a r + b t > c``."""
        a, b = line.normal
        first, second, along = self.forms
        surface = replace(self.surface(given), degree=2)
        if a == 0.0:
            level = Plane(tuple(b * n for n in along.normal), b * along.offset + line.offset)
            return Literal(replace(surface, function=level, degree=1))
        if b == 0.0:
            radius = line.offset / a
            if radius <= 0.0:
                return a > 0.0
            tube = Quadric(0.5 * radius, (-0.5 / radius,) * 2, (first, second))
            scaled = replace(surface, function=tube, size=radius, peak=0.5 * radius)
            return Literal(scaled, a < 0.0)
        # |a| r against s = b t - c (below the cone for a < 0): the cone s^2 = a^2 r^2 and the side of its tip
        side = 1.0 if a < 0.0 else -1.0
        form = Plane(tuple(side * b * n for n in along.normal), side * (b * along.offset + line.offset))
        scale = 0.5 / (given.size if np.isfinite(given.size) else 1.0)
        cone = Quadric(0.0, (-scale * a * a, -scale * a * a, scale), (first, second, form))
        nappe = Surface(given.label, form, degree=1, size=given.size, auxiliary=True)
        lateral = replace(surface, function=cone, normalised=False)
        inner = Conjunction((Literal(lateral), Literal(nappe)))
        return inner if a < 0.0 else inner.negated()


def _even(given: Quadric) -> bool:
    """Whether every form depends on the distance alone, without an offset, or on the height alone."""
    return all(form.normal[0] == 0.0 or (form.normal[1] == 0.0 == form.offset) for form in given.forms)


def revolve(
    of: Shape,
    axis: Sequence[float] | Array = (0.0, 0.0, 1.0),
    point: Sequence[float] | Array = (0.0, 0.0, 0.0),
) -> Shape:
    """Turn a plane shape about an axis.

    Parameters
    ----------
    of
        Shape of the plane: its x is the distance from the axis, its y the height along it, counted from
        ``point``.  What lies at x < 0 is cut off.
    axis
        Direction of the axis in space.
    point
        A point of the axis.

    Raises
    ------
    GeometryError
        When the profile is not plane or has nothing on the positive side of its axis.
    """
    require_plane(of, "revolved")
    direction, base = unit("axis", axis, 3), vector("point", point, 3)
    if of.box.upper[0] <= 0.0:
        raise GeometryError(
            "the profile has no point with x > 0, where x is the distance from the axis: move it there"
        )
    turned = Revolution(base, frame(direction))

    def leaf(surface: Surface, positive: bool) -> Expression | bool:
        found = cache.setdefault(surface, turned.literal(surface))
        if isinstance(found, Expression):
            return found if positive else found.negated()
        return found is positive

    cache: dict[Surface, Expression | bool] = {}
    expression = substituted(of.expression, leaf)
    if not isinstance(expression, Expression):
        raise GeometryError("the profile has no boundary where x > 0: there is nothing to revolve")
    return Shape(3, expression, turned.image(of.reach), turned.image(of.outer_reach), of.system)
