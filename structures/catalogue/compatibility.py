"""Which conditions can hold together, and how many an equation needs.

A condition of order k determines k-th normal derivatives of components of u (:attr:`Condition.rows`).  On one
part of the boundary no derivative may be determined twice, and an equation of order 2m takes m conditions for
each component: one of order 0 or 1 (second order); for a plate clamped (0, 1), simply supported (0, 2),
guided (1, 3) or free (2, 3). Deflection and shear, or slope and moment, work on each other (they are
conjugate: orders k and 2m - 1 - k) and cannot both be given.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from rfm.errors import StructureError
from rfm.geometry.part import Part
from structures.catalogue.condition import Condition

Prescribed = tuple[Part, Sequence[Condition]]

KINDS = {
    frozenset({0, 1}): "clamped",
    frozenset({0, 2}): "simply supported",
    frozenset({1, 3}): "guided",
    frozenset({2, 3}): "free",
}
REMEDY = (
    "clamped (value, flux), simply supported (value, bending moment), guided (flux, Kirchhoff shear) or free "
    "(bending moment, Kirchhoff shear)"
)


def check(prescribed: Sequence[Prescribed], equation_order: int) -> None:
    """Refuse conditions that cannot hold together, and too few of them.

    Parameters
    ----------
    prescribed
        Parts with their conditions.
    equation_order
        2 or 4.

    Raises
    ------
    StructureError
        With the remedy.
    """
    for part, conditions in prescribed:
        _refuse_conflicts(part, conditions, equation_order)
        _refuse_too_few(part, conditions, equation_order)
    for (part, conditions), (other, more) in combinations(prescribed, 2):
        shared = _shared(part, other)
        if shared:
            names = describe(conditions), describe(more)
            raise StructureError(
                f"{shared} carries conditions twice: {names[0]} (in {part.name}) and {names[1]} (in {other.name}); "
                "keep one of them, or separate the two with 'where'"
            )


def describe(conditions: Sequence[Condition]) -> str:
    """Return what conditions together are called."""
    names = " and ".join(condition.name for condition in conditions)
    kind = KINDS.get(frozenset(condition.order for condition in conditions))
    return f"{kind} ({names})" if kind else names


def _refuse_conflicts(part: Part, conditions: Sequence[Condition], equation_order: int) -> None:
    for one, two in combinations(conditions, 2):
        twice = one.rows & two.rows
        mixed = any(c < 0 for _, c in one.rows | two.rows) and one.order == two.order
        full = mixed and len(one.rows) + len(two.rows) > one.components
        if twice or full:
            raise StructureError(
                f"{part.name}: {one.name} and {two.name} both determine the same derivative; keep one of them"
            )
        if one.order + two.order == equation_order - 1 and _same_component(one, two):
            meant = f": on a plate edge choose {REMEDY}" if equation_order == 4 else ""
            raise StructureError(
                f"{part.name}: {one.name} and {two.name} cannot hold together for an equation of order "
                f"{equation_order} (one is the reaction to the other){meant}; keep one of them"
            )


def _same_component(one: Condition, two: Condition) -> bool:
    """Tell whether both act in one direction; a normal or tangential one (c < 0) overlaps with every fixed one."""
    first, second = {c for _, c in one.rows}, {c for _, c in two.rows}
    return bool(first & second) or (min(first) < 0) != (min(second) < 0)


def _refuse_too_few(part: Part, conditions: Sequence[Condition], equation_order: int) -> None:
    needed = equation_order // 2
    if not conditions:
        raise StructureError(f"{part.name} carries no condition; give one or leave the part out")
    if len(conditions) < needed:
        missing = describe(conditions)
        raise StructureError(
            f"{part.name} carries {missing} only, an equation of order {equation_order} needs {needed} conditions: "
            f"make the edge {REMEDY}"
        )
    if equation_order == 2 and any(condition.order > 1 for condition in conditions):
        high = next(condition.name for condition in conditions if condition.order > 1)
        raise StructureError(
            f"{part.name}: {high} needs an equation of fourth order; a second-order equation takes value or flux"
        )


def _shared(part: Part, other: Part) -> str | None:
    """Return a surface that two parts both cover whole."""
    for piece in part.pieces:
        for more in other.pieces:
            common = piece.surfaces & more.surfaces
            if common and (piece.where is None or more.where is None or piece.where is more.where):
                return min(common, key=lambda surface: surface.label).name or part.name
    return None
