"""Leaving out the terms that an expression does not need."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TypeAlias

from rfm.geometry.expression import Expression, Literal, Node

Path: TypeAlias = tuple[int, ...]


def reduced(expression: Expression, correct: Callable[[Expression], bool]) -> Expression:
    """Drop term after term as long as the expression stays correct.

    Compound terms are tried first, then literals of auxiliary surfaces (separators), then all others.
    """
    before = None
    while expression != before:
        before = expression
        for kind in (_compound, _separator, _literal):
            # from the last to the first: dropping a term leaves the places of those before it
            for path in reversed(list(_places(expression, kind))):
                attempt = _without(expression, path)
                if attempt is not None and correct(attempt):
                    expression = attempt
        tidy = expression.plain()
        expression = tidy if correct(tidy) else expression
    return expression


def _compound(node: Expression) -> bool:
    return not isinstance(node, Literal)


def _separator(node: Expression) -> bool:
    return isinstance(node, Literal) and node.surface.auxiliary


def _literal(node: Expression) -> bool:
    return isinstance(node, Literal)


def _places(node: Expression, kind: Callable[[Expression], bool], path: Path = ()) -> Iterator[Path]:
    if path and kind(node):
        yield path
    if isinstance(node, Node):
        for index, term in enumerate(node.terms):
            yield from _places(term, kind, (*path, index))


def _without(node: Expression, path: Path) -> Expression | None:
    """Expression without the term at a place; None when its last term would go."""
    if not isinstance(node, Node):
        return None
    terms = list(node.terms)
    if len(path) == 1:
        del terms[path[0]]
    else:
        changed = _without(terms[path[0]], path[1:])
        if changed is None:
            return None
        terms[path[0]] = changed
    return type(node)(tuple(terms)) if terms else None
