"""Structures of problems with periodic conditions: how much room there is around the seam.

A structure passes from one period to the next in a strip around the seam (:mod:`structures.seam`), the wider the
better.  In front of the face B the structure of behind A, moved, must satisfy the essential conditions too, and the
other way round; the nearest point of the boundary at which it does not, a hole that has no image or data that are not
periodic, ends the strip.  Strips end on grid lines: the step is smooth inside cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import StructureError
from solvers.essential import essential_structure, prescribed
from solvers.grid import Grid
from solvers.periodicity import AXES, Period, periods_of
from solvers.problem import Discretization, Problem, Slip
from structures.contact import boundary_points, spread_points
from structures.jet_matrix import evaluate_all
from structures.operator import Operator
from structures.seam import Seam, across

SEEDS = 1024
"""Points on each essential part, and in the domain, at which images are compared."""
AGREE = 1e-9
"""Size of a weight, relative to its largest, and of a difference of data that count as zero."""


class _Place(NamedTuple):
    """Points (n, d) at which the structure of a component is compared with its images."""

    component: int
    points: Array
    order: int
    essential: bool


def seamless_structure(problem: Problem, discretization: Discretization, grid: Grid) -> tuple[Operator, ...]:
    """Structure of the essential conditions, continued over the seams of the splines where these are periodic.

    Raises
    ------
    StructureError
        The essential conditions next to the seam are not periodic, or have no such structure.
    """
    periods = periods_of(problem)
    if periods and any(isinstance(condition, Slip) for condition in problem.conditions):
        raise StructureError(
            "a slip condition has no periodic structure: prescribe components, or drop the period"
        )
    structure = essential_structure(problem, discretization.weight)
    return closed(problem, structure, grid, discretization.degree)


def closed(
    problem: Problem, structure: tuple[Operator, ...], grid: Grid, degree: int, apart: Array | None = None
) -> tuple[Operator, ...]:
    """Return a structure of the essential conditions continued over the seams of a problem.

    Parameters
    ----------
    problem, structure
        The conditions, and what satisfies them inside one period.
    grid, degree
        Of the splines.
    apart
        Further points (n, d) that the strips around the seams must not reach.

    Raises
    ------
    StructureError
        The essential conditions next to a seam are not periodic.
    """
    for period in periods_of(problem):
        structure = _closed(problem, structure, period, grid, degree, apart)
    return structure


def _closed(
    problem: Problem,
    structure: tuple[Operator, ...],
    period: Period,
    grid: Grid,
    degree: int,
    apart: Array | None,
) -> tuple[Operator, ...]:
    places = list(_places(problem, len(structure)))
    scale = [_scale(structure[c], places, c) for c in range(len(structure))]
    length, spacing = period.upper - period.lower, float(grid.spacing[period.axis])
    room, same = [], True
    for sign in (-1.0, 1.0):  # images of what lies behind A, in front of B, and the other way round
        nearest, at = 0.5 * length, None
        edge = period.upper if sign < 0 else period.lower
        if apart is not None and len(apart):
            gap = np.abs(apart[:, period.axis] - edge)
            nearest, at = min(nearest, float(gap.min())), apart[int(np.argmin(gap))]
        for place in places:
            wrong, differs = _compared(structure, place, period, sign * length, scale)
            same = same and not differs.any()
            gap = np.abs(place.points[:, period.axis] - edge)
            gap = np.where(wrong, gap, np.inf)
            if len(gap) and gap.min() < nearest:
                nearest, at = float(gap.min()), place.points[int(np.argmin(gap))]
        cells = int(np.floor(nearest / spacing + 1e-9 - (0.0 if at is None else 0.5)))
        room.append((max(0, cells) * spacing, at))
    if same:
        return structure
    (before, first), (behind, second) = room
    if before + behind < 1.5 * spacing:
        point = next(at for at in (first, second) if at is not None)
        where = "(" + ", ".join(f"{x:.4g}" for x in point) + ")"
        raise StructureError(
            f"the essential conditions are not periodic along {AXES[period.axis]}: what holds at {where}, near the "
            f"seam of {period.names[0]} and {period.names[1]}, does not go on behind it; make data and walls repeat "
            "there, or refine `grid` if that is a hole beside the seam"
        )
    seam = Seam(period.axis, period.lower, period.upper, before, behind, degree + 1)
    return tuple(across(u, seam, period.factor) for u in structure)


def _places(problem: Problem, components: int) -> Sequence[_Place]:
    domain, found = problem.domain, []
    inside = spread_points(domain, SEEDS)
    inside = inside[np.asarray(domain.membership(*inside.T)) > 0]
    seeds = spread_points(domain, SEEDS)
    for c in range(components):
        found.append(_Place(c, inside, 0, False))
        for piece in prescribed(problem, c, components):
            points = boundary_points(domain, piece.part, seeds)
            found.append(_Place(c, points, 0 if piece.slope is None else 1, True))
    return found


def _scale(u: Operator, places: Sequence[_Place], component: int) -> tuple[float, float]:
    """Largest coefficient of psi and largest datum."""
    inside = next(place for place in places if place.component == component)
    jet = evaluate_all([u], tuple(inside.points.T), 0)[0]
    weights = [np.abs(values).max() for entries in jet.entries.values() for values in entries.values()]
    return float(max(weights, default=1.0)), max(1.0, float(np.abs(jet.offset).max()))


def _compared(
    structure: tuple[Operator, ...],
    place: _Place,
    period: Period,
    distance: float,
    scale: Sequence[tuple[float, float]],
) -> tuple[Array, Array]:
    """At which points the image of the structure will not do, and at which it is another than the structure.

    On an essential part its coefficients must vanish and its offset must be the datum; in the domain the coefficient of
    psi must have the sign that it has.
    """
    u, (heaviest, largest) = structure[place.component], scale[place.component]
    moved = place.points.copy()
    moved[:, period.axis] += distance
    with np.errstate(all="ignore"):
        here, there = (evaluate_all([u], tuple(p.T), place.order)[0] for p in (place.points, moved))
        gap = np.abs(period.factor * there.offset - here.offset).max(axis=0) > AGREE * largest
        differs, wrong = gap.copy(), gap & place.essential
        for key, image in there.entries.get(place.component, {}).items():
            own = here.entries[place.component][key]
            differs |= ~(np.abs(image - own) <= AGREE * heaviest)
            wrong |= ~(np.abs(image) <= AGREE * heaviest) if place.essential else ~(image * own > 0)
    return wrong, differs
