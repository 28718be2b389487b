"""What is to be assembled: solution structure, spline spaces, and the regions of the domain with a rule each."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.background import Background
from solvers.bases.basis import Space
from structures.operator import Operator

Structure = tuple[Operator, ...]


@dataclass(frozen=True)
class Region:
    """A structure, and the rules of the cells in which it holds."""

    structure: Structure
    background: Background


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
    """

    structure: Structure
    spaces: tuple[Space, ...]
    regions: tuple[Region, ...]

    @property
    def overlapping(self) -> bool:
        """Whether several splines make up one component, so that they may nearly depend on each other."""
        return len(self.spaces) > len(self.structure)
