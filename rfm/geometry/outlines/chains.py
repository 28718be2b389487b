"""From a simple closed chain of edges to a Boolean expression with one literal for every edge.

Notation: a chain is a run of consecutive edges whose first and last are prolonged to infinity; it cuts the
plane in two, and E(chain) is the side to its left.  Let v be a vertex at which the chain touches its own
convex hull (the prolonged edges included).  The edges at v, prolonged beyond v, leave the hull and never
meet the chain again; so the chain splits at v into two chains of the same kind, and

    E(chain) = E(up to v) & E(from v)   when the chain turns left at v,   | when it turns right.

A closed polygon is split at its leftmost and rightmost vertices first, ``E(lower) & E(upper)``.  This is
the construction of Peterson in the form of D. Dobkin, L. Guibas, J. Hershberger, J. Snoeyink, *An efficient
algorithm for finding the CSG representation of a simple polygon*, SIGGRAPH 1988.  The hulls must be those
of the prolonged chains: with the hulls of the bare chains (pockets, pockets of pockets) the expression is
right inside the polygon's hull, but may be positive far outside.

Which vertex is extreme, and which way it turns, is decided exactly, so nearly collinear vertices do no harm.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.expression import Expression, conjunction, disjunction
from rfm.geometry.outlines.orientation import turn

_NEAR = 1e-14


@dataclass(frozen=True)
class Chain:
    """A node of the tree of chains.

    Parameters
    ----------
    first, last
        The edges from the one that starts at vertex ``first`` to the one that starts at ``last``.
    left
        Whether the halves are intersected (the chain turns left where it is split) or united.
    halves
        The two chains it is split into; none for a single edge.
    """

    first: int
    last: int
    left: bool = True
    halves: tuple[Chain, ...] = ()

    def expression(self, edges: Sequence[Expression]) -> Expression:
        """Expression with ``edges[i]`` (i modulo their number) for the edge that starts at vertex i."""
        if not self.halves:
            return edges[self.first % len(edges)]
        terms = [half.expression(edges) for half in self.halves]
        return conjunction(terms) if self.left else disjunction(terms)


def tree_of_chains(path: Array) -> Chain:
    """Tree of a counter-clockwise simple polygon ``(n, 2)``."""
    order = np.lexsort((path[:, 1], path[:, 0]))
    start, opposite = int(order[0]), int(order[-1])
    middle = opposite if opposite > start else opposite + len(path)
    halves = (_tree(path, start, middle - 1), _tree(path, middle, start + len(path) - 1))
    return Chain(start, start + len(path) - 1, True, halves)


def _tree(path: Array, first: int, last: int) -> Chain:
    if first == last:
        return Chain(first, last)
    count = len(path)
    inner = np.arange(first + 1, last + 1)
    points = path[inner % count]
    ends = path[[first % count, last % count]]
    tangents = path[[(first + 1) % count, (last + 1) % count]] - ends
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    outward = tangents[0] - tangents[1]  # away from both ends
    if not outward.any():  # the ends lie opposite: both sides will do
        outward = np.array([-tangents[0, 1], tangents[0, 0]])
    position = int(inner[_extreme(points, outward)])
    before, at, after = path[[(position - 1) % count, position % count, (position + 1) % count]]
    # no turn: the edges lie along the hull, which says on which side it is
    along = at - before
    left = bool((turn(before, at, after) or along[1] * outward[0] - along[0] * outward[1]) > 0)
    return Chain(first, last, left, (_tree(path, first, position - 1), _tree(path, position, last)))


def _extreme(points: Array, direction: Array) -> int:
    """Index of the point furthest in a direction; of several, of one at the end of their row."""
    reach = points @ direction
    slack = _NEAR * float(np.abs(points).max() * np.abs(direction).max())
    near = np.flatnonzero(reach >= reach.max() - slack)
    if len(near) == 1:
        return int(near[0])
    x, y = (Fraction(float(component)) for component in direction)

    def exactly(index: np.intp) -> tuple[Fraction, Fraction]:
        a, b = (Fraction(float(value)) for value in points[index])
        return a * x + b * y, b * x - a * y

    return int(max(near, key=exactly))
