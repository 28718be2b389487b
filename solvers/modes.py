"""How conditions that are not essential are met: by the functional, or by the structure.

``natural`` leaves flux conditions to the functional; ``exact`` builds them into the structure.  Both are siblings in
:data:`MODES`; what comes after them only sees a :class:`solvers.setting.Setting`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from rfm.errors import DiscretizationError
from solvers.background import Background
from solvers.corners.setting import corner_space, cornered, with_corners
from solvers.exact_mode import Exact, collar_points
from solvers.grid import Grid
from solvers.piece_ends import cut_at_ends, regions_at_ends
from solvers.problem import Discretization, Problem
from solvers.seams import seamless_structure
from solvers.setting import Setting, Structure


class Mode(Protocol):
    """A way to meet the conditions."""

    def quadrature(self, problem: Problem, discretization: Discretization) -> Discretization:
        """Discretization with the number of quadrature points that the background is prepared with."""
        ...

    def structure(self, problem: Problem, discretization: Discretization, grid: Grid) -> Structure:
        """Structure of a problem: all that is needed to evaluate stored splines."""
        ...

    def setting(self, problem: Problem, discretization: Discretization, background: Background) -> Setting:
        """All that assembly needs."""
        ...


@dataclass(frozen=True)
class Natural:
    """Essential conditions by structure, the others through the functional."""

    def quadrature(self, problem: Problem, discretization: Discretization) -> Discretization:
        """What the basis asks for."""
        return discretization

    def structure(self, problem: Problem, discretization: Discretization, grid: Grid) -> Structure:
        """Structure of the essential conditions, with the singular functions of corners."""
        essential = seamless_structure(problem, discretization, grid)
        return with_corners(essential, corner_space(problem, discretization, grid))

    def setting(self, problem: Problem, discretization: Discretization, background: Background) -> Setting:
        """One space for all components, one of corners; one region, apart from the ends of pieces and from corners."""
        structure = seamless_structure(problem, discretization, background.grid)
        corners = corner_space(problem, discretization, background.grid)
        if corners is not None:
            return cornered(with_corners(structure, corners), background, corners)
        points = collar_points(discretization.degree)
        regions = regions_at_ends(problem, structure, cut_at_ends(problem, background, points), points)
        return Setting(structure, (background.space,) * len(structure), regions)


MODES: dict[str, Mode] = {"natural": Natural(), "exact": Exact()}
"""The modes by name."""


def mode_of(discretization: Discretization) -> Mode:
    """Mode of a discretisation.

    Raises
    ------
    DiscretizationError
        There is no such mode.
    """
    if discretization.conditions not in MODES:
        raise DiscretizationError(
            f"unknown conditions {discretization.conditions!r}: choose one of {', '.join(MODES)}"
        )
    return MODES[discretization.conditions]
