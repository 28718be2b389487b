"""A grid of cells cut into boxes, one for each device.

The cuts run through the whole grid, so a box is known by one interval of layers in each direction: slabs when only one
direction is cut.  A box holds the cells in it and the B-splines whose last cell they are not: index i belongs to the
box of cell i, and the last box of a direction also holds the p indices beyond the last cell.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.errors import DiscretizationError

Indices = NDArray[np.integer[Any]]
EXCHANGED = 8.0
"""Nodes that a device computes in the time in which it exchanges one unknown with a neighbour, roughly."""
TRIED = 12
"""Ways to cut that are compared."""


@dataclass(frozen=True)
class Blocks:
    """Boxes of cells between cuts.

    Attributes
    ----------
    borders
        For each direction the layers at which boxes begin, ascending, and the end of the last one.
    """

    borders: tuple[tuple[int, ...], ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of boxes in each direction."""
        return tuple(len(border) - 1 for border in self.borders)

    @property
    def count(self) -> int:
        """Number of boxes."""
        return prod(self.counts)

    @property
    def thickness(self) -> tuple[int, ...]:
        """Layers of the thickest box in each direction."""
        return tuple(int(np.diff(border).max()) for border in self.borders)

    def holders(self, index: Indices) -> NDArray[np.int32]:
        """Number of the box of each multi-index (d, n); what lies beyond the last border belongs to the last box."""
        parts = [
            np.clip(np.searchsorted(border, along, side="right") - 1, 0, len(border) - 2)
            for border, along in zip(self.borders, index, strict=True)
        ]
        return np.asarray(np.ravel_multi_index(tuple(parts), self.counts), dtype=np.int32)

    def box(self, number: int) -> tuple[tuple[int, int], ...]:
        """First layer of a box and the layer after its last, in each direction."""
        where = np.unravel_index(number, self.counts)
        return tuple((border[k], border[k + 1]) for border, k in zip(self.borders, where, strict=True))

    def shown(self) -> str:
        """Boxes in each direction, as 4x2."""
        return "x".join(map(str, self.counts))


def whole(cells: tuple[int, ...]) -> Blocks:
    """One box for a grid."""
    return Blocks(tuple((0, n) for n in cells))


def divided(state: NDArray[np.int8], degree: int, count: int) -> Blocks:
    """Cut a grid into boxes of about the same work.

    Cuts in several directions have the smaller surface, cuts in one the better balance; what is compared is the work of
    the box that has most of it, in nodes of quadrature, plus what it exchanges.

    Parameters
    ----------
    state
        1 inner, 0 cut, -1 outer cells.
    degree
        Degree p of the splines.
    count
        Number of boxes.

    Raises
    ------
    DiscretizationError
        There are fewer layers of cells than boxes, however the grid is cut.
    """
    dimension = state.ndim
    nodes = np.array([(2 * degree + 1) ** dimension, (degree + 1) ** dimension, 0], dtype=np.float32)
    work = nodes[state]
    layers = [work.sum(axis=tuple(a for a in range(dimension) if a != axis)) for axis in range(dimension)]
    spans = [np.flatnonzero(layer)[[0, -1]] + [0, 1] for layer in layers]
    sizes = [int(last - first) for first, last in spans]
    ways = [way for way in _factors(count, dimension) if all(map(int.__le__, way, sizes))]
    if not ways:
        raise DiscretizationError(
            f"shards: {count} needs as many layers of cells, but the domain covers only "
            f"{'x'.join(map(str, sizes))} cells: refine the grid, or choose shards: {_largest(sizes, count)} or fewer"
        )
    ways = sorted(ways, key=lambda way: _surface(way, sizes))[:TRIED]
    slabs = tuple(count if axis == int(np.argmax(sizes)) else 1 for axis in range(dimension))
    if all(map(int.__le__, slabs, sizes)) and slabs not in ways:
        ways.append(slabs)
    best: tuple[float, Blocks] | None = None
    for way in ways:
        found = Blocks(tuple(_cuts(*one) for one in zip(layers, spans, way, strict=True)))
        cost = _heaviest(work, found) + EXCHANGED * degree * _surface(way, sizes) / count
        if best is None or cost < best[0]:
            best = cost, found
    assert best is not None
    return best[1]


def _factors(count: int, dimension: int) -> Iterator[tuple[int, ...]]:
    """Ways to write a number as an ordered product."""
    if dimension == 1:
        yield (count,)
        return
    for first in range(1, count + 1):
        if count % first == 0:
            for rest in _factors(count // first, dimension - 1):
                yield (first, *rest)


def _largest(sizes: list[int], count: int) -> int:
    """Largest number of boxes below `count` that a grid of layers can be cut into."""
    dimension = len(sizes)
    return next(
        k
        for k in range(count - 1, 0, -1)
        if any(all(map(int.__le__, way, sizes)) for way in _factors(k, dimension))
    )


def _surface(way: tuple[int, ...], sizes: list[int]) -> float:
    """Faces of cells on both sides of all cuts."""
    return 2.0 * sum((k - 1) * prod(sizes) / n for k, n in zip(way, sizes, strict=True))


def _cuts(layer: NDArray[Any], span: NDArray[Any], count: int) -> tuple[int, ...]:
    """Borders of `count` intervals of about the same sum, each of one layer at least."""
    first, last = map(int, span)
    total = np.cumsum(layer[first:last], dtype=float)
    middles = total - 0.5 * layer[first:last]
    borders = [first]
    for k in range(1, count):
        ideal = first + int(np.searchsorted(middles, total[-1] * k / count))
        borders.append(min(max(ideal, borders[-1] + 1), last - (count - k)))
    return (*borders, last)


def _heaviest(work: NDArray[np.float32], blocks: Blocks) -> float:
    """Work of the box that has most."""
    inside = work[tuple(slice(border[0], border[-1]) for border in blocks.borders)]
    for axis, border in enumerate(blocks.borders):
        inside = np.add.reduceat(inside, np.array(border[:-1]) - border[0], axis=axis)
    return float(inside.max())
