"""What a problem with singular corners is assembled from."""

from __future__ import annotations

from dataclasses import replace

from rfm.errors import DiscretizationError
from solvers.background import Background
from solvers.corners.enrichment import CHOICES, OFF, enriched_corners, unsuitable
from solvers.corners.rules import split_at_corners
from solvers.corners.space import CornerSpace
from solvers.grid import Grid
from solvers.problem import Discretization, Problem, SolverOptions
from solvers.setting import Region, Setting, Structure
from structures.operator import unknown


def settled(
    discretization: Discretization, method: str, options: SolverOptions, problem: Problem
) -> Discretization:
    """Return the discretisation without singular functions where they are not possible.

    Raises
    ------
    DiscretizationError
        There is no such choice.
    """
    if discretization.singular not in CHOICES:
        raise DiscretizationError(
            f"unknown singular {discretization.singular!r}: choose one of {', '.join(CHOICES)}"
        )
    if discretization.singular == OFF or unsuitable(method, options, problem, discretization) is None:
        return discretization
    return replace(discretization, singular=OFF)


def corner_space(problem: Problem, discretization: Discretization, grid: Grid) -> CornerSpace | None:
    """Space of the singular functions, None without any."""
    corners = enriched_corners(problem, discretization, grid)
    return CornerSpace(grid, corners) if corners else None


def with_corners(structure: Structure, corners: CornerSpace | None) -> Structure:
    """Return the structure of a scalar with the corner functions added, as its unknown number 1."""
    if corners is None:
        return structure
    (scalar,) = structure
    return (scalar + unknown(2, 1),)


def cornered(structure: Structure, background: Background, corners: CornerSpace) -> Setting:
    """Splines and corner functions; regions far from the corners, around and at them."""
    near = [enriched.corner for enriched in corners.corners]
    regions = tuple(
        Region(structure, part) for part in split_at_corners(background, near, background.space.degree)
    )
    return Setting(structure, (background.space, corners), regions, corners=corners)
