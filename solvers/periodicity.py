"""Periodic conditions of a problem: the period along each axis, the grid that fits it, and what is refused.

Periodic splines (:mod:`solvers.wrapping`) want the parts A and B on opposite faces of the grid, across a coordinate
axis, and a whole number of cells between them.  Whether the parts are such is looked at in points spread over them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError, StructureError
from rfm.geometry.box import Box
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from solvers.problem import Discretization, Periodic, Problem
from solvers.wrapping import Wraps
from structures.contact import boundary_points, size_of, spread_points

AXES = "xyz"
SAME = 1e-9
"""Distance, relative to the size of the domain, within which points coincide."""


@dataclass(frozen=True)
class Period:
    """A domain that repeats along an axis.

    Attributes
    ----------
    axis, lower, upper
        The faces are x[axis] = lower and upper.
    factor
        c, 1 or -1.
    names
        Names of the two parts.
    """

    axis: int
    lower: float
    upper: float
    factor: float
    names: tuple[str, str]

    def moved(self, points: Array) -> Array:
        """Points (n, d) of one face on the other."""
        images = points.copy()
        images[:, self.axis] = self.lower + self.upper - points[:, self.axis]
        return images


def periods_of(problem: Problem) -> tuple[Period, ...]:
    """Return the periods of a problem, ascending by axis.

    Raises
    ------
    StructureError
        Two parts are not translates of each other along a coordinate axis, or do not bound the domain there.
    """
    found = [period_of(problem.domain, c) for c in problem.conditions if isinstance(c, Periodic)]
    axes = [period.axis for period in found]
    for axis in axes:
        if axes.count(axis) > 1:
            raise StructureError(
                f"two periodic conditions along {AXES[axis]}: name all parts of a face in one condition"
            )
    return tuple(sorted(found, key=lambda period: period.axis))


def wraps_of(periods: Sequence[Period]) -> Wraps:
    """Factor by axis, for the splines."""
    return {period.axis: period.factor for period in periods}


def fitted(discretization: Discretization, domain: Shape, periods: Sequence[Period]) -> Discretization:
    """Return the discretisation with a box that ends at the faces of the periods.

    Raises
    ------
    DiscretizationError
        The box that was given reaches further, or the spacing does not divide a period.
    """
    if not periods:
        return discretization
    given, box = discretization.box, discretization.box or domain.box
    lower, upper = list(box.lower), list(box.upper)
    for period in periods:
        axis, length = period.axis, period.upper - period.lower
        ends = (lower[axis], upper[axis])
        if (
            given is not None
            and max(abs(ends[0] - period.lower), abs(ends[1] - period.upper)) > SAME * length
        ):
            raise DiscretizationError(
                f"box must end at the periodic parts, {AXES[axis]} = {period.lower:.6g} and {period.upper:.6g}, got "
                f"{ends[0]:.6g} and {ends[1]:.6g}; leave it out"
            )
        lower[axis], upper[axis] = period.lower, period.upper
        if discretization.spacing is not None:
            cells = max(1, round(length / discretization.spacing))
            if abs(cells * discretization.spacing - length) > SAME * length:
                raise DiscretizationError(
                    f"spacing must divide the period {length:.6g} along {AXES[axis]}, got "
                    f"{discretization.spacing:.6g}; use {length / cells:.10g} or `grid`"
                )
    return replace(discretization, box=Box(tuple(lower), tuple(upper)))


def period_of(domain: Shape, condition: Periodic) -> Period:
    """Return the period of one condition.

    Raises
    ------
    StructureError
        See :func:`periods_of`.
    """
    first, second = condition.part, condition.partner
    if abs(condition.factor) != 1.0:
        raise StructureError(f"factor must be 1 or -1, got {condition.factor:g}")
    for part in (first, second):
        if any(piece.where is not None for piece in part.pieces):
            raise StructureError(f"a periodic condition holds on whole parts: {part.name} is a piece of one")
    here, there = (boundary_points(domain, part) for part in (first, second))
    axis = _common_axis(domain, (first, here), (second, there))
    period = np.zeros(domain.dimension)
    period[axis] = there[0, axis] - here[0, axis]
    if condition.shift is not None and np.abs(np.subtract(condition.shift, period)).max() > SAME * size_of(
        domain
    ):
        raise StructureError(
            f"shift must be {_shown(period)}, the way from {first.name} to {second.name}, got "
            f"{_shown(np.array(condition.shift))}"
        )
    _require_translates(domain, (first, here), (second, there), period)
    _require_translates(domain, (second, there), (first, here), -period)
    lower, upper = sorted((float(here[0, axis]), float(there[0, axis])))
    ends = (domain.box.lower[axis], domain.box.upper[axis])  # the same up to rounding, if the box is tight
    lower, upper = (
        end + 0.0 if abs(end - found) <= SAME * size_of(domain) else found
        for end, found in zip(ends, (lower, upper), strict=True)
    )
    _require_faces(domain, (first, second), axis, lower, upper)
    return Period(axis, lower, upper, float(condition.factor), (first.name, second.name))


def _common_axis(domain: Shape, first: tuple[Part, Array], second: tuple[Part, Array]) -> int:
    """Axis across which both parts lie."""
    flat = []
    for part, points in (first, second):
        if not len(points):
            raise StructureError(f"no point of the boundary was found on {part.name}")
        flat.append(np.ptp(points, axis=0) <= SAME * size_of(domain))
        if not flat[-1].any():
            raise StructureError(
                f"periodic conditions need flat parts across a coordinate axis: {part.name} is not; turn the domain "
                "so that the period runs along an axis"
            )
    common = np.flatnonzero(flat[0] & flat[1])
    apart = [k for k in common if abs(second[1][0, k] - first[1][0, k]) > SAME * size_of(domain)]
    if not apart:
        raise StructureError(
            f"{first[0].name} and {second[0].name} do not face each other along a coordinate axis: a period must run "
            "along one, from a part across it to another"
        )
    return int(apart[0])


def _require_translates(
    domain: Shape, first: tuple[Part, Array], second: tuple[Part, Array], period: Array
) -> None:
    """Every point of the one part is a point of the other, one period further."""
    points = first[1] + period
    miss = np.abs(np.asarray(domain.membership(*points.T))) > SAME * size_of(domain)
    if miss.any():
        at = int(np.argmax(miss))
        raise StructureError(
            f"{first[0].name} and {second[0].name} are not translates of each other: {_shown(first[1][at])} lies on "
            f"{first[0].name}, {_shown(points[at])} not on {second[0].name}"
        )


def _require_faces(domain: Shape, parts: tuple[Part, Part], axis: int, lower: float, upper: float) -> None:
    """The domain lies between the parts, and no other part lies beside them."""
    slack = SAME * size_of(domain)
    points = spread_points(domain, 1024)
    points = points[np.asarray(domain.membership(*points.T)) > slack]
    beyond = (points[:, axis] < lower - slack) | (points[:, axis] > upper + slack)
    if beyond.any():
        raise StructureError(
            f"the domain reaches beyond {parts[0].name} and {parts[1].name}, for example to "
            f"{_shown(points[int(np.argmax(beyond))])}: periodic parts bound it along their axis"
        )
    rest = domain.part("all") - (parts[0] | parts[1])
    for surface in sorted(rest.surfaces, key=lambda s: s.label):
        points = boundary_points(domain, Part(surface.name, frozenset([surface])))
        beside = np.minimum(np.abs(points[:, axis] - lower), np.abs(points[:, axis] - upper)) < slack
        if beside.any() and beside.mean() > 0.5:
            raise StructureError(
                f"{surface.name} lies beside {parts[0].name} or {parts[1].name} on a face of the period: it belongs to "
                "the periodic condition too"
            )


def _shown(point: Array) -> str:
    return "(" + ", ".join(f"{round(float(value), 12) + 0.0:.6g}" for value in point) + ")"
