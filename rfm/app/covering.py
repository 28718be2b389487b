"""Which condition holds where: every point of the boundary must belong to exactly one.

Conditions name parts of the boundary; a part with a ``where`` claims only the piece on which it holds;
``rest`` takes what no other condition claims.  Claims of whole surfaces are compared by name, claims of
pieces at points of a coarse boundary rule.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from rfm.app.case import Case
from rfm.app.yaml_reader import Path
from rfm.calculus.types import Array
from rfm.errors import RfmError
from rfm.geometry.box import Box
from rfm.geometry.part import Part, union

if TYPE_CHECKING:
    from rfm.geometry.shape import Shape
    from rfm.geometry.surface import Surface

COARSE_GRID = {2: 24, 3: 10}
"""Cells along the longest side of the box on which claims of pieces are compared."""

NAMED = 8
"""Parts listed in a message."""


def assign_parts(case: Case, domain: Shape) -> tuple[Part, ...]:
    """Part of the boundary for each condition of the case, in their order.

    Raises
    ------
    CaseError
        A part is unknown, two conditions overlap, or some part has no condition; the message names the
        parts and the remedy.
    """
    claimed = {
        i: _claim(case, domain, i) for i in range(len(case.boundary_conditions)) if not _is_rest(case, i)
    }
    _refuse_shared_surfaces(case, claimed)
    rest = [i for i in range(len(case.boundary_conditions)) if _is_rest(case, i)]
    for extra in rest[1:]:
        raise case.error(
            ("boundary_conditions", extra, "on"), "'rest' is already taken by an earlier condition"
        )
    left = reduce(
        lambda whole, part: whole - part, [_filled(case, claimed), *claimed.values()], domain.part("all")
    )
    _refuse_bare_surfaces(case, left, rest)
    pieces = _claims_of_pieces(claimed)
    if pieces:
        _compare_at_points(case, domain, claimed, pieces, bool(rest))
    if rest:
        claimed[rest[0]] = replace(left, name="rest")
    return tuple(claimed[i] for i in range(len(case.boundary_conditions)))


def _is_rest(case: Case, index: int) -> bool:
    return "rest" in case.boundary_conditions[index].on


def _claim(case: Case, domain: Shape, index: int) -> Part:
    """Part that a condition names, restricted to the piece where its comparison holds."""
    condition = case.boundary_conditions[index]
    parts = [_part(case, domain, ("boundary_conditions", index, "on"), name) for name in condition.on]
    if condition.periodic is not None:
        parts += _partners(case, domain, index, condition.periodic.partners, parts)
    part = reduce(lambda first, second: first | second, parts)
    if condition.where is None:
        return part
    where = condition.where.condition(case.dimension, ("boundary_conditions", index, "where"))
    return part.restricted(where, f"{part.name} where {condition.where.text}")


def _part(case: Case, domain: Shape, path: Path, name: str) -> Part:
    try:
        return domain.part(name)
    except RfmError as error:
        raise case.error(path, str(error)) from error


def _partners(
    case: Case, domain: Shape, index: int, names: Sequence[str], parts: Sequence[Part]
) -> list[Part]:
    """Parts on the other side of a periodic condition."""
    path: Path = ("boundary_conditions", index, "periodic", "with")
    partners = [_part(case, domain, path, name) for name in names]
    shared = union(parts).surfaces & union(partners).surfaces
    if shared:
        raise case.error(path, f"{_listed(sorted(s.name for s in shared))} cannot be its own partner")
    return partners


def _filled(case: Case, claimed: Mapping[int, Part]) -> Part:
    """Surfaces that conditions without ``where`` take as a whole, possibly side by side (collinear edges)."""
    plain = union([part for i, part in claimed.items() if case.boundary_conditions[i].where is None])
    return Part(
        "taken", frozenset().union(*(piece.surfaces for piece in plain.pieces if piece.where is None))
    )


def _refuse_shared_surfaces(case: Case, claimed: Mapping[int, Part]) -> None:
    """Refuse two conditions of which one claims the whole of a surface that the other claims too."""
    whole: dict[Surface, int] = {}
    for i, part in claimed.items():
        for piece in part.pieces:
            whole.update(
                {surface: i for surface in piece.surfaces if piece.where is None and surface not in whole}
            )
    for i, part in claimed.items():
        shared = sorted(surface.name for surface in part.surfaces if whole.get(surface, i) != i)
        if shared:
            other = next(whole[surface] for surface in part.surfaces if whole.get(surface, i) != i)
            first, second = sorted((i, other))
            remedy = "give the one that is to take what is left `on: rest`, or name different parts"
            raise case.error(
                ("boundary_conditions", second, "on"),
                f"conditions {first} and {second} overlap on {_listed(shared)}; {remedy}",
            )


def _refuse_bare_surfaces(case: Case, left: Part, rest: Sequence[int]) -> None:
    """Refuse whole surfaces without a condition, and a `rest` for which nothing is left."""
    if rest and not left.surfaces:
        message = "nothing is left for 'rest': the other conditions take the whole boundary; remove this one"
        raise case.error(("boundary_conditions", rest[0], "on"), message)
    bare = sorted(name for piece in left.pieces if piece.where is None for name in _names(piece.surfaces))
    if bare and not rest:
        message = f"no condition on {_listed(bare)}; add one for it, or for `on: rest`"
        raise case.error(("boundary_conditions",), message, key=True)


def _claims_of_pieces(claimed: Mapping[int, Part]) -> dict[Surface, list[int]]:
    """Conditions that claim only pieces of a surface."""
    found: dict[Surface, list[int]] = {}
    for i, part in claimed.items():
        for piece in part.pieces:
            for surface in piece.surfaces if piece.where is not None else ():
                found.setdefault(surface, []).append(i)
    return found


def _compare_at_points(
    case: Case, domain: Shape, claimed: Mapping[int, Part], pieces: Mapping[Surface, list[int]], rest: bool
) -> None:
    """Count the conditions at points of the surfaces of which pieces are claimed."""
    somewhere: set[int] = set()
    given = None if case.discretization.box is None else Box(*case.discretization.box)
    for surface, points in boundary_points(domain, given).items():
        conditions = pieces.get(surface)
        if not conditions:
            continue
        holds = {i: _on_surface(claimed[i], surface, points) for i in conditions}
        somewhere |= {i for i, held in holds.items() if held.any()}
        count = np.sum(list(holds.values()), axis=0)
        if (count > 1).any():
            at = int(np.argmax(count > 1))
            first, second = [i for i in conditions if holds[i][at]][:2]
            message = f"conditions {first} and {second} overlap on {surface.name} at {_shown(points[at])}"
            raise case.error(
                ("boundary_conditions", second), f"{message}; let their `where` exclude each other"
            )
        if (count == 0).any() and not rest:
            at = int(np.argmax(count == 0))
            message = f"no condition on {surface.name} at {_shown(points[at])}; add one for `on: rest`"
            raise case.error(("boundary_conditions",), message, key=True)
    for i in sorted({i for conditions in pieces.values() for i in conditions} - somewhere):
        message = f"the condition holds nowhere on {claimed[i].name.split(' where ')[0]}"
        raise case.error(("boundary_conditions", i, "where"), message)


def _on_surface(part: Part, surface: Surface, points: Array) -> Array:
    """Which points of a surface belong to a part."""
    held = np.zeros(len(points), dtype=bool)
    for piece in part.pieces:
        if surface in piece.surfaces:
            held |= piece.selects(points)
    return held


def boundary_points(domain: Shape, box: Box | None = None) -> dict[Surface, Array]:
    """Points (n, d) on each surface of the boundary, from a coarse quadrature rule on the box (of the domain)."""
    from solvers.classify import classify
    from solvers.grid import Grid
    from solvers.quadrature import domain_rules

    grid = Grid.cover(box or domain.box, COARSE_GRID[domain.dimension])
    rules = domain_rules(domain, classify(domain, grid), inner=1, cut=2)
    return {
        surface: np.stack([np.ravel(axis) for axis in batch.points(grid)], axis=1)
        for surface, batch in rules.boundary.items()
    }


def _names(surfaces: frozenset[Surface]) -> list[str]:
    return [".".join(label) for surface in surfaces for label in surface.labels]


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more


def _shown(point: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in point) + ")"
