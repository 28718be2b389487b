"""Arrays of the boxes of a grid, of the same shapes for all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.device.cells import GroupPlan, Groups
from solvers.device.extension import attached, by_length, extension_arrays, sizes_of
from solvers.device.halo import Halo, Local, Requests, links_of, places_of, sent
from solvers.device.places import Occupied, places, repeats
from solvers.device.plan import Plan
from solvers.device.team import Team

Arrays = dict[str, Any]


@dataclass(frozen=True)
class Sizes:
    """Lengths of arrays that differ from box to box, as large as in any of them.

    Attributes
    ----------
    cells
        Cells of each group.
    several
        How often a cell occurs, and how many occur more than once.
    outer
        Dependent coefficients.
    attached, returned
        Rows of each length of the extension, and of sums that come from other boxes.
    """

    cells: Mapping[GroupPlan, int]
    several: tuple[int, int]
    outer: int
    attached: Mapping[int, int]
    returned: Mapping[int, int]

    @staticmethod
    def largest(sizes: Iterable[Sizes]) -> Sizes:
        """Each number as large as in any of some sizes."""
        every = list(sizes)
        return Sizes(
            _largest(one.cells for one in every),
            (max(one.several[0] for one in every), max(one.several[1] for one in every)),
            max(one.outer for one in every),
            _largest(one.attached for one in every),
            _largest(one.returned for one in every),
        )


class Layout:
    """Boxes of this process.

    Parameters
    ----------
    groups
        The cells; given up.
    team
        The processes, each with as many boxes as any other.
    """

    def __init__(self, groups: Groups, team: Team) -> None:
        self.halo, self._groups = Halo(groups.space, groups.blocks), groups
        each = groups.blocks.count // team.count
        self.boxes = range(team.index * each, (team.index + 1) * each)
        self._locals = [self.halo.local(box) for box in self.boxes]
        own = {
            box: self.halo.requests(box, local) for box, local in zip(self.boxes, self._locals, strict=True)
        }
        self._requests: Requests = {k: v for found in team.gather(own) for k, v in found.items()}
        self._links = links_of(self._requests, groups.blocks.count)
        self.held = max(map(len, self.halo.own))
        self._count = self.held + sum(link.length for link in self._links)
        mine = Sizes.largest(map(self._sizes, self.boxes, self._locals))
        self._largest = Sizes.largest(team.gather(mine))
        plans = tuple(sorted(self._largest.cells, key=repr))
        self.plan = Plan(groups.space.degree, self.halo.shape, groups.components, plans, self._links)

    def arrays(self, kind: str, place: Callable[[list[Any]], Any]) -> Arrays:
        """Arrays for a kind of device, after `place` has put those of the boxes of this process where they belong.

        Groups are placed one after the other, and given up here, so that few are held twice.
        """
        sizes, groups = self._largest, []
        occupied: list[list[Occupied]] = [[] for _ in self.boxes]
        for plan in self.plan.groups:
            most = sizes.cells[plan]
            made = [self._groups.arrays(plan, box, most, kind) for box in self.boxes]
            self._groups.drop(plan)
            for found, group in zip(occupied, made, strict=True):
                found.append(Occupied.of(group["chunks"]))
            groups.append(place(made))
        return {
            "extension": place([self._extension(*one) for one in zip(self.boxes, self._locals, strict=True)]),
            "links": place([self._exchanges(box) for box in self.boxes]),
            "groups": groups,
            "places": place([places(self.plan, found, sizes.several) for found in occupied]),
        }

    def _sizes(self, box: int, local: Local) -> Sizes:
        cells = self._groups.cells(box)
        return Sizes(
            {plan: len(found) for plan, found in cells.items()},
            repeats(np.concatenate(list(cells.values()))) if cells else (1, 0),
            len(local.outer),
            sizes_of(attached(local, self._place(box))[0]),
            sizes_of(self._returned(box)[0]),
        )

    def _extension(self, box: int, local: Local) -> Arrays:
        sizes = self._largest
        return extension_arrays(local, self._place(box), self._count, sizes.outer, sizes.attached)

    def _exchanges(self, box: int) -> Arrays:
        rows, columns = self._returned(box)
        sends = [sent(self.halo, box, self._requests, link) for link in self._links]
        return {
            "send": [
                np.pad(which, (0, link.length - len(which)))
                for which, link in zip(sends, self._links, strict=True)
            ],
            "back": by_length(rows, columns, np.ones(len(rows)), self.held, self._largest.returned),
        }

    def _place(self, box: int) -> NDArray[np.int32]:
        return places_of(self.halo, box, self._requests, self._links, self.held)

    def _returned(self, box: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Unknowns of a box for which others have sums, and where these are in the list of what comes back."""
        rows, columns, start = [np.zeros(0, np.int32)], [np.zeros(0, np.int32)], 0
        for link in self._links:
            which = sent(self.halo, box, self._requests, link)
            rows.append(which)
            columns.append(start + np.arange(len(which), dtype=np.int32))
            start += link.length
        return np.concatenate(rows), np.concatenate(columns)


def _largest(sizes: Iterable[Mapping[Any, int]]) -> dict[Any, int]:
    """Largest number of each key."""
    found: dict[Any, int] = {}
    for one in sizes:
        for key, size in one.items():
            found[key] = max(size, found.get(key, 0))
    return found
