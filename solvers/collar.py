"""Collars: the cells near a part of the boundary, the splines and the quadrature rules there.

A localised structure (:mod:`structures.localized`) multiplies its correction with a window that falls off within a few
cells of its part.  Its second spline is needed only there, in a space of its own on the same grid; the integrands are
steeper there than elsewhere and need more Gauss points; and the window has no limit where two parts meet, so the cells
at such corners are cut smaller and smaller towards them (:mod:`solvers.corner_rules`).

Notation: w a function normalised on the part (its distance, near it), h the cell width, reach a length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from solvers.background import Background
from solvers.extension import extend, no_extension, touched
from solvers.grid import Grid, Integers
from solvers.quadrature.batch import PointRule, TensorBatch
from solvers.quadrature.lines import LineRule
from solvers.quadrature.tensor import inner_rule
from solvers.web import INNER, SplineSpace

Mask = NDArray[np.bool_]
CORNER_SLACK = 1.6
"""How far from a corner cells are cut towards it, in half diagonals of a cell."""


def half_diagonal(grid: Grid) -> float:
    """Half the diagonal of a cell."""
    return 0.5 * float(np.linalg.norm(grid.spacing))


def at_centres(w: Field, grid: Grid, cells: Integers) -> Array:
    """Values of w at the centres of cells (n, d), shape (n,)."""
    centres = grid.points(cells, np.full((1, grid.dimension), 0.5))
    with np.errstate(all="ignore"):
        values: Array = partials(w, centres, 0)[0, :, 0]
    return values


def within(w: Field, grid: Grid, cells: Integers, reach: float) -> Mask:
    """Which of the cells (n, d) have points with w below `reach`; what is not finite counts."""
    return ~(at_centres(w, grid, cells) > reach + half_diagonal(grid))


def collar_space(background: Background, basis: str, degree: int, w: Field, reach: float) -> SplineSpace:
    """Splines of a degree whose support has a cell of the domain at whose centre w is below `reach`.

    Parameters
    ----------
    background
        Grid, classified cells and rules of the domain.
    basis
        ``web-spline`` extends the splines without a whole cell in the domain, ``b-spline`` leaves them free.
    degree
        Degree of the splines.
    w, reach
        What the collar is.
    """
    grid = background.grid
    inside = background.classification.state == INNER
    active = inside.copy()
    active[tuple(np.asarray(background.rules.cut.cells).T)] = True
    cells = np.argwhere(active)
    chosen = cells[~(at_centres(w, grid, cells) > reach)]
    collar = np.zeros_like(inside)
    collar[tuple(chosen.T)] = True
    relevant = touched(collar, degree)
    inner = touched(inside, degree) & relevant
    build = no_extension if basis == "b-spline" else extend
    return SplineSpace(grid, degree, build(inner, relevant, degree))


def split(background: Background, near: Mask, points: int) -> tuple[Background, Background]:
    """Far and near part of the volume rules; the boundary rules go with the near part.

    Parameters
    ----------
    background
        Rules of the whole domain.
    near
        The cells of the near part, a mask of the grid's shape.
    points
        Gauss points a direction in the inner cells of the near part; its cut cells keep their rules, not folded.
    """
    rules, folded = background.rules, background.folded
    inner_near, cut_near = near[tuple(rules.inner.cells.T)], near[tuple(rules.cut.cells.T)]
    far_rules = replace(
        rules,
        inner=rows_of(rules.inner, ~inner_near),
        cut=rules.cut.take(np.flatnonzero(~cut_near)),
        boundary={},
    )
    near_rules = replace(
        rules,
        inner=inner_rule(background.grid, rules.inner.cells[inner_near], points),
        cut=rules.cut.take(np.flatnonzero(cut_near)),
    )
    far = replace(background, rules=far_rules, folded=None if folded is None else rows_of(folded, ~cut_near))
    return far, replace(background, rules=near_rules, folded=None)


def split_off(background: Background, chosen: Mask) -> tuple[Background, Integers]:
    """Collar without the volume rules of some cells (a mask of the grid's shape), and these cells (n, d)."""
    rules = background.rules
    inner, cut = chosen[tuple(rules.inner.cells.T)], chosen[tuple(rules.cut.cells.T)]
    left = replace(rules, inner=rows_of(rules.inner, ~inner), cut=rules.cut.take(np.flatnonzero(~cut)))
    cells = np.concatenate([rules.inner.cells[inner], rules.cut.cells[cut]])
    return replace(background, rules=left), cells


def rows_of(batch: TensorBatch, chosen: Mask) -> TensorBatch:
    """Some cells of a tensor rule."""
    return TensorBatch(batch.cells[chosen], batch.nodes, batch.weights[chosen])


def corner_cells(
    grid: Grid, cells: Integers, pairs: Sequence[tuple[Field, Field]], slack: float = CORNER_SLACK
) -> Mask:
    """Which of the cells (n, d) may hold a common zero of one of the pairs of functions, or lie beside it."""
    radius = slack * half_diagonal(grid)
    found = np.zeros(len(cells), dtype=bool)
    for first, second in pairs:
        near = np.abs(at_centres(first, grid, cells)) < radius
        rows = np.flatnonzero(near)
        near[rows] = np.abs(at_centres(second, grid, cells[rows])) < radius
        found |= near
    return found


def only_volume(background: Background, rule: LineRule | PointRule) -> Background:
    """Background with nothing but one volume rule in cells of its own."""
    rules = background.rules
    none = rows_of(rules.inner, np.zeros(len(rules.inner), dtype=bool))
    return replace(background, rules=replace(rules, inner=none, cut=rule, boundary={}), folded=None)
