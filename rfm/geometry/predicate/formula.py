"""Predicates over named sets: what a domain says, before any function stands for a name.

Notation: a, b are names; ``a & b``, ``a | b``, ``~a`` are and, or, not; ``a ^ b`` exclusive or, ``a - b`` is
``a & ~b``, ``a @ b`` the Cartesian product.  Substituting sets, or R-functions, for the names and their operations
for the connectives turns the predicate into a set, or a function (Shapiro, Acta Numerica 2007, Theorem 3).
"""

from __future__ import annotations

import operator
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any, ClassVar

from rfm.calculus.r_systems import RSystem

System = str | RSystem | None


class Predicate(ABC):
    """A predicate; the operators build larger ones."""

    binding: ClassVar[int] = 9
    """How strongly the outermost connective binds, for parentheses in the text."""

    @abstractmethod
    def evaluate(self, values: Mapping[str, Any]) -> Any:
        """Combine values (sets, shapes, ...) that have the operators ``& | ^ ~ @``.

        Where an operation has a system of its own the values' methods ``intersect``, ``unite``, ``exclusive``,
        ``implies``, ``iff`` or ``product`` are called with it instead.
        """

    @property
    @abstractmethod
    def children(self) -> tuple[Predicate, ...]:
        """The predicates this one is made of."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order of first mention."""
        return tuple(dict.fromkeys(name for child in self.children for name in child.names))

    def __and__(self, other: Predicate) -> Predicate:
        """Conjunction."""
        return _chain(And, self, other)

    def __or__(self, other: Predicate) -> Predicate:
        """Disjunction."""
        return _chain(Or, self, other)

    def __xor__(self, other: Predicate) -> Predicate:
        """Exclusive or."""
        return _chain(Xor, self, other)

    def __sub__(self, other: Predicate) -> Predicate:
        """Conjunction with the negation."""
        return _chain(And, self, Not(other))

    def __invert__(self) -> Predicate:
        """Negation."""
        return Not(self)

    def __matmul__(self, other: Predicate) -> Predicate:
        """Cartesian product."""
        return _chain(Product, self, other)

    def implies(self, other: Predicate) -> Predicate:
        """Implication."""
        return Implies((self, other))

    def iff(self, other: Predicate) -> Predicate:
        """Equivalence."""
        return Iff((self, other))

    def bracketed(self, binding: int) -> str:
        """Text, in parentheses where a connective of this strength would tear it apart."""
        return str(self) if self.binding > binding else f"({self})"


@dataclass(frozen=True)
class Name(Predicate):
    """A named set."""

    name: str

    @property
    def children(self) -> tuple[Predicate, ...]:
        """None."""
        return ()

    @property
    def names(self) -> tuple[str, ...]:
        """The name."""
        return (self.name,)

    def evaluate(self, values: Mapping[str, Any]) -> Any:
        """See :meth:`Predicate.evaluate`."""
        return values[self.name]

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Not(Predicate):
    """The complement."""

    of: Predicate
    binding: ClassVar[int] = 8

    @property
    def children(self) -> tuple[Predicate, ...]:
        """The predicate that is negated."""
        return (self.of,)

    def evaluate(self, values: Mapping[str, Any]) -> Any:
        """See :meth:`Predicate.evaluate`."""
        return ~self.of.evaluate(values)

    def __str__(self) -> str:
        return "~" + self.of.bracketed(self.binding - 1)


@dataclass(frozen=True)
class Connective(Predicate):
    """A connective of two or more predicates, from the left, with a system of R-functions or none.

    The text does not show the system.
    """

    of: tuple[Predicate, ...]
    system: System = None

    method: ClassVar[str]
    plain: ClassVar[Callable[[Any, Any], Any]]
    symbol: ClassVar[str]

    @property
    def children(self) -> tuple[Predicate, ...]:
        """The predicates that are joined."""
        return self.of

    def evaluate(self, values: Mapping[str, Any]) -> Any:
        """See :meth:`Predicate.evaluate`."""
        given = [term.evaluate(values) for term in self.of]
        if self.system is None:
            return reduce(type(self).plain, given)
        return reduce(lambda first, second: getattr(first, self.method)(second, self.system), given)

    def __str__(self) -> str:
        return f" {self.symbol} ".join(term.bracketed(self.binding) for term in self.of)


@dataclass(frozen=True)
class And(Connective):
    """All of them."""

    method, plain, symbol, binding = "intersect", operator.and_, "&", 5


@dataclass(frozen=True)
class Or(Connective):
    """At least one of them."""

    method, plain, symbol, binding = "unite", operator.or_, "|", 3


@dataclass(frozen=True)
class Xor(Connective):
    """An odd number of them."""

    method, plain, symbol, binding = "exclusive", operator.xor, "^", 4


@dataclass(frozen=True)
class Product(Connective):
    """Cartesian product: each factor speaks of coordinates of its own."""

    method, plain, symbol, binding = "product", operator.matmul, "@", 7


@dataclass(frozen=True)
class Function(Connective):
    """A connective of exactly two predicates that is written like a function."""

    def __str__(self) -> str:
        return f"{self.symbol}({', '.join(map(str, self.of))})"


@dataclass(frozen=True)
class Implies(Function):
    """The second, if the first."""

    method, symbol = "implies", "implies"

    @staticmethod
    def plain(first: Any, second: Any) -> Any:  # type: ignore[override]
        """``~first | second``."""
        return ~first | second


@dataclass(frozen=True)
class Iff(Function):
    """Both or neither."""

    method, symbol = "iff", "iff"

    @staticmethod
    def plain(first: Any, second: Any) -> Any:  # type: ignore[override]
        """``~(first ^ second)``."""
        return ~(first ^ second)


def _chain(kind: type[Connective], first: Predicate, second: Predicate) -> Predicate:
    """Join two predicates; a chain of one connective is one node, however long."""
    before = first.children if isinstance(first, kind) and first.system is None else (first,)
    return kind((*before, second))
