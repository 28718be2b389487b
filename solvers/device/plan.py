"""What a compiled product depends on besides its arrays."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.device.cells import GroupPlan
from solvers.device.halo import Link


@dataclass(frozen=True)
class Plan:
    """Everything that the compiled programs depend on but the arrays.

    Attributes
    ----------
    degree, shape
        Degree p and full shape of a component's coefficients in a box.
    components
        Splines M of the same space.
    groups
        Groups of cells.
    links
        What boxes exchange.
    """

    degree: int
    shape: tuple[int, ...]
    components: int
    groups: tuple[GroupPlan, ...]
    links: tuple[Link, ...]

    @property
    def local(self) -> tuple[int, ...]:
        """Shape of the coefficients of a cell."""
        return (self.degree + 1,) * len(self.shape)
