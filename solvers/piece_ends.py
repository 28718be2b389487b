"""Quadrature at the ends of pieces: where a value is prescribed on a piece of a surface (``Part.where``).

The weight of a piece is trimmed (Shapiro, Acta Numerica 16, 2007, (5.1)): at the ends of the piece its gradient has no
limit, it depends on the direction.  The solution structure may hold the solution all the same, and converge with
the full order of the splines, if the functional is integrated there: the cells at the ends are cut smaller and smaller
towards them (:mod:`solvers.corner_rules`).  With the plain rules the order is between one and two.

The boundary rules are cut there in the same way, whatever is prescribed: a condition ends in the middle of a cell, and
what it adds to the functional is a step there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rfm.calculus.types import Array, Field
from rfm.errors import GeometryError
from rfm.geometry.distance import distance
from rfm.geometry.normalisation import normalise
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface
from solvers.background import Background
from solvers.classify import classify
from solvers.collar import corner_cells, rows_of, split
from solvers.corner_rules import corner_rule
from solvers.grid import Grid, Integers
from solvers.problem import Clamped, Condition, Dirichlet, Problem, SimplySupported
from solvers.quadrature import domain_rules
from solvers.quadrature.batch import PointBatch, PointRule
from solvers.setting import Region, Structure

Pairs = Sequence[tuple[Field, Field]]
"""Functions whose common zeros are ends of pieces."""
Points = tuple[Integers, Array, Array, Array]
"""Of a flat boundary rule: cells (n, d), unit coordinates (n, d), weights (n,) and normals (n, d)."""
LEVELS = 24
"""Halvings of a cell at the end of a piece, for the boundary: what is left is 6e-8 of a cell long."""


def regions_at_ends(
    problem: Problem, structure: Structure, background: Background, points: int
) -> tuple[Region, ...]:
    """Return the domain in one region, or apart from the cells at the ends of pieces.

    Parameters
    ----------
    problem, structure, background
        What is solved, on all of the domain.
    points
        Gauss points a direction in the cells at the ends.
    """
    grid, pairs = (
        background.grid,
        [pair for c in problem.conditions if _held(c) for pair in ends(problem.domain, c)],
    )
    if not pairs or grid.dimension > 2:  # curves of ends in space: too many cells
        return (Region(structure, background),)
    cells = np.argwhere(background.classification.state >= 0)
    chosen = np.zeros(background.classification.state.shape, dtype=bool)
    chosen[tuple(cells[corner_cells(grid, cells, pairs)].T)] = True
    far, near = split(background, chosen, points)
    rules = near.rules
    at = np.concatenate([rules.inner.cells, rules.cut.cells])
    graded = replace(
        rules,
        inner=rows_of(rules.inner, np.zeros(len(rules.inner.cells), dtype=bool)),
        cut=corner_rule(problem.domain, grid, at, pairs, points),
    )
    return Region(structure, far), Region(structure, replace(near, rules=graded))


def ends(domain: Shape, condition: Condition) -> Iterator[tuple[Field, Field]]:
    """Pairs of functions whose common zeros are the ends of a condition that holds on a piece."""
    for member in condition.part.pieces:
        if member.where is not None:
            end = normalise(member.where, domain.dimension)
            for surface in sorted(member.surfaces, key=lambda s: s.label):
                yield distance(domain, Part(member.name, frozenset([surface]))), end


def cut_at_ends(problem: Problem, background: Background, points: int) -> Background:
    """Return the background with boundary rules that are cut where a condition ends in the middle of a surface.

    Parameters
    ----------
    problem, background
        What is solved.
    points
        Gauss points on each piece of boundary.
    """
    grid, domain = background.grid, problem.domain
    pairs = [pair for condition in problem.conditions for pair in ends(domain, condition)]
    rules: dict[Surface, PointBatch] = dict(background.rules.boundary) if pairs else {}
    if not rules or grid.dimension > 2:  # another process may have all of the boundary
        return background
    touched = np.unique(np.concatenate([batch.cells for batch in rules.values()]), axis=0)
    chosen = touched[corner_cells(grid, touched, pairs)]
    found: dict[Surface, list[Points]] = {surface: [] for surface in rules}
    for cell in chosen:
        for surface, piece in _graded(domain, grid, cell, pairs, points):
            found.setdefault(surface, []).append(piece)
    for surface, batch in rules.items():
        kept = ~(batch.cells[:, None] == chosen).all(axis=2).any(axis=1)
        rules[surface] = _joined([*_flat(batch.take(np.flatnonzero(kept))), *found[surface]])
    return replace(background, rules=replace(background.rules, boundary=rules))


def _held(condition: Condition) -> bool:
    """Tell whether a condition prescribes a value, so that its weight is trimmed."""
    return isinstance(condition, Dirichlet | Clamped | SimplySupported)


def _graded(
    domain: Shape, grid: Grid, cell: Integers, pairs: Pairs, points: int
) -> Iterator[tuple[Surface, Points]]:
    """Yield boundary rules of one cell, on smaller and smaller boxes towards the ends."""
    boxes = [(grid.lower + grid.spacing * cell, grid.spacing)]
    for level in range(LEVELS):
        following: dict[tuple[float, ...], tuple[Array, Array]] = {}
        for lower, width in boxes:
            halves = Grid(lower, width / 2, np.full(grid.dimension, 2))
            try:
                rules: Mapping[Surface, PointBatch] = domain_rules(
                    domain, classify(domain, halves), 1, points
                ).boundary
            except GeometryError:  # nothing of the domain in this box
                continue
            for surface, batch in rules.items():
                again = corner_cells(halves, batch.cells, pairs)
                if level == LEVELS - 1:
                    again[:] = False
                for c in batch.cells[again]:
                    corner = halves.lower + halves.spacing * c
                    following[tuple(corner.tolist())] = (corner, halves.spacing)
                for _, nodes, weights, normals in _flat(batch.take(np.flatnonzero(~again)), halves):
                    at = (nodes - grid.lower) / grid.spacing - cell
                    yield surface, (np.broadcast_to(cell, at.shape), at, weights, normals)
        boxes = list(following.values())


def _flat(batch: PointBatch, grid: Grid | None = None) -> Iterator[Points]:
    """Yield the points that count; in physical coordinates where a grid is given."""
    if len(batch) and batch.normals is not None:
        valid = batch.weights > 0
        nodes = batch.nodes if grid is None else np.stack(batch.points(grid), axis=-1)
        cells = np.broadcast_to(batch.cells[:, None], (*valid.shape, batch.cells.shape[1]))
        yield cells[valid], nodes[valid], batch.weights[valid], batch.normals[valid]


def _joined(pieces: Sequence[Points]) -> PointBatch:
    """Return one padded rule."""
    cells, nodes, weights, normals = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
    distinct, rows = np.unique(cells, axis=0, return_inverse=True)
    return PointRule.gather(distinct, rows.ravel(), nodes, weights, normals).padded()
