"""What is to be assembled: solution structure, spline spaces, and the regions of the domain with a rule each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from solvers.background import Background
from solvers.bases.basis import Space
from solvers.problem import Problem
from structures.operator import Operator

if TYPE_CHECKING:
    from solvers.corners.space import CornerSpace
    from solvers.materials import Side

Structure = tuple[Operator, ...]


@dataclass(frozen=True)
class Region:
    """A structure, and the rules of the cells in which it holds."""

    structure: Structure
    background: Background
    problem: Problem | None = None
    """The problem as it is there, where the material is another."""


@dataclass(frozen=True)
class Setting:
    """Structure and spaces of the unknown splines, and the regions that make up the domain.

    Attributes
    ----------
    structure
        One operator for each component of u.
    spaces
        One space for each spline; the first are those of the components, that of the background.
    regions
        Their cells and boundary rules together are those of the domain.
    sides
        The inclusions, where there are several materials; the regions are the materials and their interfaces then.
    corners
        The space of singular functions at corners, the last one, where there are such.
    """

    structure: Structure
    spaces: tuple[Space, ...]
    regions: tuple[Region, ...]
    sides: tuple[Side, ...] = ()
    corners: CornerSpace | None = None

    @property
    def overlapping(self) -> bool:
        """Whether several splines make up one component, so that they may nearly depend on each other."""
        return self.corners is None and len(self.spaces) > len(self.structure)
