"""Quadrature for cells at corners where an integrand has no limit: graded towards the corner.

The windows of two parts that meet are homogeneous of degree zero around their common point, bounded but without a
limit there.  A cell that may hold such a point is halved, and so is every child that may, until what is left is too
small to matter (each level divides the area by four); all other children get ordinary rules.  On them the integrand is
analytic at the scale of the child, so every level is as accurate as a Gauss rule of the same number of points.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.types import Array, Field
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape
from solvers.classify import classify
from solvers.collar import corner_cells
from solvers.grid import Grid, Integers
from solvers.quadrature import domain_rules
from solvers.quadrature.batch import PointRule

LEVELS = 10
"""Halvings; 16 change the error in the fourth digit, 7 cost a factor of two at degree 5."""


def corner_rule(
    domain: Shape, grid: Grid, cells: Integers, pairs: Sequence[tuple[Field, Field]], points: int
) -> PointRule:
    """Volume rule of the cells, graded towards the common zeros of the pairs.

    Parameters
    ----------
    domain, grid
        The domain and its grid.
    cells
        The cells, shape (n, d).
    pairs
        Pairs of functions normalised on two parts that meet.
    points
        Gauss points a direction.
    """
    rows: list[Integers] = []
    nodes: list[Array] = []
    weights: list[Array] = []
    for row, cell in enumerate(cells):
        for at, weight in _graded(domain, grid, cell, pairs, points):
            rows.append(np.full(len(weight), row))
            nodes.append((at - grid.lower) / grid.spacing - cell)
            weights.append(weight)
    dimension = grid.dimension
    if not rows:
        return PointRule.gather(cells, np.zeros(0, np.int64), np.zeros((0, dimension)), np.zeros(0))
    return PointRule.gather(cells, np.concatenate(rows), np.concatenate(nodes), np.concatenate(weights))


def _graded(
    domain: Shape, grid: Grid, cell: Integers, pairs: Sequence[tuple[Field, Field]], points: int
) -> list[tuple[Array, Array]]:
    """Points (q, d) and weights (q,) of one cell, a list of pieces."""
    found: list[tuple[Array, Array]] = []
    dimension, levels = grid.dimension, LEVELS
    boxes = [(grid.lower + grid.spacing * cell, grid.spacing)]
    for level in range(levels):
        following = []
        for lower, width in boxes:
            halves = Grid(lower, width / 2, np.full(dimension, 2))
            try:
                rules = domain_rules(domain, classify(domain, halves), points, points)
            except GeometryError:  # nothing of the domain in this box
                continue
            for rule in (rules.inner, rules.cut):
                again = corner_cells(halves, rule.cells, pairs)
                if level == levels - 1:
                    again[:] = False
                following += [(halves.lower + halves.spacing * c, halves.spacing) for c in rule.cells[again]]
                kept = rule.take(np.flatnonzero(~again)) if isinstance(rule, PointRule) else None
                if kept is None:
                    coords = [c[~again].ravel() for c in rule.points(halves)]
                    found.append((np.stack(coords, axis=1), rule.weights[~again].ravel()))
                else:
                    found.append((np.stack(kept.points(halves), axis=1), kept.weights))
        boxes = following
    return [(at, weight) for at, weight in found if len(weight)]
