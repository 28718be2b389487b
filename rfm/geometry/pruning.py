"""Which terms of a Boolean expression matter where: points in boxes, surfaces in intervals.

In ``min(t1, t2, ...)`` over a box a term with ``low(t_i) > min_j high(t_j)`` is nowhere the smallest, nor
equal to it; so the minimum without it is the same to the last bit, and so are its derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.intervals import Interval
from rfm.calculus.types import Array, Field
from rfm.geometry.expression import Conjunction, Disjunction, Expression, Literal, Node
from rfm.geometry.surface import Surface

POINTS_IN_A_BOX = 200
"""Aimed at; small boxes prune well, large ones have less overhead."""

_WIDER = 1e-9


@dataclass(frozen=True, eq=False)
class Bounded:
    """A node of an expression with its number and its bounds over every box."""

    number: int
    node: Expression
    low: Array
    high: Array
    terms: tuple[Bounded, ...] = ()


def prune(
    expression: Expression, function: Callable[[Surface], Field], points: Array
) -> list[tuple[Expression, NDArray[np.intp]]]:
    """Split points into sets on which a part of the min/max expression is equal to all of it.

    Parameters
    ----------
    expression
        Boolean expression, conjunction by minimum and disjunction by maximum.
    function
        Field of a surface; must be callable on intervals.
    points
        Points ``(n, d)``.

    Returns
    -------
    list
        Expressions, each with the indices of its points; every point is in one of the sets.
    """
    if not len(points):
        return []
    box_of_point, boxes = _boxes(points)
    bounds = {
        surface: _bounds(function(surface), boxes, len(boxes[0].lo)) for surface in expression.surfaces()
    }
    tree = _bounded(expression, bounds, count())
    kept = np.zeros((tree.number + 1, len(boxes[0].lo)), dtype=bool)
    _mark(tree, np.ones(len(boxes[0].lo), dtype=bool), kept)
    _, sample, group_of_box = np.unique(
        np.packbits(kept, axis=0), axis=1, return_index=True, return_inverse=True
    )
    group = group_of_box.reshape(-1)[box_of_point]
    order = np.argsort(group.astype(np.int32), kind="stable")
    sets = np.split(order, np.cumsum(np.bincount(group, minlength=len(sample)))[:-1])
    marks = kept[:, sample].T.tolist()
    return [(_rest(tree, mark), chosen) for mark, chosen in zip(marks, sets, strict=True) if len(chosen)]


def _boxes(points: Array) -> tuple[NDArray[np.intp], tuple[Interval, ...]]:
    """Box of every point, and the sides of the boxes that hold points."""
    dimension = points.shape[1]
    low, high = points.min(axis=0), points.max(axis=0)
    along = max(1, round((len(points) / POINTS_IN_A_BOX) ** (1.0 / dimension)))
    width = np.where(high > low, (high - low) / along, 1.0)
    index = np.zeros(len(points), dtype=np.int32)
    for axis in range(dimension):
        place = ((points[:, axis] - low[axis]) / width[axis]).astype(np.int32)
        index = index * along + np.minimum(place, along - 1)
    counts = np.bincount(index, minlength=along**dimension)
    held = np.flatnonzero(counts)
    places = np.unravel_index(held, (along,) * dimension)
    margin = _WIDER * np.maximum(width, np.abs(points).max())
    sides = tuple(
        Interval(
            low[axis] + place * width[axis] - margin[axis],
            low[axis] + (place + 1) * width[axis] + margin[axis],
        )
        for axis, place in enumerate(places)
    )
    return (np.cumsum(counts > 0) - 1)[index], sides


def _bounds(field: Field, boxes: tuple[Interval, ...], number: int) -> Interval:
    value = Interval.of(field(*boxes))
    return Interval(np.broadcast_to(value.lo, number), np.broadcast_to(value.hi, number))


def _bounded(node: Expression, bounds: dict[Surface, Interval], numbers: Iterator[int]) -> Bounded:
    """Tree of the bounds; a node's number is larger than those of its terms."""
    if isinstance(node, Literal):
        value = bounds[node.surface]
        low, high = (value.lo, value.hi) if node.positive else (-value.hi, -value.lo)
        return Bounded(next(numbers), node, low, high)
    if not isinstance(node, Node):
        raise TypeError("an expression is a Literal, a Conjunction or a Disjunction")
    terms = tuple(_bounded(term, bounds, numbers) for term in node.terms)
    choose = np.minimum if isinstance(node, Conjunction) else np.maximum
    low, high = (choose.reduce([getattr(term, end) for term in terms]) for end in ("low", "high"))
    return Bounded(next(numbers), node, low, high, terms)


def _mark(tree: Bounded, alive: NDArray[np.bool_], kept: NDArray[np.bool_]) -> None:
    """Fill in over which boxes every node counts, shape ``(nodes, boxes)``."""
    kept[tree.number] = alive
    if not alive.any():
        return
    for term in tree.terms:
        beaten = term.low > tree.high if isinstance(tree.node, Conjunction) else term.high < tree.low
        _mark(term, alive & ~beaten, kept)


def _rest(tree: Bounded, marks: list[bool]) -> Expression:
    """Expression of the marked terms."""
    left = tuple(_rest(term, marks) for term in tree.terms if marks[term.number])
    if len(left) <= 1:
        return left[0] if left else tree.node
    return Conjunction(left) if isinstance(tree.node, Conjunction) else Disjunction(left)
