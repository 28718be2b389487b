"""Exact mode: every condition is part of the solution structure, flux conditions in collars along their parts.

Ritz's functional keeps its boundary terms: the structure says what the flux is, the functional still has to know what
work it does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from solvers.background import Background
from solvers.collar import CORNER_SLACK, collar_space, corner_cells, only_volume, split, split_off, within
from solvers.corner_rules import corner_rule
from solvers.cross_assembly import used_cells
from solvers.flux_collars import REACH, VANISHED, Collar, collared, collars_of
from solvers.flux_conditions import boundary_pieces, has_flux
from solvers.grid import Grid
from solvers.piece_ends import cut_at_ends
from solvers.problem import Discretization, Problem
from solvers.seams import seamless_structure
from solvers.setting import Region, Setting, Structure
from solvers.web import SplineSpace
from structures.contact import meeting_points

END_SLACK = 2.5
"""How far from the end of a piece cells are cut, in half diagonals; CORNER_SLACK costs up to ten times the error."""


@dataclass(frozen=True)
class Exact:
    """All conditions by structure."""

    def quadrature(self, problem: Problem, discretization: Discretization) -> Discretization:
        """Points in the cut cells of collars, unless they are given."""
        if discretization.quadrature_points is not None or not any(has_flux(c) for c in problem.conditions):
            return discretization
        points = cut_points(discretization.degree, parts_meet(problem))
        return replace(discretization, quadrature_points=points)

    def structure(self, problem: Problem, discretization: Discretization, grid: Grid) -> Structure:
        """Structure with the collars that suit the grid."""
        essential = seamless_structure(problem, discretization, grid)
        return collared(essential, collars_of(problem, width_of(grid)))

    def setting(self, problem: Problem, discretization: Discretization, background: Background) -> Setting:
        """Second splines in the collars; regions far from them, in them, and at their corners.

        Raises
        ------
        DiscretizationError
            A condition has no exact structure.
        """
        grid, degree = background.grid, discretization.degree
        essential = seamless_structure(problem, discretization, grid)
        main = (background.space,) * len(essential)
        collars = collars_of(problem, width_of(grid))
        if not collars:
            return Setting(essential, main, (Region(essential, background),))
        structure = collared(essential, collars)
        background = cut_at_ends(problem, background, collar_points(degree))
        spaces = [
            collar_space(background, discretization.basis, degree - 1, c.site.w, REACH * c.length)
            for c in collars
        ]
        seconds = [space for space, c in zip(spaces, collars, strict=True) for _ in c.components]
        return Setting(
            structure,
            (*main, *seconds),
            regions(problem, essential, structure, background, collars, spaces, degree),
        )


def regions(
    problem: Problem,
    essential: Structure,
    structure: Structure,
    background: Background,
    collars: Sequence[Collar],
    spaces: Sequence[SplineSpace],
    degree: int,
) -> tuple[Region, ...]:
    """Cells where all windows are zero to rounding, cells of the collars, and cells at their corners."""
    grid, points = background.grid, collar_points(degree)
    cells = np.argwhere(background.classification.state >= 0)
    near = np.zeros(background.classification.state.shape, dtype=bool)
    for c in collars:
        near[tuple(cells[within(c.site.w, grid, cells, VANISHED * c.length)].T)] = True
    for space in spaces:  # where the window is tiny, the coefficients of its spline may be large
        near |= used_cells(space)
    far, collar = split(background, near, points)
    pairs = [(c.own, other) for c in collars for other in c.meeting]
    if not pairs:
        return Region(essential, far), Region(structure, collar)
    at_corners = np.zeros_like(near)
    # at the ends of pieces the windows are those of trimmed functions, which are steep farther out
    slack = END_SLACK if any(c.own is not c.site.w for c in collars) else CORNER_SLACK
    at_corners[tuple(cells[corner_cells(grid, cells, pairs, slack)].T)] = True
    rest, corners = split_off(collar, at_corners)
    graded = only_volume(collar, corner_rule(problem.domain, grid, corners, pairs, points))
    return Region(essential, far), Region(structure, rest), Region(structure, graded)


def width_of(grid: Grid) -> float:
    """Longest side of a cell."""
    return float(np.max(grid.spacing))


def collar_points(degree: int) -> int:
    """Gauss points a direction in the cells of a collar.

    Measured with 64 cells on the mixed annulus: with two fewer the error is 8 times as large for p = 3 and 20 times for
    p = 4; on a rectangle one fewer costs a factor of 1.7 for p = 3.
    """
    return 2 * degree + 3


def cut_points(degree: int, corners: bool) -> int:
    """Gauss points on pieces of lines in the cut cells of a collar.

    Measured on the mixed annulus: for p = 5 and N = 48 the error is 17 % larger with p + 3 points, the same to three
    digits with p + 4 and more; for p = 2 to 4, p + 3 do.  Near corners windows are steeper.  On a quarter of a plate
    with a hole, N = 18, p + 3 points have 1.8 times the error of 2 p + 3 for p = 3, 90 times for p = 4 and 800
    times for p = 5; 2 p have 8 times the error for p = 5.  Moment-fitted rules are of no use here: nearly all of
    these cells fail their test of smoothness.
    """
    if corners:
        return collar_points(degree)
    return degree + 3 if degree < 5 else degree + 4


def parts_meet(problem: Problem) -> bool:
    """Whether a surface with a flux condition meets another surface with a condition."""
    pieces = list(boundary_pieces(problem))
    return any(
        len(meeting_points(problem.domain, first, second))
        for (first, one), (second, two) in combinations(pieces, 2)
        if has_flux(one) or has_flux(two)
    )
