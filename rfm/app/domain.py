"""The domain as a predicate over named shapes: set operations, products and R-functions by name.

``& | - ^ ~`` and ``@`` (Cartesian product) with the precedence of Python: ``~`` binds strongest, then ``@``, then
``-``, then ``&``, then ``^``, then ``|``.  ``implies(a, b)`` and ``iff(a, b)``; and ``rp4(a & b)``, any system of
R-functions by its name, which makes the operations written inside use it.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from rfm.app.expressions.syntax import Syntax, parse_boolean, written
from rfm.calculus import r_systems
from rfm.errors import RfmError
from rfm.geometry.predicate.formula import (
    And,
    Connective,
    Iff,
    Implies,
    Name,
    Not,
    Or,
    Predicate,
    Product,
    Xor,
)

MAX_DEPTH = 60

OPERATORS = "& | - ^ ~ @"

_CONNECTIVES: dict[type, type[Connective]] = {
    ast.BitAnd: And,
    ast.Sub: And,
    ast.BitOr: Or,
    ast.BitXor: Xor,
    ast.MatMult: Product,
}
_FUNCTIONS: dict[str, type[Connective]] = {"implies": Implies, "iff": Iff}


@dataclass(frozen=True)
class DomainExpression:
    """A parsed expression of shapes.

    Attributes
    ----------
    text
        As the user wrote it.
    predicate
        What it says.
    names
        Offset of the first mention of every shape, in order of mention.
    product
        Whether it contains a Cartesian product, so that the shapes may differ in dimension.
    """

    text: str
    predicate: Predicate
    names: Mapping[str, int]
    product: bool = False

    @classmethod
    def parse(cls, text: str) -> DomainExpression:
        """Parse a text.

        Raises
        ------
        ExpressionError
            With the offset, when it is no expression of shapes.
        """
        syntax = parse_boolean(text)
        names: dict[str, int] = {}
        _check(syntax, syntax.tree, names, 0)
        product = any(isinstance(node, ast.MatMult) for node in ast.walk(syntax.tree))
        ordered = dict(sorted(names.items(), key=lambda item: item[1]))
        return cls(text, _predicate(syntax.tree, None), ordered, product)

    def evaluate(self, shapes: Mapping[str, Any]) -> Any:
        """Combine the named values, which have the operators ``& | ^ ~ @``, as the text says it."""
        return self.predicate.evaluate(shapes)

    def dimension(self, dimensions: Mapping[str, int]) -> int:
        """Dimension of the domain, given those of the shapes.

        Raises
        ------
        ValueError
            When an operation does not fit the dimensions.
        """
        total: int = self.evaluate({name: _Dimension(value) for name, value in dimensions.items()}).value
        return total


@dataclass(frozen=True)
class _Dimension:
    """Dimension of a shape, with the operators of shapes."""

    value: int

    def intersect(self, other: _Dimension, system: str | None = None) -> _Dimension:
        if self.value != other.value:
            raise ValueError(
                f"shapes of dimension {self.value} and {other.value} cannot be combined (only multiplied, by @)"
            )
        return self

    def product(self, other: _Dimension, system: str | None = None) -> _Dimension:
        if self.value + other.value > 3:
            message = f"a product of shapes of dimension {self.value} and {other.value}"
            raise ValueError(f"{message} has more than three dimensions")
        return _Dimension(self.value + other.value)

    def __invert__(self) -> _Dimension:
        return self

    unite = exclusive = implies = iff = intersect
    __and__ = __or__ = __xor__ = intersect
    __matmul__ = product


def _check(syntax: Syntax, tree: ast.expr, names: dict[str, int], depth: int) -> None:
    while isinstance(tree, ast.BinOp):  # long chains lean to the left and must not nest deeply here
        if type(tree.op) not in _CONNECTIVES:
            raise syntax.error(f"only {OPERATORS} join shapes", tree.right)
        _check(syntax, tree.right, names, depth + 1)
        tree = tree.left
    if depth > MAX_DEPTH:
        raise syntax.error(f"nested deeper than {MAX_DEPTH} levels", tree)
    if isinstance(tree, ast.Name):
        if written(tree.id) != tree.id:
            raise syntax.error(
                f"{written(tree.id)!r} is no name of a shape: . and : occur only in the names of systems, as in "
                "ralpha0.5(a & b)",
                tree,
            )
        offset = syntax.offset(tree)
        names[tree.id] = min(offset, names.get(tree.id, offset))
    elif isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.Invert):
        _check(syntax, tree.operand, names, depth + 1)
    elif isinstance(tree, ast.UnaryOp):
        raise syntax.error("'-' needs a shape on its left; the complement is written ~", tree)
    elif isinstance(tree, ast.Call) and isinstance(tree.func, ast.Name) and not tree.keywords:
        _check_call(syntax, tree, written(tree.func.id))
        for argument in tree.args:
            _check(syntax, argument, names, depth + 1)
    else:
        raise syntax.error(
            f"only names of shapes and {OPERATORS} ( ) implies iff can occur in the domain", tree
        )


def _check_call(syntax: Syntax, tree: ast.Call, name: str) -> None:
    if name in _FUNCTIONS:
        if len(tree.args) != 2:
            raise syntax.error(f"{name} takes two shapes, as in {name}(a, b)", tree)
        return
    try:
        r_systems.system(name)
    except RfmError as error:
        known = [*_FUNCTIONS, *r_systems.NAMES]
        near = get_close_matches(name, known, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"choose one of {', '.join(known)}"
        what = "is neither implies, iff nor a system of R-functions"
        message = f"{name!r} {what}; {hint}" if str(error).startswith("unknown") else str(error)
        raise syntax.error(message, tree) from None
    if len(tree.args) != 1:
        raise syntax.error(f"{name} takes one expression of shapes, as in {name}(a & b)", tree)


def _predicate(tree: ast.expr, system: str | None) -> Predicate:
    """Predicate of a checked tree; a chain of one operator becomes one connective."""
    chain: list[ast.BinOp] = []
    while isinstance(tree, ast.BinOp):
        chain.append(tree)
        tree = tree.left
    value = _operand(tree, system)
    for step in reversed(chain):
        kind, right = _CONNECTIVES[type(step.op)], _predicate(step.right, system)
        term = Not(right) if isinstance(step.op, ast.Sub) else right
        before = value.of if isinstance(value, kind) and value.system == system else (value,)
        value = kind((*before, term), system)
    return value


def _operand(tree: ast.expr, system: str | None) -> Predicate:
    if isinstance(tree, ast.UnaryOp):
        return Not(_predicate(tree.operand, system))
    if isinstance(tree, ast.Name):
        return Name(tree.id)
    if not isinstance(tree, ast.Call) or not isinstance(tree.func, ast.Name):
        raise TypeError(f"unchecked syntax {type(tree).__name__}")
    name = written(tree.func.id)
    if name in _FUNCTIONS:
        return _FUNCTIONS[name](tuple(_predicate(argument, system) for argument in tree.args), system)
    return _predicate(tree.args[0], name)
