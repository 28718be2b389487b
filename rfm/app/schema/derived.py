"""Shapes made of other shapes, one model for each kind.

The keys of a kind are the arguments of its constructor in :mod:`rfm.geometry.derived`; `of` holds names of shapes,
or expressions of them, where the constructor takes shapes.  Angles are in degrees here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from rfm.app.domain import DomainExpression
from rfm.app.schema.kind import Kind
from rfm.app.schema.references import ShapeExpression, Shapes, SpaceVector
from rfm.app.schema.scalars import (
    DIMENSION_WORDS,
    Number,
    Positive,
    Vector,
    choice,
    fail,
    integer,
    positive,
    shown,
    within,
)
from rfm.app.yaml_reader import Path


class Derived(Kind):
    """A shape made of others.

    Attributes
    ----------
    takes
        Dimension of the shapes it is made of; 0 for any, which then is its own.
    """

    takes: ClassVar[int] = 0
    of: Any

    def operands(self) -> Iterator[tuple[Path, DomainExpression]]:
        """Return expressions of the shapes it is made of, each with its place."""
        for name in type(self).model_fields:
            value = getattr(self, name)
            if isinstance(value, DomainExpression):
                yield (name,), value
            elif isinstance(value, tuple):
                yield from (((name, i), v) for i, v in enumerate(value) if isinstance(v, DomainExpression))

    def made_of(self, build: Callable[[DomainExpression], Any]) -> dict[str, Any]:
        """Arguments for the constructor, with what `build` makes of them in the place of expressions."""

        def built(value: Any) -> Any:
            if isinstance(value, DomainExpression):
                return build(value)
            return [build(item) for item in value] if _mentions(value) else value

        return {name: built(value) for name, value in self.arguments().items()}

    def refuse(self, dimension: int) -> str | None:
        """Say what is wrong with an operand of a dimension."""
        if self.takes and dimension != self.takes:
            return f"must be {DIMENSION_WORDS[self.takes]}, but is {DIMENSION_WORDS[dimension]}"
        return None


def _mentions(value: Any) -> bool:
    return isinstance(value, tuple) and any(isinstance(item, DomainExpression) for item in value)


def _positive_numbers(count: int) -> Any:
    def validate(value: Any, info: ValidationInfo) -> tuple[float, ...]:
        if not isinstance(value, list | tuple) or len(value) != count:
            raise fail(f"must be a list of {count} numbers, got {shown(value)}")
        return tuple(within(i, positive, item, info) for i, item in enumerate(value))

    schema = {"type": "array", "items": {"type": ["number", "string"]}, "minItems": count, "maxItems": count}
    return Annotated[tuple[float, ...], BeforeValidator(validate), WithJsonSchema(schema)]


Operation = choice("union", "intersection")


class Blend(Derived):
    """Union with a fillet, or intersection with rounded edges: the rho-blend."""

    of: Shapes
    radius: Positive
    operation: Operation = "union"  # type: ignore[valid-type]
    smoothness: integer(1, 7) = 1  # type: ignore[valid-type]


class DisplacementBlend(Derived):
    """Union or intersection of two shapes, displaced by `amount` where their boundaries meet."""

    of: Shapes
    amount: Number
    ranges: _positive_numbers(2) | None = None  # type: ignore[valid-type]
    operation: Operation = "union"  # type: ignore[valid-type]


class BoundedBlend(Derived):
    """Union or intersection of two shapes, displaced by `amount` where their boundaries meet `within` a set."""

    of: Shapes
    within: ShapeExpression
    amount: Number
    ranges: _positive_numbers(3) | None = None  # type: ignore[valid-type]
    operation: Operation = "union"  # type: ignore[valid-type]


class Offset(Derived):
    """Shape whose boundary is moved outward, or inward for a negative distance; corners stay sharp."""

    of: ShapeExpression
    distance: Number


class Shell(Derived):
    """Layer inside the boundary of a shape; the inner surfaces are inner."""

    of: ShapeExpression
    thickness: Positive


class Repeat(Derived):
    """Row of `count` shapes, one `step` apart, as `copies` or folded by the triangle `wave` (mirrored in turn)."""

    of: ShapeExpression
    step: Vector
    count: integer(2, 10_000)  # type: ignore[valid-type]
    by: choice("copies", "wave") = "copies"  # type: ignore[valid-type]


class RepeatSeries(Derived):
    """Endless row of a shape by the Fourier series of the triangle wave: one analytic function."""

    of: ShapeExpression
    step: Vector
    terms: integer(1, 1000) = 8  # type: ignore[valid-type]


class Cyclic(Derived):
    """`count` shapes around a center, as `copies`, or folded by the triangle `wave` or its `fourier` series."""

    of: ShapeExpression
    count: integer(2, 10_000)  # type: ignore[valid-type]
    center: Vector | None = None
    by: choice("copies", "wave", "fourier") = "copies"  # type: ignore[valid-type]
    terms: integer(1, 1000) = 8  # type: ignore[valid-type]


class Sweep(Derived):
    """What a shape passes through while it moves and turns evenly: the union of `samples` places."""

    of: ShapeExpression
    move: Vector | None = None
    angle: Number = 0.0
    axis: SpaceVector | None = None
    center: Vector | None = None
    samples: integer(2, 10_000) = 8  # type: ignore[valid-type]


class Extrude(Derived):
    """Plane profile swept along a vector from z = 0; the plane ends are start and end."""

    dimension = 3
    takes = 2
    of: ShapeExpression
    direction: SpaceVector


class Revolve(Derived):
    """Plane profile (x: distance from the axis, y: height) turned about an axis through `point`."""

    dimension = 3
    takes = 2
    of: ShapeExpression
    axis: SpaceVector = (0.0, 0.0, 1.0)
    point: SpaceVector = (0.0, 0.0, 0.0)


class Screw(Derived):
    """Plane profile moved along z by `length` while it turns once in every `pitch`; ends start and end."""

    dimension = 3
    takes = 2
    of: ShapeExpression
    pitch: Number
    length: Positive


class Section(Derived):
    """Section of a solid by the plane through `point` across `normal`."""

    dimension = 2
    takes = 3
    of: ShapeExpression
    point: SpaceVector
    normal: SpaceVector


class Projection(Derived):
    """Shadow of a solid along a direction: the union of `sections` sections."""

    dimension = 2
    takes = 3
    of: ShapeExpression
    direction: SpaceVector
    sections: integer(1, 10_000) = 16  # type: ignore[valid-type]
