"""Shapes: immutable point sets with Boolean operators, named boundary parts and a bounding box."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property, reduce

from rfm.calculus.functions import maximum, minimum
from rfm.calculus.types import Array, Field, Value
from rfm.errors import GeometryError
from rfm.geometry import support
from rfm.geometry.box import Box
from rfm.geometry.carriers import move_field
from rfm.geometry.expression import Expression, Literal, conjunction
from rfm.geometry.part import Part, union
from rfm.geometry.similarity import Similarity, rotation, scaling, translation
from rfm.geometry.support import Support
from rfm.geometry.surface import Label, Surface

RESERVED = ("all", "rest")


@dataclass(frozen=True, eq=False)
class Shape:
    """A set given by a Boolean expression of surfaces.

    Parameters
    ----------
    dimension
        2 or 3.
    expression
        Boolean expression in negation normal form, positive inside.
    reach, outer_reach
        Support functions of the set and of its complement (``rfm.geometry.support``).
    """

    dimension: int
    expression: Expression
    reach: Support
    outer_reach: Support = support.everything

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
        """Field > 0 inside, 0 on the boundary, < 0 outside: min/max of the surface functions."""
        return Membership(self.expression)

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
        inside: Array = self.membership(*points.T) > 0.0
        return inside

    def named(self, name: str) -> Shape:
        """Return the same shape with every surface label prefixed by ``name``."""
        if name in RESERVED or not name.replace("_", "a").replace("-", "a").isalnum():
            raise GeometryError(
                f"a shape cannot be called {name!r}: use letters, digits, - and _, and neither of "
                + ", ".join(RESERVED)
            )
        return replace(self, expression=self.expression.mapped(lambda surface: surface.prefixed(name)))

    def __invert__(self) -> Shape:
        """Complement."""
        return Shape(self.dimension, self.expression.negated(), self.outer_reach, self.reach)

    def __and__(self, other: Shape) -> Shape:
        """Intersection; a factor whose complement lies clear of the other shape drops out."""
        self._compatible(other)
        if self.box.disjoint(other.outer_box):
            return self
        if other.box.disjoint(self.outer_box):
            return other
        expression = conjunction([self.expression, other.expression])
        reach = support.common(self.reach, other.reach)
        return Shape(self.dimension, expression, reach, support.either(self.outer_reach, other.outer_reach))

    def __or__(self, other: Shape) -> Shape:
        """Union."""
        return ~(~self & ~other)

    def __sub__(self, other: Shape) -> Shape:
        """Difference."""
        return self & ~other

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
        return Shape(
            self.dimension,
            self.expression.mapped(lambda surface: _moved(surface, similarity)),
            support.transformed(self.reach, similarity),
            support.transformed(self.outer_reach, similarity),
        )

    @property
    def _boundary(self) -> tuple[Surface, ...]:
        return tuple(surface for surface in self.surfaces if not surface.auxiliary)

    def _compatible(self, other: Shape) -> None:
        if not isinstance(other, Shape):
            raise TypeError(f"a shape can only be combined with a shape, not {type(other).__name__}")
        if self.dimension != other.dimension:
            raise GeometryError(
                f"shapes of dimension {self.dimension} and {other.dimension} cannot be combined"
            )

    def _unknown(self, name: str) -> str:
        known = [*self.parts, "all"]
        near = get_close_matches(name, known, n=1, cutoff=0.5)
        hint = f", did you mean {near[0]!r}?" if near else ""
        return f"the boundary has no part {name!r}{hint} (parts: {', '.join(known)})"


@dataclass(frozen=True)
class Membership:
    """The field that folds the surface functions with minimum and maximum."""

    expression: Expression

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates; every surface is evaluated once."""
        values = {surface: surface.function(*coords) for surface in self.expression.surfaces()}
        both: Callable[[list[Value]], Value] = lambda terms: reduce(minimum, terms)  # noqa: E731
        either: Callable[[list[Value]], Value] = lambda terms: reduce(maximum, terms)  # noqa: E731
        return self.expression.fold(
            lambda surface, positive: values[surface] if positive else -values[surface], both, either
        )


def single(surface: Surface, dimension: int, reach: Support, outer: Support = support.everything) -> Shape:
    """Shape bounded by one surface."""
    return Shape(dimension, Literal(surface), reach, outer)


def meet(surfaces: Sequence[Surface], dimension: int, reach: Support) -> Shape:
    """Shape that is the intersection of the inner sides of surfaces."""
    return Shape(dimension, conjunction([Literal(surface) for surface in surfaces]), reach)


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
