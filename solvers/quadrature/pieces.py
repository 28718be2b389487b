"""Intervals broken at roots, and Gauss rules on the pieces.

Notation: ``n`` unit intervals; *breaks* are flat lists ``(interval number, position)``; *pieces* are flat lists
``(interval number, start, length)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from solvers.grid import Integers

Breaks = tuple["Integers", "Array"]

SHORTEST = 4e-16
"""Pieces at rounding level carry nothing."""


@cache
def gauss(points: int) -> tuple[Array, Array]:
    """Return nodes and weights of the Gauss rule on ``[0, 1]``."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return 0.5 * (nodes + 1.0), 0.5 * weights


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces ``[start, start + length]`` of the unit intervals ``owner``, each of shape ``(P,)``."""

    owner: Integers
    start: Array
    length: Array

    def nodes(self, t: Array) -> Array:
        """Return nodes ``t (q,)`` of the unit interval on every piece, shape ``(P, q)``."""
        return np.asarray(self.start[:, None] + self.length[:, None] * t)

    def take(self, rows: Array | Integers) -> Pieces:
        """Return some of the pieces."""
        return Pieces(self.owner[rows], self.start[rows], self.length[rows])


def broken(count: int, breaks: Sequence[Breaks]) -> Pieces:
    """Break ``count`` unit intervals at all the given positions."""
    ends = np.arange(count)
    owner = np.concatenate([ends, ends, *(where for where, _ in breaks)])
    position = np.concatenate([np.zeros(count), np.ones(count), *(np.clip(at, 0.0, 1.0) for _, at in breaks)])
    order = np.lexsort((position, owner))
    owner, position = owner[order], position[order]
    length = np.diff(position)
    keep = np.flatnonzero((owner[1:] == owner[:-1]) & (length > SHORTEST))
    return Pieces(owner[keep], position[keep], length[keep])
