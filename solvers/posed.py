"""Whether a problem is posed: each condition suits the equation, and no two kinds of condition hold in one place."""

from __future__ import annotations

from itertools import combinations

from rfm.errors import StructureError
from rfm.geometry.surface import Surface
from solvers.problem import Periodic, Problem


def require_posed(problem: Problem) -> None:
    """Refuse conditions that do not suit the equation or each other.

    Raises
    ------
    StructureError
        An equation has no such condition, a surface carries two kinds, or an edge of a plate has none.
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


def _named(surfaces: frozenset[Surface]) -> str:
    return ", ".join(sorted(".".join(surface.label) for surface in surfaces))
