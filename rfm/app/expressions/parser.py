"""From Python's syntax tree to an expression tree, by a whitelist.

Every kind of syntax that is not listed here is an error, so no attribute, subscript, lambda, string,
comprehension or call of anything but the functions of the vocabulary can occur.  Parts that do not
depend on the point are computed at once.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from rfm.app.expressions.nodes import (
    ARITHMETIC,
    COMPARISONS,
    Apply,
    Chain,
    Comparison,
    Constant,
    Logical,
    Node,
    Variable,
    is_condition,
)
from rfm.app.expressions.syntax import ExpressionError, Syntax, parse_arithmetic
from rfm.app.expressions.vocabulary import CONSTANTS, FUNCTIONS, VARIABLES
from rfm.calculus.types import Value

MAX_DEPTH = 60
MAX_EXPONENT = 1000

_OPERATORS: dict[type, str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "^"}
_COMPARATORS: dict[type, str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}
_REFUSED: dict[type, str] = {
    ast.FloorDiv: "'//' is not an operation of expressions",
    ast.BitXor: "write powers as x^2 or x**2",
    ast.IfExp: "'if' is not allowed; write where(condition, a, b)",
    ast.Attribute: "a dot between names has no meaning in an expression",
    ast.Tuple: "a list of values is not allowed here, a single number is expected",
    ast.Lambda: "functions cannot be defined in an expression",
    ast.Starred: "'*' must stand between two values",
}


@dataclass(frozen=True)
class Names:
    """What an expression may mention.

    Attributes
    ----------
    parameters
        Values of the parameters.
    variables
        Variables that have a value where the expression is used.
    absent
        Remark for variables that are known but have no value there, e.g. ``z`` in the plane.
    """

    parameters: Mapping[str, float]
    variables: tuple[str, ...] = VARIABLES
    absent: Mapping[str, str] | None = None


def parse(text: str, names: Names) -> Node:
    """Tree of an expression.

    Raises
    ------
    ExpressionError
        With the offset of the mistake and its remedy.
    """
    syntax = parse_arithmetic(text)
    return _Parser(syntax, names).node(syntax.tree, 0)


class _Parser:
    def __init__(self, syntax: Syntax, names: Names) -> None:
        self.syntax, self.names = syntax, names

    def node(self, tree: ast.expr, depth: int) -> Node:
        """Node of a syntax tree of one of the whitelisted kinds."""
        if depth > MAX_DEPTH:
            message = f"nested deeper than {MAX_DEPTH} levels; split the expression with parameters"
            raise self.syntax.error(message, tree)
        rule = _RULES.get(type(tree))
        if rule is None:
            message = _REFUSED.get(type(tree), f"{type(tree).__name__} is not allowed in an expression")
            raise self.syntax.error(message, tree)
        return rule(self, tree, depth + 1)

    def number(self, tree: ast.expr, depth: int) -> Node:
        """Node that is a number, not a condition."""
        node = self.node(tree, depth)
        if is_condition(node):
            message = "a condition is no number; write where(condition, 1, 0)"
            raise self.syntax.error(message, tree)
        return node

    def condition(self, tree: ast.expr, depth: int) -> Node:
        """Node that is a condition, not a number."""
        node = self.node(tree, depth)
        if not is_condition(node):
            raise self.syntax.error("a condition such as x > 0.5 is expected here", tree)
        return node

    def constant(self, tree: ast.Constant, depth: int) -> Node:
        """Read a literal number."""
        value = tree.value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.syntax.error(f"{value!r} is no real number", tree)
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        return self._finite(number, tree)

    def name(self, tree: ast.Name, depth: int) -> Node:
        """Find a parameter, a constant or a variable."""
        name, names = tree.id, self.names
        if name in names.parameters:
            return Constant(float(names.parameters[name]))
        if name in CONSTANTS:
            return Constant(CONSTANTS[name])
        if name in names.variables:
            return Variable(name)
        if names.absent and name in names.absent:
            raise self.syntax.error(names.absent[name], tree)
        if name in FUNCTIONS:
            raise self.syntax.error(f"the function {name} needs arguments in parentheses", tree)
        raise self.syntax.error(f"unknown name {name!r}; {self._known(name)}", tree)

    def _known(self, name: str) -> str:
        from rfm.app.source import nearest

        values = [*self.names.variables, *self.names.parameters, *CONSTANTS]
        return nearest(name, [*values, *FUNCTIONS], "known names")

    def binary(self, tree: ast.BinOp, depth: int) -> Node:
        """Chain of binary operations down the left side, folded while it is constant."""
        spine: list[ast.BinOp] = []
        first: ast.expr = tree
        while isinstance(first, ast.BinOp):
            spine.append(first)
            first = first.left
        node, rest = self.number(first, depth), list[tuple[str, Node]]()
        for step in reversed(spine):
            symbol = _OPERATORS.get(type(step.op))
            if symbol is None:
                message = _REFUSED.get(type(step.op), f"{type(step.op).__name__} is not an operation here")
                raise ExpressionError(message, self.syntax.text, self._after(step.left))
            right = self.number(step.right, depth)
            if symbol == "^":
                self._check_exponent(right, step.right)
            if isinstance(node, Constant) and isinstance(right, Constant) and not rest:
                node = self._fold(step, partial(ARITHMETIC[symbol], node.value, right.value))
            else:
                rest.append((symbol, right))
        return Chain(node, tuple(rest)) if rest else node

    def _after(self, tree: ast.expr) -> int:
        offset = self.syntax.offsets[min(tree.end_col_offset or 0, len(self.syntax.offsets) - 1)]
        text = self.syntax.text
        while offset < len(text) and (text[offset].isspace() or text[offset] == ")"):
            offset += 1
        return offset

    def _check_exponent(self, exponent: Node, tree: ast.expr) -> None:
        if isinstance(exponent, Constant) and abs(exponent.value) > MAX_EXPONENT:
            message = f"the exponent {exponent.value:g} is too large (limit {MAX_EXPONENT})"
            raise self.syntax.error(message, tree)

    def _fold(self, tree: ast.expr, compute: Callable[[], Value]) -> Constant:
        """Compute a constant part now, so that a mistake in it is reported with its place."""
        try:
            with np.errstate(all="ignore"):
                value = compute()
        except ZeroDivisionError:
            offset = self._after(tree.left) if isinstance(tree, ast.BinOp) else self.syntax.offset(tree)
            raise ExpressionError("division by zero", self.syntax.text, offset) from None
        except (ValueError, OverflowError):
            value = math.nan
        if isinstance(value, complex):
            value = math.nan
        return self._finite(float(value), tree)

    def _finite(self, value: float, tree: ast.expr) -> Constant:
        if not math.isfinite(value):
            raise self.syntax.error("has no finite real value", tree)
        return Constant(value)

    def unary(self, tree: ast.UnaryOp, depth: int) -> Node:
        """Sign or negation."""
        if isinstance(tree.op, ast.Not):
            inner = self.condition(tree.operand, depth)
            return Constant(not inner.value) if isinstance(inner, Constant) else Logical("not", (inner,))
        if isinstance(tree.op, ast.Invert):
            raise self.syntax.error("'~' is not an operation of expressions; write not", tree)
        inner = self.number(tree.operand, depth)
        if isinstance(tree.op, ast.UAdd):
            return inner
        return Constant(-inner.value) if isinstance(inner, Constant) else Apply(_negative, (inner,))

    def comparison(self, tree: ast.Compare, depth: int) -> Node:
        """Comparison; ``a < b < c`` means ``a < b and b < c``."""
        operands = [self.number(operand, depth) for operand in (tree.left, *tree.comparators)]
        parts: list[Node] = []
        for i, op in enumerate(tree.ops):
            symbol = _COMPARATORS.get(type(op))
            if symbol is None:
                raise self.syntax.error(f"'{type(op).__name__}' is not a comparison of numbers", tree)
            left, right = operands[i], operands[i + 1]
            if isinstance(left, Constant) and isinstance(right, Constant):
                parts.append(Constant(bool(COMPARISONS[symbol](left.value, right.value))))
            else:
                parts.append(Comparison(symbol, left, right))
        return _join("and", parts)

    def logical(self, tree: ast.BoolOp, depth: int) -> Node:
        """Join conditions by ``and`` or ``or``."""
        symbol = "and" if isinstance(tree.op, ast.And) else "or"
        return _join(symbol, [self.condition(value, depth) for value in tree.values])

    def call(self, tree: ast.Call, depth: int) -> Node:
        """Call of a function of the vocabulary."""
        if not isinstance(tree.func, ast.Name):
            raise self.syntax.error("only a function can be called; a product is written with *", tree.func)
        name = tree.func.id
        function = FUNCTIONS.get(name)
        if function is None:
            raise self.syntax.error(self._no_function(name), tree.func)
        if tree.keywords:
            raise self.syntax.error(f"{name} takes no named arguments", tree.func)
        count = len(tree.args)
        if count < function.minimum or (function.maximum is not None and count > function.maximum):
            raise self.syntax.error(f"{name} takes {function.arity}, got {count}", tree.func)
        if name == "where":
            return self._where(tree, depth)
        arguments = tuple(self.number(argument, depth) for argument in tree.args)
        if all(isinstance(argument, Constant) for argument in arguments):
            return self._fold(tree, partial(function, *(argument.evaluate({}) for argument in arguments)))
        return Apply(function, arguments)

    def _where(self, tree: ast.Call, depth: int) -> Node:
        condition = self.condition(tree.args[0], depth)
        a, b = self.number(tree.args[1], depth), self.number(tree.args[2], depth)
        if isinstance(condition, Constant):
            return a if condition.value else b
        return Apply(FUNCTIONS["where"], (condition, a, b))

    def _no_function(self, name: str) -> str:
        from rfm.app.source import nearest

        known = {*self.names.parameters, *self.names.variables, *CONSTANTS}
        if name in known:
            return f"{name} is no function; a product is written with *, as in {name}*(...)"
        return f"unknown function {name!r}; {nearest(name, FUNCTIONS, 'functions')}"


def _negative(value: Value) -> Value:
    return -value


def _join(symbol: str, parts: list[Node]) -> Node:
    """``and`` / ``or`` of conditions; constant ones decide or drop out."""
    absorbing = symbol == "or"
    undecided: list[Node] = []
    for part in parts:
        if not isinstance(part, Constant):
            undecided.append(part)
        elif part.value == absorbing:
            return Constant(absorbing)
    if not undecided:
        return Constant(not absorbing)
    return undecided[0] if len(undecided) == 1 else Logical(symbol, tuple(undecided))


_RULES: dict[type, Callable[[_Parser, Any, int], Node]] = {
    ast.Constant: _Parser.constant,
    ast.Name: _Parser.name,
    ast.BinOp: _Parser.binary,
    ast.UnaryOp: _Parser.unary,
    ast.Compare: _Parser.comparison,
    ast.BoolOp: _Parser.logical,
    ast.Call: _Parser.call,
}
