"""The boundary cut into atoms: one surface each, with the condition ``where`` of its part, and who meets whom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.contact import boundary_points, meeting_points, size_of

Mask = NDArray[np.bool_]

NEAR = 0.1  # of the domain's size: samples fill the box of an atom up to this


@dataclass(frozen=True, eq=False)
class Atoms:
    """Atoms of some parts of a boundary; sets of them are boolean arrays ``(n,)``.

    Attributes
    ----------
    domain
        The shape.
    parts
        One part per atom.
    owners
        Which of the given parts each atom comes from.
    """

    domain: Shape
    parts: tuple[Part, ...]
    owners: tuple[int, ...]

    @classmethod
    def of(cls, domain: Shape, parts: Sequence[Part]) -> Atoms:
        """Cut parts of the boundary of ``domain`` into atoms."""
        atoms = [(atom, k) for k, part in enumerate(parts) for atom in _cut(part)]
        return cls(domain, tuple(atom for atom, _ in atoms), tuple(k for _, k in atoms))

    @cached_property
    def samples(self) -> tuple[Array, ...]:
        """Points ``(n, d)`` on every atom."""
        return tuple(boundary_points(self.domain, part) for part in self.parts)

    def select(self, chosen: Mask) -> list[Part]:
        """Return the chosen parts."""
        return [part for part, take in zip(self.parts, chosen, strict=True) if take]

    def corners(self, some: Mask, others: Mask) -> Array:
        """Return the points ``(n, d)`` where an atom of one set meets one of the other."""
        found = [np.empty((0, self.domain.dimension))]
        found += [self._meeting(i, j) for i in np.flatnonzero(some) for j in np.flatnonzero(others)]
        return np.concatenate(found)

    def clusters(self, chosen: Mask) -> list[list[Part]]:
        """Return the chosen atoms in groups that do not meet each other."""
        groups: list[list[int]] = []
        for i in np.flatnonzero(chosen):
            touching = [group for group in groups if any(len(self._meeting(i, j)) for j in group)]
            apart = [group for group in groups if group not in touching]
            groups = [*apart, [j for group in touching for j in group] + [int(i)]]
        return [[self.parts[i] for i in group] for group in groups]

    def share_a_surface(self, some: Mask, others: Mask) -> bool:
        """Tell whether two conditions of different sets lie on one surface."""
        return any(a.surfaces & b.surfaces for a in self.select(some) for b in self.select(others))

    @cached_property
    def _known(self) -> dict[tuple[int, int], Array]:
        return {}

    def _meeting(self, i: np.intp | int, j: np.intp | int) -> Array:
        key = (int(min(i, j)), int(max(i, j)))
        if key not in self._known:
            near = self._near(i, j)
            points = meeting_points(self.domain, self.parts[i], self.parts[j]) if near else None
            self._known[key] = np.empty((0, self.domain.dimension)) if points is None else points
        return self._known[key]

    def _near(self, i: np.intp | int, j: np.intp | int) -> bool:
        """Compare the boxes of the samples: most atoms are far apart and need no search."""
        a, b = self.samples[i], self.samples[j]
        if not len(a) or not len(b):
            return True
        gap = np.maximum(a.min(axis=0) - b.max(axis=0), b.min(axis=0) - a.max(axis=0))
        return bool(gap.max() < NEAR * size_of(self.domain))


def _cut(part: Part) -> list[Part]:
    return [
        replace(piece, name=surface.name, surfaces=frozenset([surface]))
        for piece in part.pieces
        for surface in sorted(piece.surfaces, key=lambda s: s.label)
    ]
