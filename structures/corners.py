"""Whether boundary data agree where their parts meet.

Two Dirichlet parts that share a corner (2D) or an edge (3D) must carry equal values there: otherwise no solution
of finite energy exists and every method converges slowly, without a word.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.contact import SEEDS, meeting_points
from structures.field_expression import field


@dataclass(frozen=True)
class CornerJump:
    """The largest disagreement of two conditions where their parts meet.

    Attributes
    ----------
    parts
        Names of the two parts.
    location
        Coordinates of the point.
    jump
        |g_i - g_j| there.
    points
        Number of meeting points that were looked at.
    """

    parts: tuple[str, str]
    location: tuple[float, ...]
    jump: float
    points: int


def corner_jumps(
    domain: Shape,
    data: Sequence[tuple[Part, Field | float]],
    points_by_part: Mapping[str, Array] | None = None,
) -> list[CornerJump]:
    """Compare the data of every two parts where they meet, the largest jump first.

    Parameters
    ----------
    domain
        The shape whose boundary carries the parts.
    data
        Pairs (part, value).  Pairs with the very same field are not compared.
    points_by_part
        Sample points ``(n, d)`` on the parts by name, for example quadrature points of the boundary;
        without them points spread over the domain's box are used as starts.

    Returns
    -------
    list of CornerJump
        One for every pair of parts that meet, also those that agree (a jump of rounding size).
    """
    samples = points_by_part or {}
    found = []
    for (part_a, g_a), (part_b, g_b) in combinations(data, 2):
        if g_a is g_b:
            continue
        given = [_thinned(samples[part.name]) for part in (part_a, part_b) if part.name in samples]
        points = meeting_points(domain, part_a, part_b, np.concatenate(given) if given else None)
        if len(points):
            jumps = jumps_at(points, g_a, g_b)
            worst = int(np.argmax(jumps))
            place = tuple(float(x) for x in points[worst])
            found.append(CornerJump((part_a.name, part_b.name), place, float(jumps[worst]), len(points)))
    return sorted(found, key=lambda corner: -corner.jump)


def jumps_at(points: Array, a: Field | float, b: Field | float) -> Array:
    """Return |a - b| at points ``(n, d)``; infinite where one is not defined."""
    coords = tuple(points.T)
    with np.errstate(all="ignore"):
        gap = np.abs(partials(field(a), coords, 0)[0] - partials(field(b), coords, 0)[0])
    return np.where(np.isfinite(gap), gap, np.inf)


def _thinned(points: Array) -> Array:
    array = np.asarray(points, float)
    return array[:: max(1, len(array) // SEEDS)]
