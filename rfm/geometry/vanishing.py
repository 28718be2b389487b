"""Factors: functions that together vanish on a part of the boundary of a shape, and nowhere else.

The closed domain of an intersection lies on the inner side of every term, so a term that is a single
surface touches the domain only in its own part of the boundary: its carrier is used as it is.  A term
that is a union is zero on the domain's boundary only as a whole; when all of its surfaces are wanted
the R-disjunction of its members is the factor (sign-correct, kinks at re-entrant corners only), and
when some are, they are trimmed by what of them is really boundary (``rfm.geometry.trimming``).  An
intersection with a system of R-functions of its own is one factor: those of its terms, joined by it.

Where a surface is boundary is decided by its *critical* condition: the rest of the expression must
leave the decision to this surface (the Boolean difference of the two cofactors).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import reduce

from rfm.calculus.r_systems import RSystem
from rfm.calculus.types import Field, Value
from rfm.geometry.expression import (
    Conjunction,
    Disjunction,
    Expression,
    Literal,
    Node,
    assuming,
    conjunction,
    disjunction,
)
from rfm.geometry.part import Part
from rfm.geometry.surface import Surface
from rfm.geometry.trimming import Trimmed

Chosen = frozenset[Surface]


@dataclass(frozen=True, eq=False)
class Factor:
    """A field that vanishes on a piece of boundary, with the surfaces it stands for.

    Parameters
    ----------
    field
        Zero on the piece, positive inside the domain.
    surfaces
        Where it vanishes.
    hole
        Whether it belongs to an inner feature (the outside of a closed curve, a union's corner) rather
        than to the outline.
    depth
        The field is at least ``-depth`` in all of space; infinite when no bound is known.
    """

    field: Field
    surfaces: tuple[Surface, ...]
    hole: bool = True
    depth: float = math.inf

    @property
    def size(self) -> float:
        """Smallest feature size of its surfaces."""
        return min(surface.size for surface in self.surfaces)


@dataclass(frozen=True, eq=False)
class Composition:
    """R-function of an expression: the field that a system of R-functions makes of it."""

    expression: Expression
    system: RSystem
    function: Callable[[Surface], Field]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates; every surface is evaluated once."""
        values = {surface: self.function(surface)(*coords) for surface in self.expression.surfaces()}
        return self.expression.composed(values, self.system, coords)


@dataclass(frozen=True, eq=False)
class Product:
    """Product of fields."""

    fields: tuple[Field, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates; 1 without fields."""
        return reduce(lambda first, second: first * second, [field(*coords) for field in self.fields])


@dataclass(frozen=True, eq=False)
class Joined:
    """R-conjunction of fields."""

    fields: tuple[Field, ...]
    system: RSystem

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.system.at(*coords).conjunction(*(field(*coords) for field in self.fields))


def factors(
    expression: Expression, part: Part, system: RSystem, function: Callable[[Surface], Field] | None = None
) -> list[Factor]:
    """Factors whose common zero set in the closed domain is the part.

    Parameters
    ----------
    expression
        The shape's expression.
    part
        A part of its boundary.
    system
        R-functions for unions and for trimming conditions.
    function
        Field to be used for a surface; its own by default.
    """
    of = function if function is not None else _own
    found: list[Factor] = []
    for piece in part.pieces:
        for factor in _Builder(system, of, piece.surfaces).of_domain(expression):
            if piece.where is not None:
                factor = replace(factor, field=Trimmed(factor.field, piece.where), depth=math.inf)
            found.append(factor)
    return found


def critical(expression: Expression, surface: Surface) -> Expression | bool:
    """Condition under which the expression's truth depends on the sign of the surface.

    The Boolean difference ``E[s := true] xor E[s := false]``; for a surface that occurs once it is the
    conjunction of its neighbours in intersections and of the complements of those in unions.
    """
    if isinstance(expression, Literal):
        return expression.surface is surface
    if not isinstance(expression, Node):
        raise TypeError("an expression is a Literal, a Conjunction or a Disjunction")
    holders = [term for term in expression.terms if surface in term.surfaces()]
    if len(holders) != 1:
        return _difference(assuming(expression, surface, True), assuming(expression, surface, False))
    others = [term for term in expression.terms if term is not holders[0]]
    if isinstance(expression, Disjunction):
        others = [term.negated() for term in others]
    inner = critical(holders[0], surface)
    if inner is False:
        return False
    return conjunction([*others, inner] if isinstance(inner, Expression) else others)


@dataclass(frozen=True, eq=False)
class _Builder:
    """Factors for one choice of surfaces."""

    system: RSystem
    function: Callable[[Surface], Field]
    chosen: Chosen

    def of_domain(self, expression: Expression) -> list[Factor]:
        """Top level: terms of an intersection contribute separately, unless it has its own system."""
        if not isinstance(expression, Conjunction):
            return self._of_terms((expression,))
        if expression.system is None:
            return self._of_terms(expression.terms)
        return self._as_one([self.of_domain(term) for term in expression.terms], expression.system)

    def _as_one(self, groups: list[list[Factor]], system: RSystem) -> list[Factor]:
        """Join what the terms contribute by the system of their intersection."""
        kept = [group for group in groups if group]
        if len(kept) < 2:
            return kept[0] if kept else []
        fields = tuple(
            Product(tuple(f.field for f in group)) if len(group) > 1 else group[0].field for group in kept
        )
        surfaces = tuple(surface for group in kept for factor in group for surface in factor.surfaces)
        return [Factor(Joined(fields, system), surfaces, hole=False)]

    def _of_terms(self, terms: tuple[Expression, ...]) -> list[Factor]:
        relevant = [term for term in terms if self._wanted(term)]
        repeated = len({s for term in relevant for s in self._wanted(term)}) < sum(
            len(self._wanted(term)) for term in relevant
        )
        if repeated:  # a surface in several terms: separate factors would vanish there twice
            return self._of_term(conjunction(relevant))
        return [factor for term in relevant for factor in self._of_member(term)]

    def _of_member(self, term: Expression) -> list[Factor]:
        """One term of an intersection: only one with its own system is an intersection again."""
        return self.of_domain(term) if isinstance(term, Conjunction) else self._of_term(term)

    def _of_term(self, term: Expression) -> list[Factor]:
        if isinstance(term, Literal):
            return [_of_literal(self._composed(term), term)]
        if self._complete(term):
            return [Factor(self._composed(term), term.surfaces())]
        found: list[Factor] = []
        members = term.terms if isinstance(term, Disjunction) else (term,)
        whole = [member for member in members if self._complete(member)]
        if whole:
            rest = [member.negated() for member in members if member not in whole]
            joined = disjunction(whole)
            found.append(
                Factor(Trimmed(self._composed(joined), self._composed(conjunction(rest))), joined.surfaces())
            )
        done = {surface for member in whole for surface in member.surfaces()}
        found.extend(self._alone(term, surface) for surface in self._wanted(term) if surface not in done)
        return found

    def _alone(self, term: Expression, surface: Surface) -> Factor:
        """One surface, trimmed to where it is boundary."""
        sign = next(literal for literal in term.literals() if literal.surface is surface)
        condition = critical(term, surface)
        field = self._composed(sign)
        if isinstance(condition, Expression):
            field = Trimmed(field, self._composed(condition))
        return Factor(field, (surface,))

    def _wanted(self, term: Expression) -> list[Surface]:
        return [surface for surface in term.surfaces() if surface in self.chosen]

    def _complete(self, term: Expression) -> bool:
        return all(surface in self.chosen or surface.auxiliary for surface in term.surfaces())

    def _composed(self, expression: Expression) -> Field:
        if isinstance(expression, Literal) and expression.positive:
            return self.function(expression.surface)
        return Composition(expression, self.system, self.function)


def _of_literal(field: Field, literal: Literal) -> Factor:
    surface = literal.surface
    hole = not literal.positive and surface.degree != 1
    return Factor(field, (surface,), hole, surface.peak if hole else math.inf)


def _difference(first: Expression | bool, second: Expression | bool) -> Expression | bool:
    """Exclusive or of two cofactors."""
    if not isinstance(first, Expression):
        return _complement(second) if first else second
    if not isinstance(second, Expression):
        return _complement(first) if second else first
    one = conjunction([first, second.negated()])
    return disjunction([one, conjunction([second, first.negated()])])


def _complement(expression: Expression | bool) -> Expression | bool:
    return expression.negated() if isinstance(expression, Expression) else not expression


def _own(surface: Surface) -> Field:
    return surface.function
