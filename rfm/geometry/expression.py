"""Boolean expressions over surfaces, in negation normal form.

A literal is a surface or its complement; ``Conjunction`` is an intersection, ``Disjunction`` a union.
Conjunction by minimum and disjunction by maximum give the exact zero set (the R1 system: Shapiro,
Acta Numerica 2007, section 2); the same two operations on the signs -1, 0, +1 give the tri-state
logic that cell classification needs.  A node may carry a system of R-functions of its own, which is
used wherever the expression becomes a smooth function (``composed``); it never touches the signs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any, TypeVar

import numpy as np

from rfm.calculus.r_systems import RSystem
from rfm.geometry.surface import Surface

T = TypeVar("T")
Reduction = Callable[[list[T]], T]
Leaf = Callable[[Surface, bool], T]


@dataclass(frozen=True)
class Expression:
    """Base of the three kinds of node."""

    def walk(self, leaf: Leaf[T], join: Callable[[Node, list[T]], T]) -> T:
        """Evaluate bottom-up; ``join`` gets each node with what was found for its terms."""
        raise TypeError("an expression is a Literal, a Conjunction or a Disjunction")

    def fold(self, leaf: Leaf[T], both: Reduction[T], either: Reduction[T]) -> T:
        """Evaluate bottom-up with any interpretation of literals, intersections and unions."""
        return self.walk(leaf, lambda node, terms: (both if isinstance(node, Conjunction) else either)(terms))

    def composed(self, values: Mapping[Surface, Any], default: RSystem, coords: Sequence[Any]) -> Any:
        """R-function of the surfaces' values at coordinates; nodes without a system take ``default``."""
        usual = default.at(*coords)

        def join(node: Node, terms: list[Any]) -> Any:
            system = usual if node.system is None else node.system.at(*coords)
            operation = system.conjunction if isinstance(node, Conjunction) else system.disjunction
            return operation(*terms)

        return self.walk(lambda surface, positive: values[surface] if positive else -values[surface], join)

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

    def systems(self) -> tuple[RSystem, ...]:
        """Return the systems that nodes have of their own."""
        return self.walk(
            lambda surface, positive: (),
            lambda node, terms: sum(terms, () if node.system is None else (node.system,)),
        )

    def mapped(self, change: Callable[[Surface], Surface]) -> Expression:
        """Replace every surface; equal surfaces stay equal."""
        table = {surface: change(surface) for surface in self.surfaces()}
        return self.walk(
            lambda surface, positive: Literal(table[surface], positive),
            lambda node, terms: replace(node, terms=tuple(terms)),
        )

    def negated(self) -> Expression:
        """Complement, again in negation normal form (De Morgan's laws hold in every system)."""
        return self.walk(
            lambda surface, positive: Literal(surface, not positive),
            lambda node, terms: node.dual(tuple(terms), node.system),
        )

    def plain(self) -> Expression:
        """Return the same set without systems at the nodes."""
        return self.fold(Literal, conjunction, disjunction)


@dataclass(frozen=True)
class Literal(Expression):
    """A surface's inner side, or (``positive=False``) its outer side."""

    surface: Surface
    positive: bool = True

    def walk(self, leaf: Leaf[T], join: Callable[[Node, list[T]], T]) -> T:
        """See :meth:`Expression.walk`."""
        return leaf(self.surface, self.positive)


@dataclass(frozen=True)
class Node(Expression):
    """An operation on several terms (at least one), with its own system of R-functions or none."""

    terms: tuple[Expression, ...]
    system: RSystem | None = None

    def walk(self, leaf: Leaf[T], join: Callable[[Node, list[T]], T]) -> T:
        """See :meth:`Expression.walk`."""
        return join(self, [term.walk(leaf, join) for term in self.terms])

    @property
    def dual(self) -> type[Node]:
        """The other operation."""
        return Disjunction if isinstance(self, Conjunction) else Conjunction


@dataclass(frozen=True)
class Conjunction(Node):
    """Intersection of the terms."""


@dataclass(frozen=True)
class Disjunction(Node):
    """Union of the terms."""


def conjunction(terms: Iterable[Expression], system: RSystem | None = None) -> Expression:
    """Intersection, without repeated terms and without terms the literals already decide.

    Terms that are intersections by the same system are flattened.
    """
    return _joined(terms, Conjunction, True, system)


def disjunction(terms: Iterable[Expression], system: RSystem | None = None) -> Expression:
    """Union, simplified like :func:`conjunction`."""
    return _joined(terms, Disjunction, False, system)


def substituted(
    expression: Expression, leaf: Callable[[Surface, bool], Expression | bool]
) -> Expression | bool:
    """Put an expression, or a truth value, in the place of every literal, and simplify."""

    def joined(node: Node, terms: list[Expression | bool]) -> Expression | bool:
        neutral = isinstance(node, Conjunction)
        if any(term is (not neutral) for term in terms):
            return not neutral
        rest = [term for term in terms if isinstance(term, Expression)]
        if not rest:
            return neutral
        return (conjunction if neutral else disjunction)(rest, node.system)

    return expression.walk(leaf, joined)


def assuming(expression: Expression, surface: Surface, inside: bool) -> Expression | bool:
    """Cofactor: the expression simplified when the sign of one surface is known."""
    return substituted(
        expression,
        lambda other, positive: positive is inside if other is surface else Literal(other, positive),
    )


def _joined(
    terms: Iterable[Expression], node: type[Node], neutral: bool, system: RSystem | None
) -> Expression:
    flat: list[Expression] = []
    for term in terms:
        flat.extend(term.terms if isinstance(term, node) and term.system == system else (term,))
    flat = list(dict.fromkeys(flat))
    decided = {term.surface: term.positive for term in flat if isinstance(term, Literal)}
    if len(flat) > len(decided):
        flat = _propagated(flat, decided, neutral)
        flat = _absorbed(flat, Disjunction if neutral else Conjunction)
        if any(isinstance(term, node) and term.system == system for term in flat):
            return _joined(flat, node, neutral, system)  # what was left of a term is such an operation itself
    return flat[0] if len(flat) == 1 else node(tuple(flat), system)


def _absorbed(terms: list[Expression], dual: type[Node]) -> list[Expression]:
    """Use that ``E | (E & F) = E`` and ``E & (E | F) = E``; ``dual`` is the kind of the inner operation."""
    members = {term: frozenset(term.terms) for term in terms if isinstance(term, dual)}
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
