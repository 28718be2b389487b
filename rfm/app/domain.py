"""The domain as an expression of named shapes: ``& | - ~`` and parentheses, nothing else.

Precedence is that of Python: ``~`` binds strongest, then ``-``, then ``&``, then ``|``.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rfm.app.expressions.syntax import Syntax, parse_boolean

MAX_DEPTH = 60

_OPERATIONS: dict[type, Callable[[Any, Any], Any]] = {
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.Sub: operator.sub,
}


@dataclass(frozen=True)
class DomainExpression:
    """A parsed expression of shapes.

    Attributes
    ----------
    text
        As the user wrote it.
    tree
        Syntax tree of names and whitelisted operations only.
    names
        Offset of the first mention of every shape, in order of mention.
    """

    text: str
    tree: ast.expr
    names: Mapping[str, int]

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
        return cls(text, syntax.tree, dict(sorted(names.items(), key=lambda item: item[1])))

    def evaluate(self, shapes: Mapping[str, Any]) -> Any:
        """Combine the named values, which have the operators ``& | - ~``."""
        return _evaluate(self.tree, shapes)


def _check(syntax: Syntax, tree: ast.expr, names: dict[str, int], depth: int) -> None:
    while isinstance(tree, ast.BinOp):  # long chains lean to the left and must not nest deeply here
        if type(tree.op) not in _OPERATIONS:
            raise syntax.error("only & | - ~ join shapes", tree.right)
        _check(syntax, tree.right, names, depth + 1)
        tree = tree.left
    if depth > MAX_DEPTH:
        raise syntax.error(f"nested deeper than {MAX_DEPTH} levels", tree)
    if isinstance(tree, ast.Name):
        offset = syntax.offset(tree)
        names[tree.id] = min(offset, names.get(tree.id, offset))
    elif isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.Invert):
        _check(syntax, tree.operand, names, depth + 1)
    elif isinstance(tree, ast.UnaryOp):
        raise syntax.error("'-' needs a shape on its left; the complement is written ~", tree)
    else:
        raise syntax.error("only names of shapes and & | - ~ ( ) can occur in the domain", tree)


def _evaluate(tree: ast.expr, shapes: Mapping[str, Any]) -> Any:
    chain: list[ast.BinOp] = []
    while isinstance(tree, ast.BinOp):
        chain.append(tree)
        tree = tree.left
    if isinstance(tree, ast.UnaryOp):
        value = ~_evaluate(tree.operand, shapes)
    elif isinstance(tree, ast.Name):
        value = shapes[tree.id]
    else:
        raise TypeError(f"unchecked syntax {type(tree).__name__}")
    for step in reversed(chain):
        value = _OPERATIONS[type(step.op)](value, _evaluate(step.right, shapes))
    return value
