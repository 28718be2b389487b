"""Parts of a boundary: sets of surfaces, possibly restricted by a condition."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from rfm.calculus.functions import absolute, maximum, minimum
from rfm.calculus.types import Array, Field, Value
from rfm.geometry.surface import Surface

_ON_CARRIER = 1e-9


@dataclass(frozen=True, eq=False)
class Part:
    """The boundary points on ``surfaces`` at which ``where`` is positive.

    Parameters
    ----------
    name
        How the part was asked for.
    surfaces
        The surfaces it lies on.
    where
        Positive where the part is; None means everywhere on the surfaces.  For a union of
        differently restricted parts it is a membership test for boundary points only.
    members
        The differently restricted parts of such a union, otherwise empty.
    """

    name: str
    surfaces: frozenset[Surface]
    where: Field | None = None
    members: tuple[Part, ...] = ()

    @property
    def pieces(self) -> tuple[Part, ...]:
        """Parts with one genuine condition each, whose union this is."""
        return self.members or (self,)

    def selects(self, points: Array) -> Array:
        """Which of the boundary points ``(n, d)``, known to lie on the surfaces, belong (booleans)."""
        if self.where is None:
            return np.ones(len(points), dtype=bool)
        return np.broadcast_to(np.asarray(self.where(*points.T)) > 0.0, len(points))

    def restricted(self, where: Field, name: str | None = None) -> Part:
        """Return the piece of the part where the field is positive."""
        return union(
            [
                replace(piece, where=where if piece.where is None else _Smallest((piece.where, where)))
                for piece in self.pieces
            ],
            name or self.name,
        )

    def __or__(self, other: Part) -> Part:
        """Union."""
        return union([self, other])

    def __sub__(self, other: Part) -> Part:
        """Return what is left without the other part."""
        rest = [remaining for piece in self.pieces for remaining in _without(piece, other)]
        return union(rest, f"{self.name} - {other.name}")


def union(parts: Iterable[Part], name: str | None = None) -> Part:
    """Union of parts; pieces that together fill their surfaces are joined into unrestricted ones."""
    given = list(parts)
    name = name if name is not None else " | ".join(part.name for part in given)
    groups: dict[int, Part] = {}
    for piece in (piece for part in given for piece in part.pieces):
        known = groups.get(id(piece.where), Part(piece.name, frozenset(), piece.where))
        groups[id(piece.where)] = replace(known, surfaces=known.surfaces | piece.surfaces)
    everywhere = groups.pop(id(None), Part(name, frozenset())).surfaces
    everywhere |= {
        surface
        for group in groups.values()
        for surface in group.surfaces
        if surface.pieces
        and all(surface in groups.get(id(p.where), _NOTHING).surfaces for p in surface.pieces)
    }
    restricted = [replace(group, surfaces=group.surfaces - everywhere) for group in groups.values()]
    pieces = tuple(part for part in (Part(name, everywhere), *restricted) if part.surfaces)
    if len(pieces) <= 1:
        return replace(pieces[0], name=name) if pieces else Part(name, frozenset())
    surfaces = frozenset[Surface]().union(*(piece.surfaces for piece in pieces))
    return Part(name, surfaces, _OnSome(pieces), pieces)


_NOTHING = Part("", frozenset())


def _without(piece: Part, other: Part) -> list[Part]:
    """What remains of a single piece: untouched surfaces, and those on which the other is restricted."""
    rest = [replace(piece, surfaces=piece.surfaces - other.surfaces)]
    for surface in sorted(piece.surfaces & other.surfaces, key=lambda shared: shared.label):
        taken = [member.where for member in other.pieces if surface in member.surfaces]
        conditions = [where for where in taken if where is not None]
        if len(conditions) < len(taken) or any(where is piece.where for where in conditions):
            continue
        alone = replace(piece, surfaces=frozenset([surface]))
        left = [p.where for p in surface.pieces if not any(p.where is where for where in conditions)]
        if piece.where is None and len(left) + len(conditions) == len(surface.pieces):
            rest.extend(replace(alone, where=where) for where in left)
        else:
            rest.append(alone.restricted(_Smallest(tuple(_Opposite(where) for where in conditions))))
    return rest


@dataclass(frozen=True)
class _Opposite:
    """Complement of a condition."""

    condition: Field

    def __call__(self, *coords: Value) -> Value:
        return -self.condition(*coords)


@dataclass(frozen=True)
class _Smallest:
    """All conditions at once."""

    conditions: tuple[Field, ...]

    def __call__(self, *coords: Value) -> Value:
        return reduce(minimum, [condition(*coords) for condition in self.conditions])


@dataclass(frozen=True, eq=False)
class _OnSome:
    """Positive at boundary points that belong to one of the parts (a test, not a smooth function)."""

    parts: tuple[Part, ...]

    def __call__(self, *coords: Value) -> Value:
        tests = []
        for part in self.parts:
            near = reduce(maximum, [_nearness(surface, coords) for surface in part.surfaces])
            tests.append(near if part.where is None else minimum(near, part.where(*coords)))
        return reduce(maximum, tests)


def _nearness(surface: Surface, coords: tuple[Value, ...]) -> Value:
    """Positive on the carrier up to rounding."""
    scale = surface.size if np.isfinite(surface.size) else 1.0
    return _ON_CARRIER * scale - absolute(surface.function(*coords))
