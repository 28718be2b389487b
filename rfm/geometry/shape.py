"""Shapes: immutable point sets with Boolean operators, named boundary parts and a bounding box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from typing import TYPE_CHECKING

from rfm.calculus.r_systems import R1, RSystem
from rfm.calculus.r_systems import system as r_system
from rfm.calculus.types import Array, Field, Value
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.box import Box
from rfm.geometry.carriers import move_field
from rfm.geometry.expression import Expression, Literal, conjunction
from rfm.geometry.lifting import lifted, product_reach
from rfm.geometry.part import Part, union
from rfm.geometry.similarity import Similarity, rotation, scaling, translation
from rfm.geometry.support import Support
from rfm.geometry.surface import Label, Surface

if TYPE_CHECKING:
    from rfm.geometry.predicate.report import NormalisationReport

RESERVED = ("all", "rest")

MINIMUM: RSystem = R1()
"""Minimum and maximum: what a membership is made of unless another system is asked for."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A set given by a Boolean expression of surfaces.

    Parameters
    ----------
    dimension
        2 or 3; 1 for an interval, a factor of products.
    expression
        Boolean expression in negation normal form, positive inside.
    reach, outer_reach
        Support functions of the set and of its complement (``rfm.geometry.support``).
    system
        R-functions of the operations without a system of their own, in `membership`; minimum and maximum
        by default.
    """

    dimension: int
    expression: Expression
    reach: Support
    outer_reach: Support = support.everything
    system: RSystem = MINIMUM

    @cached_property
    def box(self) -> Box:
        """Bounding box (infinite sides where the set is unbounded)."""
        return support.bounding_box(self.reach, self.dimension)

    @cached_property
    def outer_box(self) -> Box:
        """Bounding box of the complement."""
        return support.bounding_box(self.outer_reach, self.dimension)

    @cached_property
    def surfaces(self) -> tuple[Surface, ...]:
        """Distinct surfaces in order of first occurrence."""
        return self.expression.surfaces()

    @property
    def membership(self) -> Field:
        """Field > 0 inside, 0 on the boundary, < 0 outside: the R-function of the surface functions.

        Its sign is that of `sign`, up to rounding where the system's formula cancels.
        """
        return Membership(self.expression, self.system)

    @cached_property
    def sign(self) -> Field:
        """Minimum and maximum of the surface functions whatever the systems: the exact sign decides."""
        return Membership(self.expression.plain(), MINIMUM)

    @property
    def parts(self) -> tuple[str, ...]:
        """Selectable names, ``plate`` before ``plate.left``; ``all`` is always selectable too."""
        names: dict[str, None] = {}
        for label in (label for surface in self._boundary for label in surface.labels):
            for depth in range(1, len(label) + 1):
                names[".".join(label[:depth])] = None
        return tuple(names)

    def part(self, name: str) -> Part:
        """Select the boundary surfaces whose label begins with ``name`` (``all``: every surface).

        Raises
        ------
        GeometryError
            When no surviving surface has that name.
        """
        if name == "all":
            return Part("all", frozenset(self._boundary))
        wanted = tuple(name.split("."))
        found = [piece for surface in self._boundary for piece in _matching(surface, wanted)]
        if not found:
            raise GeometryError(self._unknown(name))
        return union(found, name)

    def contains(self, points: Array) -> Array:
        """Whether points ``(n, d)`` lie in the open set, shape ``(n,)``."""
        inside: Array = self.sign(*points.T) > 0.0
        return inside

    def named(self, name: str) -> Shape:
        """Return the same shape with every surface label prefixed by ``name``."""
        if name in RESERVED or not name.replace("_", "a").replace("-", "a").isalnum():
            raise GeometryError(
                f"a shape cannot be called {name!r}: use letters, digits, - and _, and neither of "
                + ", ".join(RESERVED)
            )
        return replace(self, expression=self.expression.mapped(lambda surface: surface.prefixed(name)))

    def using(self, system: str | RSystem) -> Shape:
        """Return the same set; its `membership` is made by a system of R-functions (``r0``, ``rp4``, ...).

        Raises
        ------
        GeometryError
            When there is no such system.
        """
        return replace(self, system=_system(system))

    def __invert__(self) -> Shape:
        """Complement."""
        return replace(
            self, expression=self.expression.negated(), reach=self.outer_reach, outer_reach=self.reach
        )

    def intersect(self, other: Shape, system: str | RSystem | None = None) -> Shape:
        """Intersection by a system of R-functions; a factor that holds all of the other shape drops out.

        Parameters
        ----------
        other
            A shape of the same dimension.
        system
            R-functions (or their name) of this operation in `membership` and in weights; without it the
            defaults of either.

        Raises
        ------
        GeometryError
            For another dimension, an unknown system, or shapes with different default systems.
        """
        self._compatible(other)
        chosen = _system(system) if system is not None else None
        default = self._default(other)
        if self.box.disjoint(other.outer_box):
            return replace(self, system=default)
        if other.box.disjoint(self.outer_box):
            return replace(other, system=default)
        expression = conjunction([self.expression, other.expression], chosen)
        reach = support.common(self.reach, other.reach)
        outer = support.either(self.outer_reach, other.outer_reach)
        return Shape(self.dimension, expression, reach, outer, default)

    def unite(self, other: Shape, system: str | RSystem | None = None) -> Shape:
        """Union by a system of R-functions, see `intersect`."""
        self._compatible(other)
        return ~(~self).intersect(~other, system)

    def subtract(self, other: Shape, system: str | RSystem | None = None) -> Shape:
        """Difference by a system of R-functions, see `intersect`."""
        self._compatible(other)
        return self.intersect(~other, system)

    def exclusive(self, other: Shape, system: str | RSystem | None = None) -> Shape:
        """Points in exactly one of two shapes, see `intersect`."""
        return self.subtract(other, system).unite(other.subtract(self, system), system)

    def implies(self, other: Shape, system: str | RSystem | None = None) -> Shape:
        """Points that lie in the other shape if they lie in this one: ``~self | other``."""
        return (~self).unite(other, system)

    def iff(self, other: Shape, system: str | RSystem | None = None) -> Shape:
        """Points in both shapes or in neither: the complement of `exclusive`."""
        return ~self.exclusive(other, system)

    def product(self, other: Shape, system: str | RSystem | None = None) -> Shape:
        """Cartesian product: points whose first coordinates lie in this shape, the others in the other one.

        Raises
        ------
        GeometryError
            When the product has more than three dimensions.
        """
        if not isinstance(other, Shape):
            raise _no_shape(other)
        split, dimension = self.dimension, self.dimension + other.dimension
        if dimension > 3:
            raise GeometryError(
                f"a product of shapes of dimension {split} and {other.dimension} has more than three dimensions"
            )
        factors = [
            self.expression.mapped(lambda surface: lifted(surface, 0, split)),
            other.expression.mapped(lambda surface: lifted(surface, split, dimension)),
        ]
        return Shape(
            dimension,
            conjunction(factors, _system(system) if system is not None else None),
            product_reach(self.reach, other.reach, split),
            system=self._default(other),
        )

    def __and__(self, other: Shape) -> Shape:
        """Intersection."""
        return self.intersect(other)

    def __or__(self, other: Shape) -> Shape:
        """Union."""
        return self.unite(other)

    def __sub__(self, other: Shape) -> Shape:
        """Difference."""
        return self.subtract(other)

    def __xor__(self, other: Shape) -> Shape:
        """Points in exactly one of the two."""
        return self.exclusive(other)

    def __matmul__(self, other: Shape) -> Shape:
        """Cartesian product."""
        return self.product(other)

    def report(self, system: str | RSystem | None = None) -> NormalisationReport:
        """Report whether the function of the shape is normalised, by Theorem 4."""
        from rfm.geometry.predicate.report import normalisation_report

        return normalisation_report(self, system)

    def move(self, vector: Sequence[float]) -> Shape:
        """Translate."""
        return self.transformed(translation(vector, self.dimension))

    def rotate(
        self, angle: float, axis: Sequence[float] | None = None, center: Sequence[float] | None = None
    ) -> Shape:
        """Rotate by ``angle`` in radians, counter-clockwise; in space about ``axis`` through ``center``."""
        return self.transformed(rotation(angle, self.dimension, axis, center))

    def scale(self, factor: float, center: Sequence[float] | None = None) -> Shape:
        """Scale uniformly, keeping ``center`` (the origin)."""
        return self.transformed(scaling(factor, self.dimension, center))

    def transformed(self, similarity: Similarity) -> Shape:
        """Image under a similarity; labels stay."""
        return replace(
            self,
            expression=self.expression.mapped(lambda surface: _moved(surface, similarity)),
            reach=support.transformed(self.reach, similarity),
            outer_reach=support.transformed(self.outer_reach, similarity),
        )

    @property
    def _boundary(self) -> tuple[Surface, ...]:
        return tuple(surface for surface in self.surfaces if not surface.auxiliary)

    def _compatible(self, other: Shape) -> None:
        if not isinstance(other, Shape):
            raise _no_shape(other)
        if self.dimension != other.dimension:
            raise GeometryError(
                f"shapes of dimension {self.dimension} and {other.dimension} cannot be combined"
            )

    def _default(self, other: Shape) -> RSystem:
        """Return the default system of an operation: what either shape was told to use."""
        told = [shape.system for shape in (self, other) if shape.system != MINIMUM]
        if len(told) == 2 and told[0] != told[1]:
            raise GeometryError(
                f"the shapes use different systems, {told[0]} and {told[1]}; call using(...) on one of them "
                "with the system of the other"
            )
        return told[0] if told else MINIMUM

    def _unknown(self, name: str) -> str:
        known = [*self.parts, "all"]
        near = get_close_matches(name, known, n=1, cutoff=0.5)
        hint = f", did you mean {near[0]!r}?" if near else ""
        return f"the boundary has no part {name!r}{hint} (parts: {', '.join(known)})"


@dataclass(frozen=True)
class Membership:
    """The R-function of an expression: Shapiro's Theorem 3, R-functions substituted for set operations."""

    expression: Expression
    system: RSystem = MINIMUM

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates; every surface is evaluated once."""
        values = {surface: surface.function(*coords) for surface in self.expression.surfaces()}
        return self.expression.composed(values, self.system, coords)


def single(surface: Surface, dimension: int, reach: Support, outer: Support = support.everything) -> Shape:
    """Shape bounded by one surface."""
    return Shape(dimension, Literal(surface), reach, outer)


def meet(surfaces: Sequence[Surface], dimension: int, reach: Support) -> Shape:
    """Shape that is the intersection of the inner sides of surfaces."""
    return Shape(dimension, conjunction([Literal(surface) for surface in surfaces]), reach)


def _system(system: str | RSystem) -> RSystem:
    return r_system(system) if isinstance(system, str) else system


def _no_shape(other: object) -> TypeError:
    return TypeError(f"a shape can only be combined with a shape, not {type(other).__name__}")


def _matching(surface: Surface, wanted: Label) -> list[Part]:
    """Return the parts of a surface whose labels begin with ``wanted``."""
    name = ".".join(wanted)
    hits = [label[: len(wanted)] == wanted for label in surface.labels]
    if all(hits):
        return [Part(name, frozenset([surface]))]
    chosen = [piece for piece, hit in zip(surface.pieces, hits, strict=False) if hit]
    return [Part(name, frozenset([surface]), piece.where) for piece in chosen]


def _moved(surface: Surface, similarity: Similarity) -> Surface:
    pieces = tuple(replace(piece, where=move_field(piece.where, similarity)) for piece in surface.pieces)
    return replace(
        surface,
        function=move_field(surface.function, similarity),
        size=surface.size * similarity.scale,
        peak=surface.peak * similarity.scale,
        pieces=pieces,
    )
