"""Quadrature at the ends of pieces: where a value is prescribed on a piece of a surface (``Part.where``).

The weight of a piece is trimmed (Shapiro, Acta Numerica 16, 2007, (5.1)): at the ends of the piece its gradient has no
limit, it depends on the direction.  The solution structure may hold the solution all the same, and converge with
the full order of the splines, if the functional is integrated there: the cells at the ends are cut smaller and smaller
towards them (:mod:`solvers.corner_rules`).  With the plain rules the order is between one and two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rfm.calculus.types import Field
from rfm.geometry.distance import distance, normalise
from rfm.geometry.part import Part
from solvers.background import Background
from solvers.collar import corner_cells, rows_of, split
from solvers.corner_rules import corner_rule
from solvers.problem import Clamped, Dirichlet, Problem, SimplySupported
from solvers.setting import Region, Structure


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
    grid, pairs = background.grid, list(end_functions(problem))
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


def end_functions(problem: Problem) -> Iterator[tuple[Field, Field]]:
    """Pairs of functions whose common zeros are the ends of a piece with a prescribed value."""
    domain = problem.domain
    for condition in problem.conditions:
        if not isinstance(condition, Dirichlet | Clamped | SimplySupported):
            continue
        for member in condition.part.pieces:
            if member.where is not None:
                end = normalise(member.where, domain.dimension)
                for surface in sorted(member.surfaces, key=lambda s: s.label):
                    yield distance(domain, Part(member.name, frozenset([surface]))), end
