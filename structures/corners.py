"""Where parts of the boundary with different data meet, and whether the data agree there.

Two Dirichlet parts that share a corner (2D) or an edge (3D) must carry equal values there: otherwise
no continuous solution exists and every method converges slowly, without a word.  Common points are found by
Gauss-Newton steps from sample points to the common zeros of one surface function of each part.

Notation: f_a, f_b the surface functions, F = (f_a, f_b), J = dF/dx; the step is -J^T (J J^T)^{-1} F.
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

STEPS = 12
SEEDS = 256
CONVERGED = 1e-10  # of the domain's size


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
        Number of distinct meeting points that were looked at.
    """

    parts: tuple[str, str]
    location: tuple[float, ...]
    jump: float
    points: int


def corner_jumps(
    domain: Shape,
    data: Sequence[tuple[Part, Field]],
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
        One for every pair of parts that meet, also those that agree (jump of rounding size).
    """
    points_by_part = points_by_part or {}
    found = []
    for (part_a, g_a), (part_b, g_b) in combinations(data, 2):
        if g_a is g_b:
            continue
        samples = [points_by_part[p.name] for p in (part_a, part_b) if p.name in points_by_part]
        seeds = np.concatenate(samples) if samples else None
        points = meeting_points(domain, part_a, part_b, seeds)
        if not len(points):
            continue
        coords = tuple(points.T)
        jumps = np.abs(partials(g_a, coords, 0)[0] - partials(g_b, coords, 0)[0])
        worst = int(np.argmax(jumps))
        place = tuple(float(x) for x in points[worst])
        found.append(CornerJump((part_a.name, part_b.name), place, float(jumps[worst]), len(points)))
    return sorted(found, key=lambda corner: -corner.jump)


def meeting_points(domain: Shape, a: Part, b: Part, seeds: Array | None = None) -> Array:
    """Return points ``(n, d)`` of the closed domain that belong to both parts.

    In the plane these are the corners themselves, each once; in space samples of the common edges.

    Parameters
    ----------
    domain
        The shape.
    a, b
        Two parts of its boundary.
    seeds
        Starting points ``(n, d)``; by default spread over the domain's box.
    """
    starts = spread_points(domain) if seeds is None else _thinned(np.asarray(seeds, float))
    size = _size(domain, starts)
    found = [np.empty((0, domain.dimension))]
    for f_a, f_b in _function_pairs(a, b):
        points = _common_zeros(f_a, f_b, starts, size)
        keep = partials(domain.membership, tuple(points.T), 0)[0] > -CONVERGED * size
        for part in (a, b):
            if part.where is not None:
                keep &= partials(part.where, tuple(points.T), 0)[0] > -CONVERGED * size
        found.append(points[keep])
    return _distinct(np.concatenate(found), 1e-7 * size)


def spread_points(domain: Shape, count: int = SEEDS) -> Array:
    """Return ``count`` points spread evenly over the domain's box (Kronecker sequence of the plastic numbers)."""
    lower, upper = np.array(domain.box.lower, float), np.array(domain.box.upper, float)
    lower, upper = np.where(np.isfinite(lower), lower, -1.0), np.where(np.isfinite(upper), upper, 1.0)
    d = domain.dimension
    ratio = 2.0
    for _ in range(32):  # the root of r^(d+1) = r + 1, Roberts' generalised golden ratio
        ratio = (1 + ratio) ** (1 / (d + 1))
    steps = ratio ** -np.arange(1, d + 1)
    unit = (0.5 + np.outer(np.arange(1, count + 1), steps)) % 1.0
    return lower + unit * (upper - lower)


def _function_pairs(a: Part, b: Part) -> list[tuple[Field, Field]]:
    """Return pairs of functions whose common zeros may belong to both parts.

    Two conditions on pieces of one surface meet where one of them ends.
    """
    pairs = []
    for surface_a in sorted(a.surfaces, key=lambda s: s.label):
        for surface_b in sorted(b.surfaces, key=lambda s: s.label):
            if surface_a is not surface_b:
                pairs.append((surface_a.function, surface_b.function))
            else:
                ends = (part.where for part in (a, b) if part.where is not None)
                pairs.extend((surface_a.function, end) for end in ends)
    return pairs


def _common_zeros(f_a: Field, f_b: Field, starts: Array, size: float) -> Array:
    x = starts.T.copy()
    with np.errstate(all="ignore"):  # starts may leave the formulas' domain; they are dropped below
        for _ in range(STEPS):
            step, _ = _newton_step(f_a, f_b, x)
            length = np.sqrt((step**2).sum(axis=0))
            x += step * np.minimum(1.0, 0.5 * size / np.maximum(length, 1e-300))
        step, values = _newton_step(f_a, f_b, x)
        small = np.sqrt((step**2).sum(axis=0)) < CONVERGED * size
        small &= np.abs(values).max(axis=0) < 1e-6 * size
    good = small & np.isfinite(x).all(axis=0)
    return x[:, good].T


def _newton_step(f_a: Field, f_b: Field, x: Array) -> tuple[Array, Array]:
    """Return the minimum-norm Newton step ``(d, n)`` and the values ``(2, n)``."""
    jets = np.stack([partials(f, tuple(x), 1) for f in (f_a, f_b)])
    values, slopes = jets[:, 0], jets[:, 1:]
    gram = np.einsum("ikn,jkn->nij", slopes, slopes)
    gram[:, [0, 1], [0, 1]] *= 1 + 1e-14  # parallel gradients (tangent surfaces) stay solvable
    gram[:, [0, 1], [0, 1]] += 1e-300
    a, b, c, d = gram[:, 0, 0], gram[:, 0, 1], gram[:, 1, 0], gram[:, 1, 1]
    determinant = a * d - b * c
    multipliers = np.stack([d * values[0] - b * values[1], a * values[1] - c * values[0]]) / determinant
    return -np.einsum("in,ikn->kn", multipliers, slopes), values


def _size(domain: Shape, points: Array) -> float:
    extent = np.subtract(domain.box.upper, domain.box.lower)
    if np.isfinite(extent).all():
        return float(extent.max())
    return float(np.ptp(points, axis=0).max())


def _thinned(points: Array) -> Array:
    return points[:: max(1, len(points) // (2 * SEEDS))]


def _distinct(points: Array, tolerance: float) -> Array:
    """Return one representative of every cluster narrower than ``tolerance``."""
    kept: list[Array] = []
    for point in points[np.lexsort(points.T[::-1])]:
        if all(np.abs(point - other).max() > tolerance for other in kept):
            kept.append(point)
    return np.array(kept).reshape(-1, points.shape[1])
