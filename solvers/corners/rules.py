r"""Quadrature at a corner with singular functions.

With the corner as origin a convex polygon is the sum of the signed triangles between the origin and its sides (a, b);
on one of them, with Duffy's coordinates,

.. math:: x = t^\beta (a + v (b - a)), \qquad dx = (a \times b)\, \beta\, t^{2\beta - 1}\, dt\, dv .

Products of first derivatives of the functions :math:`r^{\lambda_j}, r^{\lambda_k}` of the corner are
:math:`r^{\lambda_j + \lambda_k - 2}` times a smooth function of v; with :math:`\beta = 2\omega/\pi` that is a whole
power of t, :math:`t^{2(j+k) - 1}`, which Gauss' rule integrates to rounding.  Splines and weights are smooth on the two
halves of the corner's sector: they have whole powers of r.

Nodes of signed triangles lie in the sector but perhaps beyond their cell, some weights are negative: all that is
integrated is the cell's polynomial piece and functions of the corner, which are defined there.

The cells around these need a few more Gauss points than others: the functions are analytic, but not for many cells.
Their cut cells keep their own rules, and so do those behind the corner, in which the functions jump outside the domain.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.singular.straight import StraightCorner
from solvers.background import Background
from solvers.collar import only_volume, rows_of
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import PointRule
from solvers.quadrature.lines import LineRule
from solvers.quadrature.pieces import gauss
from solvers.quadrature.tensor import inner_rule

Vertex: TypeAlias = "tuple[float, float]"

CORE = 0.5
"""Cells nearer than this, in cells, are integrated with the corner as origin."""
RING = 3.0
"""Cells nearer than this have at least so many Gauss points a direction (with p + 1, an arrow head with p = 3 has 40
times the error in the gradient; a ring of 2 cells costs a factor of 9, one of 6 gains a factor of 2 at most):"""
FEWEST = 7
ANGULAR = 3
"""Gauss points along the side of a triangle, besides those for the degree."""
RADIAL = 8
"""Gauss points along a ray, besides those for the degree."""


def gaps(grid: Grid, cells: Integers, point: Sequence[float]) -> Array:
    """Distance of cells (n, 2) to a point, in cells, shape (n,)."""
    lower = grid.lower + grid.spacing * cells
    here = np.asarray(point)
    found: Array = (
        np.maximum(np.maximum(lower - here, here - lower - grid.spacing), 0.0) / grid.spacing
    ).max(axis=1)
    return found


def behind(grid: Grid, corner: StraightCorner) -> Integers:
    """Cells (n, 2) on the ray opposite to the bisector of a corner, across which its functions jump.

    The ray lies outside the domain, but a tensor rule that a cut cell is folded into has nodes there.
    """
    along = np.arange(0.0, float(np.max(grid.spacing * grid.cells)), 0.2 * float(np.min(grid.spacing)))
    direction = corner.start + 0.5 * corner.angle + math.pi
    ray = np.array(corner.point) + along[:, None] * np.array([math.cos(direction), math.sin(direction)])
    inside = ((ray >= grid.lower) & (ray <= grid.upper)).all(axis=1)
    return grid.locate(ray[inside])[0]


def split_at_corners(
    background: Background, corners: Sequence[StraightCorner], degree: int
) -> tuple[Background, ...]:
    """Rules far from the corners, around them, and at them; the boundary rules go with the far part.

    The cells at corners are apart from those around because they have many more points, and rules of cells that are
    evaluated together are padded to the longest.
    """
    grid, rules, folded = background.grid, background.rules, background.folded
    state = background.classification.state
    cells = np.argwhere(state >= 0)
    core, ring = np.zeros(state.shape, dtype=bool), np.zeros(state.shape, dtype=bool)
    fans = []
    for corner in corners:
        gap = gaps(grid, cells, corner.point)
        near = cells[gap < CORE]
        core[tuple(near.T)] = True
        ring[tuple(cells[gap < RING].T)] = True
        ring[tuple(behind(grid, corner).T)] = True
        fans.append(fan(grid, near, corner, degree))
    ring &= ~core
    inner, cut = rules.inner, rules.cut
    ring_cut = ring[tuple(cut.cells.T)]
    ring_inner = ring[tuple(inner.cells.T)] & (degree + 1 < FEWEST)
    far_inner = ~(ring_inner | core[tuple(inner.cells.T)])
    far_cut = ~(ring_cut | core[tuple(cut.cells.T)])
    far = replace(
        background,
        rules=replace(rules, inner=rows_of(inner, far_inner), cut=cut.take(np.flatnonzero(far_cut))),
        folded=None if folded is None else rows_of(folded, far_cut),
    )
    around = replace(
        rules,
        inner=inner_rule(grid, inner.cells[ring_inner], FEWEST),
        cut=cut.take(np.flatnonzero(ring_cut)),
        boundary={},
    )
    return far, replace(background, rules=around, folded=None), only_volume(background, joined(fans))


def all_rules(far: Background, around: Background, at: Background) -> Background:
    """All parts in one, for norms."""
    cut = joined([far.rules.cut, around.rules.cut, _points(around), at.rules.cut])
    return replace(far, rules=replace(far.rules, cut=cut), folded=None)


def _points(around: Background) -> PointRule:
    """Tensor rule around corners as points."""
    inner = around.rules.inner
    unit, (n, q) = inner.unit_points(), inner.weights.shape
    rows = np.repeat(np.arange(n), q)
    return PointRule.gather(inner.cells, rows, np.tile(unit, (n, 1)), inner.weights.ravel())


def fan(grid: Grid, cells: Integers, corner: StraightCorner, degree: int) -> PointRule:
    """Rule of the cells (n, 2) of the sector of a corner, with the corner as origin."""
    beta = 2.0 * corner.angle / math.pi
    t, radial = gauss(degree + RADIAL)
    v, angular = gauss(degree + ANGULAR)
    s, weights = t**beta, radial * beta * t ** (2.0 * beta - 1.0)
    origin = np.array(corner.point)
    rays = [corner.start + share * corner.angle for share in (0.0, 0.5, 1.0)]
    directions = [(math.cos(a), math.sin(a)) for a in rays]
    rows, sides = [], []
    for row, cell in enumerate(cells):
        lower = (grid.lower + grid.spacing * cell - origin).tolist()
        for first, second in pairwise(directions):
            polygon = clipped(clipped(_box(lower, grid.spacing.tolist()), _left(first)), _right(second))
            for a, b in zip(polygon, [*polygon[1:], *polygon[:1]], strict=True):
                if abs(a[0] * b[1] - a[1] * b[0]) > 1e-14 * grid.cell_volume:
                    rows.append(row)
                    sides.append((a, b))
    if not rows:
        return PointRule.gather(cells, np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0))
    a, b = np.moveaxis(np.array(sides), 1, 0)
    areas = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    points = s[:, None, None] * (a[:, None] + v[:, None] * (b - a)[:, None])[:, None]  # (sides, s, v, 2)
    corners = (grid.corners(cells)[rows] - origin)[:, None, None]
    return PointRule.gather(
        cells,
        np.repeat(rows, len(s) * len(v)),
        ((points - corners) / grid.spacing).reshape(-1, 2),
        (areas[:, None, None] * np.multiply.outer(weights, angular)).ravel(),
    )


def _box(lower: Vertex, width: Vertex) -> list[Vertex]:
    """Vertices of a cell, counter-clockwise."""
    (x, y), (dx, dy) = lower, width
    return [(x, y), (x + dx, y), (x + dx, y + dy), (x, y + dy)]


def _left(direction: Vertex) -> Vertex:
    """Normal to the left of a direction."""
    return -direction[1], direction[0]


def _right(direction: Vertex) -> Vertex:
    """Normal to the right of a direction."""
    return direction[1], -direction[0]


def clipped(polygon: Sequence[Vertex], normal: Vertex) -> list[Vertex]:
    """Part of a convex polygon with ``normal . x >= 0``; plain numbers, because there are only a few."""
    found = []
    for p, q in zip(polygon, [*polygon[1:], *polygon[:1]], strict=True):
        here, there = (normal[0] * x + normal[1] * y for x, y in (p, q))
        if here >= 0.0:
            found.append(p)
        if here * there < 0.0:
            t = here / (here - there)
            found.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
    return found


def joined(rules: Sequence[LineRule | PointRule]) -> PointRule:
    """One rule of several on different cells."""
    counts = np.concatenate([rule.counts for rule in rules])
    cells = np.concatenate([rule.cells for rule in rules])
    return PointRule.gather(
        cells,
        np.repeat(np.arange(len(cells)), counts),
        np.concatenate([rule.nodes for rule in rules]),
        np.concatenate([rule.weights for rule in rules]),
    )
