"""Boolean expressions over surfaces, in negation normal form.

A literal is a surface or its complement; ``Conjunction`` is an intersection, ``Disjunction`` a union.
Conjunction by minimum and disjunction by maximum give the exact zero set (the R1 system: Shapiro,
Acta Numerica 2007, section 2); the same two operations on the signs -1, 0, +1 give the tri-state
logic that cell classification needs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any, TypeVar

import numpy as np

from rfm.geometry.surface import Surface

T = TypeVar("T")
Reduction = Callable[[list[T]], T]


@dataclass(frozen=True)
class Expression:
    """Base of the three kinds of node."""

    def fold(self, leaf: Callable[[Surface, bool], T], both: Reduction[T], either: Reduction[T]) -> T:
        """Evaluate bottom-up with any interpretation of literals, intersections and unions."""
        raise TypeError("an expression is a Literal, a Conjunction or a Disjunction")

    def evaluate(self, values: Mapping[Surface, Any]) -> Any:
        """Min/max of the surfaces' values (a negative literal is minus its value); arrays or signs."""
        return self.fold(
            lambda surface, positive: values[surface] if positive else -values[surface],
            lambda terms: reduce(np.minimum, terms),
            lambda terms: reduce(np.maximum, terms),
        )

    def surfaces(self) -> tuple[Surface, ...]:
        """Distinct surfaces in order of first occurrence."""
        return tuple(dict.fromkeys(literal.surface for literal in self.literals()))

    def literals(self) -> tuple[Literal, ...]:
        """All literals from left to right, repetitions included."""
        return self.fold(
            lambda surface, positive: (Literal(surface, positive),),
            lambda terms: sum(terms, ()),
            lambda terms: sum(terms, ()),
        )

    def mapped(self, change: Callable[[Surface], Surface]) -> Expression:
        """Replace every surface; equal surfaces stay equal."""
        table = {surface: change(surface) for surface in self.surfaces()}
        return self.fold(
            lambda surface, positive: Literal(table[surface], positive),
            lambda terms: Conjunction(tuple(terms)),
            lambda terms: Disjunction(tuple(terms)),
        )

    def negated(self) -> Expression:
        """Complement, again in negation normal form (De Morgan)."""
        return self.fold(
            lambda surface, positive: Literal(surface, not positive),
            lambda terms: Disjunction(tuple(terms)),
            lambda terms: Conjunction(tuple(terms)),
        )


@dataclass(frozen=True)
class Literal(Expression):
    """A surface's inner side, or (``positive=False``) its outer side."""

    surface: Surface
    positive: bool = True

    def fold(self, leaf: Callable[[Surface, bool], T], both: Reduction[T], either: Reduction[T]) -> T:
        """See :meth:`Expression.fold`."""
        return leaf(self.surface, self.positive)


@dataclass(frozen=True)
class Conjunction(Expression):
    """Intersection of the terms (at least one)."""

    terms: tuple[Expression, ...]

    def fold(self, leaf: Callable[[Surface, bool], T], both: Reduction[T], either: Reduction[T]) -> T:
        """See :meth:`Expression.fold`."""
        return both([term.fold(leaf, both, either) for term in self.terms])


@dataclass(frozen=True)
class Disjunction(Expression):
    """Union of the terms (at least one)."""

    terms: tuple[Expression, ...]

    def fold(self, leaf: Callable[[Surface, bool], T], both: Reduction[T], either: Reduction[T]) -> T:
        """See :meth:`Expression.fold`."""
        return either([term.fold(leaf, both, either) for term in self.terms])


def conjunction(terms: Iterable[Expression]) -> Expression:
    """Intersection, flattened, without repeated terms and without terms the literals already decide."""
    return _joined(terms, Conjunction, True)


def disjunction(terms: Iterable[Expression]) -> Expression:
    """Union, simplified like :func:`conjunction`."""
    return _joined(terms, Disjunction, False)


def substituted(
    expression: Expression, leaf: Callable[[Surface, bool], Expression | bool]
) -> Expression | bool:
    """Put an expression, or a truth value, in the place of every literal, and simplify."""

    def joined(terms: list[Expression | bool], neutral: bool) -> Expression | bool:
        if any(term is (not neutral) for term in terms):
            return not neutral
        rest = [term for term in terms if isinstance(term, Expression)]
        if not rest:
            return neutral
        return conjunction(rest) if neutral else disjunction(rest)

    return expression.fold(leaf, lambda terms: joined(terms, True), lambda terms: joined(terms, False))


def assuming(expression: Expression, surface: Surface, inside: bool) -> Expression | bool:
    """Cofactor: the expression simplified when the sign of one surface is known."""
    return substituted(
        expression,
        lambda other, positive: positive is inside if other is surface else Literal(other, positive),
    )


def _joined(
    terms: Iterable[Expression], node: type[Conjunction] | type[Disjunction], neutral: bool
) -> Expression:
    flat: list[Expression] = []
    for term in terms:
        flat.extend(term.terms if isinstance(term, node) else (term,))
    flat = list(dict.fromkeys(flat))
    decided = {term.surface: term.positive for term in flat if isinstance(term, Literal)}
    if len(flat) > len(decided):
        flat = _propagated(flat, decided, neutral)
        flat = _absorbed(flat)
    return flat[0] if len(flat) == 1 else node(tuple(flat))


def _absorbed(terms: list[Expression]) -> list[Expression]:
    """Use that ``E | (E & F) = E`` and ``E & (E | F) = E``."""
    members = {term: frozenset(term.terms) for term in terms if isinstance(term, (Conjunction, Disjunction))}
    return [
        term
        for term in terms
        if term not in members or not any(other < members[term] for other in members.values())
    ]


def _propagated(terms: list[Expression], decided: dict[Surface, bool], neutral: bool) -> list[Expression]:
    """Use that ``s & E = s & E[s := true]`` and ``s | E = s | E[s := false]``."""
    kept: list[Expression] = []
    for term in terms:
        simpler: Expression | bool = term
        if not isinstance(term, Literal):
            for surface in term.surfaces():
                if surface in decided and isinstance(simpler, Expression):
                    simpler = assuming(simpler, surface, decided[surface] is neutral)
        if isinstance(simpler, Expression):
            kept.append(simpler)
        elif simpler is not neutral:
            return terms  # a contradiction (an empty set) stays as it was written
    return list(dict.fromkeys(kept))
