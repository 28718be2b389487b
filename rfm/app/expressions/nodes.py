"""The tree of an expression: five kinds of node, each of which can evaluate itself.

A node evaluates on whatever values the variables have: numbers, arrays, jets, intervals or JAX arrays.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import TypeAlias

from rfm.app.expressions.vocabulary import Function
from rfm.calculus.types import Value

Environment: TypeAlias = Mapping[str, Value]


@dataclass(frozen=True)
class Constant:
    """A number, or the truth value of a condition that does not depend on the point."""

    value: float | bool

    def evaluate(self, environment: Environment) -> Value:
        """Return the value itself."""
        return self.value


@dataclass(frozen=True)
class Variable:
    """A coordinate, the time or another quantity known at evaluation."""

    name: str

    def evaluate(self, environment: Environment) -> Value:
        """Look the value up."""
        return environment[self.name]


@dataclass(frozen=True)
class Chain:
    """``first op second op third ...`` applied from the left: long sums do not nest deeply."""

    first: Node
    rest: tuple[tuple[str, Node], ...]

    def evaluate(self, environment: Environment) -> Value:
        """Apply the operations from the left."""
        value = self.first.evaluate(environment)
        for symbol, node in self.rest:
            value = ARITHMETIC[symbol](value, node.evaluate(environment))
        return value


@dataclass(frozen=True)
class Apply:
    """A function of the vocabulary, or the negative of a value, applied to arguments."""

    function: Function | Callable[..., Value]
    arguments: tuple[Node, ...]

    def evaluate(self, environment: Environment) -> Value:
        """Evaluate the arguments, then the function."""
        return self.function(*(argument.evaluate(environment) for argument in self.arguments))


@dataclass(frozen=True)
class Comparison:
    """``left symbol right``, a condition."""

    symbol: str
    left: Node
    right: Node

    def evaluate(self, environment: Environment) -> Value:
        """Compare the values (a truth value, an array of them, or undecided for intervals)."""
        return COMPARISONS[self.symbol](self.left.evaluate(environment), self.right.evaluate(environment))


@dataclass(frozen=True)
class Logical:
    """``and``, ``or``, ``not`` of conditions."""

    symbol: str
    arguments: tuple[Node, ...]

    def evaluate(self, environment: Environment) -> Value:
        """Combine the conditions elementwise."""
        values = [argument.evaluate(environment) for argument in self.arguments]
        return LOGIC[self.symbol](values)


Node: TypeAlias = Constant | Variable | Chain | Apply | Comparison | Logical


def is_condition(node: Node) -> bool:
    """Whether a node is true or false rather than a number."""
    if isinstance(node, Constant):
        return isinstance(node.value, bool)
    return isinstance(node, Comparison | Logical)


def variables(node: Node) -> frozenset[str]:
    """Names of the variables on which a node depends."""
    match node:
        case Variable(name):
            return frozenset({name})
        case Chain(first, rest):
            return frozenset().union(variables(first), *(variables(item) for _, item in rest))
        case Comparison(_, left, right):
            return variables(left) | variables(right)
        case Apply(_, arguments) | Logical(_, arguments):
            return frozenset().union(*(variables(argument) for argument in arguments))
        case _:
            return frozenset()


def polynomial_degree(node: Node) -> int | None:
    """Total degree of a polynomial in the coordinates; None when the node is none (or not visibly)."""
    match node:
        case Constant():
            return 0
        case Variable():
            return 1
        case Chain(first, rest):
            return _chain_degree(first, rest)
        case Apply(function, (argument,)) if not isinstance(function, Function):  # the sign
            return polynomial_degree(argument)
        case _:
            return None


def _chain_degree(first: Node, rest: tuple[tuple[str, Node], ...]) -> int | None:
    degree = polynomial_degree(first)
    for symbol, node in rest:
        other = polynomial_degree(node)
        if degree is None or other is None:
            return None
        if symbol in "+-":
            degree = max(degree, other)
        elif symbol == "*":
            degree += other
        elif symbol == "/" and other == 0:
            continue
        elif (
            symbol == "^"
            and isinstance(node, Constant)
            and float(node.value).is_integer()
            and node.value >= 0
        ):
            degree *= int(node.value)
        else:
            return None
    return degree


def _power(base: Value, exponent: Value) -> Value:
    """Power; a whole constant exponent stays exact for negative bases and tight for intervals."""
    if isinstance(exponent, float):
        return base ** (int(exponent) if exponent.is_integer() else exponent)
    from rfm.calculus import functions

    return functions.power(base, exponent)


def _negate(condition: Value) -> Value:
    return (not condition) if isinstance(condition, bool) else ~condition


ARITHMETIC: dict[str, Callable[[Value, Value], Value]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "^": _power,
}

COMPARISONS: dict[str, Callable[[Value, Value], Value]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": lambda a, b: (a <= b) & (a >= b),
    "!=": lambda a, b: _negate((a <= b) & (a >= b)),
}

LOGIC: dict[str, Callable[[list[Value]], Value]] = {
    "and": lambda values: reduce(operator.and_, values),
    "or": lambda values: reduce(operator.or_, values),
    "not": lambda values: _negate(values[0]),
}
