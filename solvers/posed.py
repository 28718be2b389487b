"""Whether a problem is posed: each condition suits the equation, and no two kinds of condition hold in one place."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import StructureError
from rfm.geometry.part import Part
from rfm.geometry.surface import Surface
from solvers.data import values
from solvers.problem import Oblique, Periodic, Problem
from structures.catalogue.traces import boundary_frame
from structures.contact import boundary_points

TANGENTIAL = 1e-6
"""Cosine between a direction and the normal that counts as zero."""
BETWEEN = 0.2
"""The same where its sign changes, so that it vanishes at a point between the samples."""


def require_posed(problem: Problem) -> None:
    """Refuse conditions that do not suit the equation or each other.

    Raises
    ------
    StructureError
        An equation has no such condition, a surface carries two kinds, an edge of a plate has none, or the direction of
        an oblique derivative is tangential.
    """
    equation = problem.equation
    names = ", ".join(kind.__name__ for kind in equation.conditions)
    for condition in problem.conditions:
        if not isinstance(condition, (*equation.conditions, Periodic)):
            two = " needs two conditions at every point of its boundary and" if equation.order > 1 else ""
            raise StructureError(
                f"the equation {equation.name}{two} has no condition {type(condition).__name__} (on "
                f"{condition.part.name}); its conditions are: {names}"
            )
    for first, second in combinations(problem.conditions, 2):
        shared = first.part.surfaces & second.part.surfaces
        if (
            type(first) is not type(second)
            and shared
            and first.part.where is None
            and second.part.where is None
        ):
            raise StructureError(
                f"{_named(shared)} carries both {type(first).__name__} (in {first.part.name}) and "
                f"{type(second).__name__} (in {second.part.name}): keep one, or separate them with 'where'"
            )
    taken = frozenset[Surface]().union(*(condition.part.surfaces for condition in problem.conditions))
    taken |= frozenset[Surface]().union(
        *(c.partner.surfaces for c in problem.conditions if isinstance(c, Periodic))
    )
    bare = problem.domain.part("all").surfaces - taken
    if equation.order > 1 and bare:
        raise StructureError(
            f"{_named(bare)} has no condition, and the equation {equation.name} is of fourth order: give each edge "
            f"one of {names}"
        )
    for condition in problem.conditions:
        if isinstance(condition, Oblique):
            require_transversal(problem, condition)


def require_transversal(problem: Problem, condition: Oblique) -> None:
    """Refuse a direction of an oblique derivative that is zero or tangential somewhere, at sample points of its part.

    A direction that points out of the domain at some points of a surface and into it at others is tangential between
    them; that is noticed where the points are close enough.

    Raises
    ------
    StructureError
        It has the wrong length, or is zero or tangential at a point.
    """
    domain, name = problem.domain, condition.part.name
    if len(condition.direction) != domain.dimension:
        raise StructureError(
            f"the direction of the oblique derivative on {name} has {len(condition.direction)} components, the domain "
            f"{domain.dimension} dimensions: give one for each"
        )
    for member in condition.part.pieces:
        for surface in sorted(member.surfaces, key=lambda s: s.label):
            piece = Part(member.name, frozenset([surface]), member.where)
            points = boundary_points(domain, piece).T
            if not points.size:
                continue
            normals = boundary_frame(domain, piece, points)[0]
            direction = np.stack(
                [
                    np.broadcast_to(values(f"direction[{i}]", b, list(points)), points.shape[1:])
                    for i, b in enumerate(condition.direction)
                ]
            )
            length = np.sqrt((direction**2).sum(axis=0))
            across = (direction * normals).sum(axis=0) / np.where(length > 0, length, 1.0)
            if (length == 0).any():
                raise StructureError(
                    _at(name, "zero", points[:, np.argmin(length)], "give one with a length")
                )
            worst = int(np.argmin(np.abs(across)))
            turns = across.min() < 0 < across.max() and abs(across[worst]) < BETWEEN
            if turns or abs(across[worst]) < TANGENTIAL:
                raise StructureError(
                    _at(name, "tangential", points[:, worst], "turn it, or prescribe a value there instead")
                )


def _at(name: str, what: str, point: Array, remedy: str) -> str:
    where = ", ".join(f"{x:.4g}" for x in point)
    return f"the direction of the oblique derivative on {name} is {what} near ({where}): {remedy}"


def _named(surfaces: frozenset[Surface]) -> str:
    return ", ".join(sorted(".".join(surface.label) for surface in surfaces))
