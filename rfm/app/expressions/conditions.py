"""A condition as a function that is positive where the condition holds.

``a > b`` becomes ``a - b``; ``and``, ``or`` and ``not`` become the conjunction, disjunction and negation
of the R-function system R0, which are smooth away from the points where both operands vanish
(Shapiro, Acta Numerica 2007, section 3.2).
"""

from __future__ import annotations

from rfm.app.expressions.nodes import Apply, Chain, Comparison, Logical, Node
from rfm.calculus.types import Value


def positive_where(node: Node, holds: bool = True) -> Node:
    """Return a node that is positive where the condition `node` is true (false, with ``holds=False``).

    Raises
    ------
    ValueError
        The condition is an equality, which holds on no piece of positive size.
    """
    if isinstance(node, Comparison):
        return _difference(node, holds)
    if not isinstance(node, Logical):
        raise ValueError("a condition such as x > 0.2 is expected")
    if node.symbol == "not":
        return positive_where(node.arguments[0], not holds)
    terms = tuple(positive_where(argument, holds) for argument in node.arguments)
    return Apply(_conjunction if (node.symbol == "and") == holds else _disjunction, terms)


def _difference(node: Comparison, holds: bool) -> Node:
    if node.symbol in ("==", "!="):
        raise ValueError(f"'{node.symbol}' selects no piece of a boundary; use <, <=, > or >=")
    greater = node.symbol in (">", ">=")
    first, second = (node.left, node.right) if greater == holds else (node.right, node.left)
    return Chain(first, (("-", second),))


def _conjunction(*values: Value) -> Value:
    from rfm.calculus.r_systems import system

    return system("r0").conjunction(*values)


def _disjunction(*values: Value) -> Value:
    from rfm.calculus.r_systems import system

    return system("r0").disjunction(*values)
