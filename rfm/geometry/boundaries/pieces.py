r"""Pieces of boundary in batches, and the field of their union.

Notation: a batch holds n pieces of one kind, their data as arrays with n rows; w_i is the function of piece
i: zero on it, positive elsewhere, of unit slope across it.  The field of a union is their joint function
(5.3), see :mod:`rfm.geometry.boundaries.joining`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import reduce
from typing import Self

import numpy as np

from rfm.calculus.intervals import Interval
from rfm.calculus.jet import value_of
from rfm.calculus.jets import CHUNK
from rfm.calculus.types import Array, Field, Value
from rfm.errors import GeometryError
from rfm.geometry.boundaries.joining import joint, joint_of_two, spread

ENTRIES = 8 * CHUNK
"""Points times pieces evaluated at once: what keeps one array in a second-level cache."""


@dataclass(frozen=True, eq=False)
class Pieces(ABC):
    """A batch of n pieces; every field is an array with n rows."""

    @abstractmethod
    def functions(self, *coords: Value) -> Value:
        """Return w_1 ... w_n along the last axis, at coordinates that have one more axis for them."""

    def part(self, chosen: slice) -> Self:
        """Return the batch of some of the pieces."""
        return replace(self, **{item.name: getattr(self, item.name)[chosen] for item in fields(self)})

    def __len__(self) -> int:
        """Count the pieces."""
        return len(getattr(self, fields(self)[0].name))

    def blocks(self, points: int) -> Iterator[Self]:
        """Cut the batch so that a block at so many points fits the cache."""
        step = max(1, ENTRIES // max(points, 1))
        return (self.part(slice(start, start + step)) for start in range(0, len(self), step))


class Sided(Pieces):
    """Pieces of codimension one, which have two sides: left and right of a curve, above and below a face."""

    @property
    @abstractmethod
    def size(self) -> Array:
        """Length scale of each piece, shape (n,)."""

    @abstractmethod
    def side(self, *coords: Array) -> Array:
        """Sign of the carriers, positive on the left of a curve and where the normal of a face points."""

    @abstractmethod
    def samples(self) -> tuple[Array, Array]:
        """Return an inner point of each piece and the unit normal to its positive side, (n, d) both."""


@dataclass(frozen=True, eq=False)
class Curves(Sided):
    """Pieces of curves with a direction, from `start` to `end`, (n, d) each; in space they have no sides."""

    start: Array
    end: Array

    @abstractmethod
    def bulge(self, x: Array, y: Array, left: Array) -> Array:
        """Winding number, per piece, of the piece followed by its chord backwards.

        `left` tells where a point lies on the left of the chord.
        """

    def reach(self, directions: Array) -> Array:
        """Largest ``n . x`` on the pieces for unit directions n (k, d), shape (k,); here that of the ends."""
        return np.asarray(np.maximum(directions @ self.start.T, directions @ self.end.T).max(axis=1))


@dataclass(frozen=True, eq=False)
class Joined:
    """The field of a union of pieces: not negative, zero exactly on them, normalised to order `p`.

    Parameters
    ----------
    batches
        The pieces.
    p
        Order of the R-equivalence (5.3).

    Raises
    ------
    GeometryError
        When there are no pieces, or p is not a whole number from 1 on.
    """

    batches: tuple[Pieces, ...]
    p: int = 2

    def __post_init__(self) -> None:
        if self.p != int(self.p) or self.p < 1:
            raise GeometryError(f"p of the R-equivalence must be a whole number from 1 on, got {self.p:g}")
        if not self.batches:
            raise GeometryError("there are no pieces to join")

    def __or__(self, other: Joined) -> Joined:
        """Union of both sets of pieces."""
        return Joined(gathered([*self.batches, *other.batches]), max(self.p, other.p))

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        if all(isinstance(x, np.ndarray) for x in coords):
            return in_chunks(self._values, coords)
        return self._values(*coords)

    def _values(self, *coords: Value) -> Value:
        points = max(_count(x) for x in coords)
        wide = [spread(x) for x in coords]
        blocks = (block for batch in self.batches for block in batch.blocks(points))
        joints = (joint(block.functions(*wide), self.p) for block in blocks)
        return reduce(lambda a, b: joint_of_two(a, b, self.p), joints)


def gathered(batches: Sequence[Pieces]) -> tuple[Pieces, ...]:
    """Make one batch of those of one kind and dimension."""
    groups: dict[tuple[object, ...], list[Pieces]] = {}
    for batch in batches:
        groups.setdefault((type(batch), getattr(batch, fields(batch)[0].name).shape[1:]), []).append(batch)
    return tuple(_stacked(group) for group in groups.values())


def _stacked(batches: Sequence[Pieces]) -> Pieces:
    names = [item.name for item in fields(batches[0])]
    return replace(batches[0], **{n: np.concatenate([getattr(b, n) for b in batches]) for n in names})


def in_chunks(field: Field, coords: Sequence[Array]) -> Array:
    """Evaluate a field on arrays, so many points at once as fit the cache."""
    arrays = np.broadcast_arrays(*coords)
    shape = arrays[0].shape
    flat = [x.reshape(-1) for x in arrays]
    if flat[0].size <= CHUNK:
        return np.asarray(field(*flat)).reshape(shape)
    starts = range(0, flat[0].size, CHUNK)
    return np.concatenate([field(*[x[s : s + CHUNK] for x in flat]) for s in starts]).reshape(shape)


def dot(a: Sequence[Value], b: Sequence[Value] | Array) -> Value:
    """Scalar product of vectors that are given by their components, each an array over the pieces."""
    terms = [x * y for x, y in zip(a, b, strict=True)]
    return sum(terms[1:], terms[0])


def _count(x: Value) -> int:
    value = value_of(x)
    return int(np.size(value.lo if isinstance(value, Interval) else value))
