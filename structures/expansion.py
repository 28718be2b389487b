"""Taylor expansion of several fields at points, sharing everything that can be shared.

Every leaf of the expression graphs is evaluated once, at the highest order anybody needs;
derivatives shift its Taylor coefficients instead of evaluating again, arithmetic happens on jets.

Notation: c_alpha = d^alpha f / alpha! the normalised Taylor coefficient of :class:`rfm.calculus.jets.Jet`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import factorial, prod

from rfm.calculus.jets import Jet, multi_indices, variables
from rfm.calculus.types import Array, Value
from structures.field_expression import Derivative, FieldExpr, Leaf, MultiIndex, children_first


def expand(requests: Sequence[tuple[FieldExpr, int]], coords: Sequence[Array]) -> list[Value]:
    """Evaluate fields and their derivatives together.

    Parameters
    ----------
    requests
        Pairs (field, order).
    coords
        ``d`` coordinate arrays that broadcast against each other.

    Returns
    -------
    list
        For each request a :class:`Jet` of exactly that order, or the plain value at order 0, or a
        number where the field is constant.
    """
    dimension = len(coords)
    nodes = children_first([f for f, _ in requests], lambda node: node.children)
    orders = _orders(requests, nodes)
    coordinates: dict[int, Sequence[Value]] = {0: coords}
    coordinates |= {order: variables(coords, order) for order in set(orders.values()) - {0}}
    values: dict[int, Value] = {}
    for node in nodes:
        key = _key(node)
        if key in values:
            continue
        order = orders[key]
        if isinstance(node, Derivative):
            values[key] = _shift(values[_key(node.of)], node.alpha, dimension, order)
        else:
            parts = [_truncate(values[_key(child)], dimension, order) for child in node.operands]
            values[key] = node.at(coordinates[order], parts)
    return [_truncate(values[_key(f)], dimension, order) for f, order in requests]


def coefficients(value: Value, count: int) -> tuple[Value, ...]:
    """Return the ``count`` Taylor coefficients of what :func:`expand` returned for one request."""
    if isinstance(value, Jet):
        return tuple(value.coefficients)
    return (value,) + (0.0,) * (count - 1)


def is_zero(value: Value) -> bool:
    """Tell a structural zero (a Python number) from an array that happens to vanish."""
    return isinstance(value, (int, float)) and value == 0.0


def scaled(factor: float, value: Value) -> Value:
    """Return ``factor * value``, without a copy when the factor is one."""
    return value if factor == 1 or is_zero(value) else factor * value


def _key(node: FieldExpr) -> int:
    """Identity of a node; leaves that wrap the same callable are one."""
    return id(node.function) if isinstance(node, Leaf) else id(node)


def _orders(requests: Sequence[tuple[FieldExpr, int]], nodes: Sequence[FieldExpr]) -> dict[int, int]:
    orders = dict.fromkeys(map(_key, nodes), 0)
    for f, order in requests:
        orders[_key(f)] = max(orders[_key(f)], order)
    for node in reversed(nodes):
        extra = sum(node.alpha) if isinstance(node, Derivative) else 0
        for child in node.children:
            orders[_key(child)] = max(orders[_key(child)], orders[_key(node)] + extra)
    return orders


def _truncate(value: Value, dimension: int, order: int) -> Value:
    if not isinstance(value, Jet) or value.order == order:
        return value
    if order == 0:
        return value.value
    return Jet(dimension, order, tuple(value.coefficients[: len(multi_indices(dimension, order))]))


@lru_cache(maxsize=256)
def _shift_table(dimension: int, order: int, alpha: MultiIndex) -> tuple[tuple[int, int], ...]:
    """Return places and factors of c_beta(d^alpha f) = (beta + alpha)! / beta! c_{beta + alpha}(f)."""
    place = {index: k for k, index in enumerate(multi_indices(dimension, order + sum(alpha)))}
    table = []
    for beta in multi_indices(dimension, order):
        total = tuple(a + b for a, b in zip(alpha, beta, strict=True))
        table.append((place[total], prod(map(factorial, total)) // prod(map(factorial, beta))))
    return tuple(table)


def _shift(value: Value, alpha: MultiIndex, dimension: int, order: int) -> Value:
    if not isinstance(value, Jet):
        return 0.0
    table = _shift_table(dimension, order, alpha)
    shifted = tuple(scaled(factor, value.coefficients[place]) for place, factor in table)
    return shifted[0] if order == 0 else Jet(dimension, order, shifted)
