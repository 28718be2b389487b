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
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.singular.straight import StraightCorner
from solvers.background import Background
from solvers.collar import rows_of
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import PointRule
from solvers.quadrature.lines import LineRule
from solvers.quadrature.pieces import gauss
from solvers.quadrature.tensor import inner_rule

CORE = 0.5
"""Cells nearer than this, in cells, are integrated with the corner as origin."""
RING = 2.0
"""Cells nearer than this get more Gauss points."""
MORE = 3
"""How many more, a direction."""
RADIAL = 12
"""Gauss points along a ray, besides those for the degree."""


def gaps(grid: Grid, cells: Integers, point: Sequence[float]) -> Array:
    """Distance of cells (n, 2) to a point, in cells, shape (n,)."""
    lower = grid.lower + grid.spacing * cells
    here = np.asarray(point)
    found: Array = (
        np.maximum(np.maximum(lower - here, here - lower - grid.spacing), 0.0) / grid.spacing
    ).max(axis=1)
    return found


def split_at_corners(
    background: Background, corners: Sequence[StraightCorner], degree: int
) -> tuple[Background, Background]:
    """Rules far from the corners, and near them; the boundary rules go with the far part."""
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
        fans.append(fan(grid, near, corner, degree))
    ring &= ~core
    inner, cut = rules.inner, rules.cut
    at_inner = {name: mask[tuple(inner.cells.T)] for name, mask in (("core", core), ("ring", ring))}
    at_cut = {name: mask[tuple(cut.cells.T)] for name, mask in (("core", core), ("ring", ring))}
    far_inner, far_cut = (~(at["core"] | at["ring"]) for at in (at_inner, at_cut))
    far = replace(
        background,
        rules=replace(rules, inner=rows_of(inner, far_inner), cut=cut.take(np.flatnonzero(far_cut))),
        folded=None if folded is None else rows_of(folded, far_cut),
    )
    near_rules = replace(
        rules,
        inner=inner_rule(grid, inner.cells[at_inner["ring"]], degree + 1 + MORE),
        cut=joined([cut.take(np.flatnonzero(at_cut["ring"])), *fans]),
        boundary={},
    )
    return far, replace(background, rules=near_rules, folded=None)


def all_rules(far: Background, near: Background) -> Background:
    """Both parts in one, for norms."""
    rules = replace(far.rules, cut=joined([far.rules.cut, near.rules.cut, _points(near)]))
    return replace(far, rules=rules, folded=None)


def _points(near: Background) -> PointRule:
    """Tensor rule of the ring as points."""
    inner = near.rules.inner
    unit, (n, q) = inner.unit_points(), inner.weights.shape
    rows = np.repeat(np.arange(n), q)
    return PointRule.gather(inner.cells, rows, np.tile(unit, (n, 1)), inner.weights.ravel())


def fan(grid: Grid, cells: Integers, corner: StraightCorner, degree: int) -> PointRule:
    """Rule of the cells (n, 2) of the sector of a corner, with the corner as origin."""
    beta = 2.0 * corner.angle / math.pi
    t, radial = gauss(degree + RADIAL)
    v, angular = gauss(degree + 1 + MORE)
    s, weights = t**beta, radial * beta * t ** (2.0 * beta - 1.0)
    origin = np.array(corner.point)
    rays = [corner.start + share * corner.angle for share in (0.0, 0.5, 1.0)]
    directions = [np.array([math.cos(a), math.sin(a)]) for a in rays]
    rows, nodes, values = [], [], []
    for row, cell in enumerate(cells):
        lower = grid.lower + grid.spacing * cell
        for first, second in pairwise(directions):
            polygon = clipped(clipped(_box(lower - origin, grid.spacing), left(first)), -left(second))
            for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
                area = float(a[0] * b[1] - a[1] * b[0])
                if abs(area) < 1e-14 * grid.cell_volume:
                    continue
                points = s[:, None, None] * (a + v[:, None] * (b - a))
                nodes.append(((points + origin - lower) / grid.spacing).reshape(-1, 2))
                values.append(area * np.outer(weights, angular).ravel())
                rows.append(np.full(values[-1].size, row))
    if not rows:
        return PointRule.gather(cells, np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0))
    return PointRule.gather(cells, np.concatenate(rows), np.concatenate(nodes), np.concatenate(values))


def _box(lower: Array, width: Array) -> Array:
    """Vertices of a cell, counter-clockwise."""
    box: Array = lower + width * np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    return box


def left(direction: Array) -> Array:
    """Normal to the left of a direction."""
    return np.asarray([-direction[1], direction[0]], dtype=float)


def clipped(polygon: Array, normal: Array) -> Array:
    """Part of a convex polygon (n, 2) with ``normal . x >= 0``."""
    found = []
    heights = polygon @ normal if len(polygon) else np.zeros(0)
    for p, q, here, there in zip(
        polygon, np.roll(polygon, -1, axis=0), heights, np.roll(heights, -1), strict=True
    ):
        if here >= 0.0:
            found.append(p)
        if here * there < 0.0:
            found.append(p + (q - p) * (here / (here - there)))
    return np.array(found).reshape(-1, 2)


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
