"""Volume rules in boxes in which every surface is a graph over a common base.

Notation: the axes of the coefficient arrays are ``x`` (the height direction), ``y`` and, in three dimensions, ``z``
last.  Base lines are broken wherever the structure of the lines along ``x`` changes (a height enters or leaves the
box, two heights meet), lines are broken at their roots, and pieces inside the domain are kept; each carries a Gauss
rule: all weights are positive and the integrand is smooth on each piece (R. Saye, SIAM J. Sci. Comput. 37, 2015).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature.heights import edge_breaks, face_roots, height, meetings, restrict, triple_points
from solvers.quadrature.pieces import SHORTEST, broken, gauss

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.logic import Mask
    from solvers.grid import Integers
    from solvers.quadrature.pieces import Breaks


@dataclass(frozen=True, eq=False)
class Graphs:
    """Surfaces over a common base.

    Attributes
    ----------
    c
        Coefficients, axes ordered ``(x, y[, z])``, shape ``(n, m, K+1, ..., K+1)``.
    noise
        Rounding level of the coefficients, shape ``(n, m)``.
    upright
        Which surfaces do not depend on ``x`` (no height; their trace on the base is a break), shape ``(n, m)``.
    table
        Whether the domain contains each combination of signs (see :meth:`Logic.table`), shape ``(n, 2**m)``.
    """

    c: Array
    noise: Array
    upright: Mask
    table: Mask

    def slices(self, owner: Integers, z: Array) -> Graphs:
        """Return the two-dimensional slices at ``z (P, q)`` of boxes ``owner (P,)``, ``P*q`` of them."""
        q = z.shape[1]
        c = restrict(self.c[owner], z)
        where = np.repeat(owner, q)
        return Graphs(c.reshape(-1, *c.shape[2:]), self.noise[where], self.upright[where], self.table[where])


@dataclass(frozen=True, eq=False)
class Segments:
    """Lines along ``x``: box number, ends of the line (its start, length), other coordinates, and total weight.

    Arrays of shape ``(L,)``; ``base`` has one for ``y`` and, in space, one for ``z``.
    """

    owner: Integers
    start: Array
    length: Array
    base: tuple[Array, ...]
    weight: Array


def volume_lines(graphs: Graphs, order: int) -> Segments:
    """Return the lines along ``x`` that make up the domain in all boxes, in box units."""
    if graphs.c.ndim == 4:
        return _plane(graphs, order)
    owner, z, weight = base_nodes(graphs, order, all_pairs(graphs), all_triples(graphs))
    plane = _plane(graphs.slices(owner, z), order)
    of = plane.owner
    return Segments(
        owner[of // order],
        plane.start,
        plane.length,
        (*plane.base, z.ravel()[of]),
        plane.weight * weight.ravel()[of],
    )


def all_pairs(graphs: Graphs) -> list[tuple[int, int]]:
    """Return all pairs of slots."""
    return list(combinations(range(graphs.noise.shape[1]), 2))


def all_triples(graphs: Graphs) -> list[tuple[int, int, int]]:
    """Return all triples of slots."""
    return list(combinations(range(graphs.noise.shape[1]), 3))


def base_nodes(
    graphs: Graphs, order: int, pairs: list[tuple[int, int]], triples: list[tuple[int, int, int]]
) -> tuple[Integers, Array, Array]:
    """Return box numbers ``(P,)``, nodes ``(P, order)`` and weights ``(P, order)`` along ``z``."""
    breaks = edge_breaks(graphs.c, graphs.noise, pairs)
    if triples:
        breaks += triple_points(graphs.c, graphs.noise, triples, breaks)
    pieces = broken(len(graphs.c), breaks)
    t, w = gauss(order)
    return pieces.owner, pieces.nodes(t), pieces.length[:, None] * w


def line_breaks(graphs: Graphs, slots: slice, pairs: list[tuple[int, int]]) -> list[Breaks]:
    """Return the breaks along ``y`` of two-dimensional slices: roots on faces of ``slots``, meetings of ``pairs``."""
    breaks = [face_roots(graphs.c[:, slots], graphs.noise[:, slots])]
    for i, j in pairs:
        where = np.flatnonzero(~(graphs.upright[:, i] & graphs.upright[:, j]))
        index, y, _ = meetings(
            graphs.c[where, i], graphs.c[where, j], graphs.noise[where, i], graphs.noise[where, j]
        )
        breaks.append((where[index], y))
    return breaks


def _plane(graphs: Graphs, order: int) -> Segments:
    t, w = gauss(order)
    pieces = broken(len(graphs.c), line_breaks(graphs, slice(None), all_pairs(graphs)))
    owner = pieces.owner
    y = pieces.nodes(t)
    lines = restrict(graphs.c[owner], y)
    noise = graphs.noise[owner][:, None]
    root, exists = height(lines, noise)
    first, last = lines[..., 0], lines[..., -1]
    exists &= ~graphs.upright[owner][:, None]
    # Segments between sorted roots, (P, q, m + 1); a line without a root has an empty segment at its start.
    stops = np.sort(np.where(exists, root, 0.0), axis=-1)
    ends = np.concatenate([np.zeros((*y.shape, 1)), stops, np.ones((*y.shape, 1))], axis=-1)
    length = np.diff(ends, axis=-1)
    middle = ends[..., :-1] + 0.5 * length
    code = np.zeros(middle.shape, dtype=np.int64)
    for a in range(lines.shape[2]):
        rising = (last > first)[..., a, None]
        positive = np.where(
            exists[..., a, None], (middle > root[..., a, None]) == rising, (first + last)[..., a, None] > 0
        )
        code |= positive.astype(np.int64) << a
    inside = graphs.table[owner[:, None, None], code]
    kept = np.flatnonzero(inside & (length > SHORTEST))
    # flat numbers of segment, base point and piece
    point = kept // (lines.shape[2] + 1)
    piece = point // order
    step = length.ravel()[kept]
    weight = pieces.length[piece] * w[point - order * piece] * step
    start = ends[..., :-1].ravel()[kept]
    return Segments(owner[piece], start, step, (y.ravel()[point],), weight)
