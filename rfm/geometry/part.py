"""Parts of a boundary: sets of surfaces, possibly restricted by a condition."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from rfm.calculus.functions import absolute, maximum, minimum
from rfm.calculus.types import Array, Field, Value
from rfm.errors import GeometryError
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
    for piece in (piece for part in given for piece in part.pieces if piece.surfaces):
        key = id(piece.where)
        known = groups.get(key)
        surfaces = piece.surfaces | (known.surfaces if known else frozenset())
        groups[key] = Part(piece.name if known is None else name, surfaces, piece.where)
    whole = groups.get(id(None))
    if whole is not None:
        groups = {
            key: part if part.where is None else replace(part, surfaces=part.surfaces - whole.surfaces)
            for key, part in groups.items()
        }
    pieces = tuple(part for part in groups.values() if part.surfaces)
    if len(pieces) <= 1:
        return replace(pieces[0], name=name) if pieces else Part(name, frozenset())
    surfaces = frozenset[Surface]().union(*(piece.surfaces for piece in pieces))
    return Part(name, surfaces, _OnSome(pieces), pieces)


def _without(piece: Part, other: Part) -> list[Part]:
    """What remains of a single piece: untouched surfaces, and those on which the other is restricted."""
    rest = [replace(piece, surfaces=piece.surfaces - other.surfaces)]
    for taken in other.pieces:
        shared = piece.surfaces & taken.surfaces
        if not shared or taken.where is None or taken.where is piece.where:
            continue
        if len([member for member in other.pieces if member.surfaces & shared]) > 1:
            raise GeometryError(
                f"cannot subtract several restricted pieces of one surface ({other.name}); "
                "subtract them one after the other"
            )
        rest.append(replace(piece, surfaces=shared).restricted(_Opposite(taken.where)))
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
