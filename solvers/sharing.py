"""Which cells a process integrates over, and how what processes know of their cells is put together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rfm.calculus.types import Array
from solvers.classify import Classification
from solvers.device.backend import NONE
from solvers.device.blocks import Blocks, divided
from solvers.device.team import Alone, Team
from solvers.grid import Integers
from solvers.problem import SolverOptions


@dataclass(frozen=True)
class Sharing:
    """Boxes of cells and the processes that have them, each as many as any other.

    Attributes
    ----------
    team
        The processes.
    blocks
        The boxes; None when nothing is cut.
    """

    team: Team
    blocks: Blocks | None = None

    def own(self, classification: Classification) -> Classification:
        """Classification in which the cells of other processes count as outer ones."""
        if self.blocks is None or self.team.count == 1:
            return classification
        each = self.blocks.count // self.team.count
        mine = np.zeros(classification.state.shape, dtype=bool)
        for box in range(self.team.index * each, (self.team.index + 1) * each):
            mine[tuple(slice(low, high) for low, high in self.blocks.box(box))] = True
        return classification.within(mine)

    def total(self, numbers: ArrayLike) -> Array:
        """Sum over the processes of a few numbers; scalars and vectors of zeros count as one shape."""
        return reduce(np.add, self.team.gather(np.asarray(numbers)))

    def largest(self, numbers: Mapping[str, float]) -> dict[str, float]:
        """Largest number of any process by name."""
        found: dict[str, float] = {}
        for one in self.team.gather(dict(numbers)):
            for name, value in one.items():
                found[name] = max(value, found.get(name, value))
        return found

    def all_cells(self, cells: Integers) -> NDArray[np.int64]:
        """Cells (n, d) of all processes."""
        return np.concatenate(self.team.gather(cells))


WHOLE = Sharing(Alone())
"""One process, one box."""


def shared(classification: Classification, degree: int, options: SolverOptions) -> Sharing:
    """How the cells are divided among the devices that a solve may use.

    Raises
    ------
    DiscretizationError
        There are fewer layers of cells than devices.
    """
    if options.device == NONE:
        return WHOLE
    from solvers.device.processes import team_of
    from solvers.device.shards import boxes_of

    count = boxes_of(options)
    if count == 1:
        return WHOLE
    return Sharing(team_of(options.device), divided(classification.state, degree, count))
