"""Boundary conditions as differential operators, and what the general rule needs to know of them.

A condition asks ``B u = phi`` on a part w = 0.  With B of order k the general rule
(:mod:`structures.catalogue.rule`) changes u by w^k / k! F, which leaves all derivatives below order k alone
and changes B u on the part by sigma F:

    sigma = principal symbol of B at grad w:  every derivative of order k replaced by the slopes of w.

So a condition states its order, B applied to :class:`structures.layers.Layers`, and how to solve sigma F = r.
A vector field u has one component per operator; then sigma is a small matrix.

Notation: N = grad w, on the part the unit normal *into* the domain; n = -N the outward normal.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

from rfm.calculus.types import Field
from structures.field_expression import FieldExpr, field
from structures.layers import Layers
from structures.operator import Operator

Datum = Field | FieldExpr | float


class Condition(ABC):
    """One condition B u = phi on a part.

    Attributes
    ----------
    name
        What users call it.
    order
        k, the highest normal derivative in B.
    components
        Number of components of u.
    values
        phi, as many as B has rows.
    """

    name: str
    order: int
    components: int = 1

    @property
    @abstractmethod
    def values(self) -> tuple[FieldExpr, ...]:
        """The prescribed phi."""

    @abstractmethod
    def prescribing(self, values: Sequence[Datum]) -> Self:
        """Return the condition with other values phi."""

    @abstractmethod
    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return B u on the part."""

    @abstractmethod
    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Return F with sigma F = residual on the part (any solution where B does not determine all of F)."""

    @property
    def rows(self) -> frozenset[tuple[int, int]]:
        """Pairs (order, component) of the normal derivatives that the condition determines."""
        return frozenset((self.order, c) for c in range(self.components))

    @property
    def needs_normal(self) -> bool:
        """Whether B contains the normal."""
        return self.order > 0


@dataclass(frozen=True, eq=False)
class ScalarCondition(Condition):
    """A condition with one row, B u = value."""

    value: Datum

    @property
    def values(self) -> tuple[FieldExpr, ...]:
        """The prescribed value."""
        return (field(self.value),)

    def prescribing(self, values: Sequence[Datum]) -> Self:
        """Return the condition with another value."""
        (value,) = values
        return replace(self, value=value)


@dataclass(frozen=True, eq=False)
class VectorCondition(Condition):
    """A condition on a vector field with a row for every component that is given; None leaves one alone."""

    given: tuple[Datum | None, ...]

    @property
    def components(self) -> int:  # type: ignore[override]
        """Number of components of u."""
        return len(self.given)

    @property
    def fixed(self) -> tuple[int, ...]:
        """Indices of the given components."""
        return tuple(c for c, value in enumerate(self.given) if value is not None)

    @property
    def values(self) -> tuple[FieldExpr, ...]:
        """The prescribed values, without the free ones."""
        return tuple(field(value) for value in self.given if value is not None)

    @property
    def rows(self) -> frozenset[tuple[int, int]]:
        """What is determined."""
        return frozenset((self.order, c) for c in self.fixed)

    def prescribing(self, values: Sequence[Datum]) -> Self:
        """Return the condition with other values of the given components."""
        table = dict(zip(self.fixed, values, strict=True))
        return replace(self, given=tuple(table.get(c) for c in range(len(self.given))))


def reciprocal(symbol: FieldExpr, w: FieldExpr) -> FieldExpr:
    """Return a field equal to 1 / symbol on w = 0 that stays finite where the symbol vanishes elsewhere.

    w^4 leaves 1 / symbol alone near the part; with w^2 the collars of an oblique derivative need half as many cells
    more for the same error.
    """
    return symbol / (symbol * symbol + w**4)
