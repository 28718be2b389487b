r"""All common zeros of d fields in d variables, by interval subdivision and Newton's method.

For a box X with midpoint m, F the fields, J(X) an enclosure of their derivatives over X and Y an approximate inverse of
its midpoint, Krawczyk's operator is

.. math:: K(X) = m - Y F(m) + (I - Y J(X)) (X - m).

All zeros in X lie in K(X); if K(X) lies in the interior of X, there is exactly one zero in X and Newton's method
converges to it (Krawczyk, Computing 4, 1969; Moore, Kearfott, Cloud, *Introduction to Interval Analysis*, SIAM 2009,
section 8.2).  A box is dropped, certified or cut by K(X) and, where that gains little, halved.  The test is made on a
box that is a little larger, so that a zero on the face between two boxes is certified as well.

Where the gradients are dependent (surfaces that touch) no box is ever certified: such boxes end at a small size and
are returned as contacts.

Notation: n boxes with lower and upper corners (n, d); matrices (n, d, d).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.intervals import Interval
from rfm.calculus.jet import Jet, variables
from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field

Mask = NDArray[np.bool_]
Keep = Callable[[Array, Array], Mask]

INFLATION = 0.1
"""By how much of its half-width a box is enlarged for the test."""
GAIN = 0.7
"""A box that its image shrinks less than this in every direction is halved."""
SMALLEST = 2e-6
"""Size of the boxes, in units of the start, at which halving ends."""
MOST_BOXES = 4_000
"""Boxes of one level above which the zeros cannot be isolated points."""
ROUNDING = 1e-14
NEWTON_STEPS = 30


@dataclass(frozen=True)
class Zeros:
    """What was found.

    Attributes
    ----------
    points
        Certified zeros, each once, shape (n, d), accurate to rounding.
    contacts
        Zeros with dependent gradients, or near zeros that no test could exclude, shape (m, d); accurate to about the
        root of the rounding.
    isolated
        False when there were so many boxes that the zeros must lie on curves; both lists are empty then.
    """

    points: Array
    contacts: Array
    isolated: bool = True


def common_zeros(
    fields: Sequence[Field], lower: Array, upper: Array, keep: Keep | None = None, smallest: float = SMALLEST
) -> Zeros:
    """Find all points of some boxes at which every one of d fields vanishes.

    Parameters
    ----------
    fields
        d fields of d variables.
    lower, upper
        Corners of the boxes, shape (n, d).
    keep
        Which boxes still matter, called with their corners; all by default.
    smallest
        Size at which boxes are given up, relative to the hull of all boxes.
    """
    d = lower.shape[1]
    if not len(lower):
        return Zeros(np.empty((0, d)), np.empty((0, d)))
    size = float((upper.max(axis=0) - lower.min(axis=0)).max())
    certified: list[Array] = []
    given_up: list[Array] = []
    while len(lower):
        if len(lower) > MOST_BOXES:
            return Zeros(np.empty((0, d)), np.empty((0, d)), isolated=False)
        if keep is not None:
            chosen = keep(lower, upper)
            lower, upper = lower[chosen], upper[chosen]
        certain, left, inner_lower, inner_upper = _step(fields, lower, upper)
        certified.append(0.5 * (inner_lower + inner_upper)[certain])
        lower, upper, old = inner_lower[left], inner_upper[left], (upper - lower)[left]
        width = upper - lower
        small = width.max(axis=1, initial=0.0) < smallest * size
        given_up.append(0.5 * (lower + upper)[small])
        stuck = ~small & (width > GAIN * old).any(axis=1)
        halves = halved(lower[stuck], upper[stuck])
        rest = ~small & ~stuck
        lower = np.concatenate([lower[rest], halves[0]])
        upper = np.concatenate([upper[rest], halves[1]])
    points = polished(fields, np.concatenate(certified), size)
    contacts = clusters(np.concatenate(given_up), 20 * smallest * size)
    return Zeros(distinct(points, 1e-9 * size), apart(contacts, points, 50 * smallest * size))


def bounds(fields: Sequence[Field], lower: Array, upper: Array) -> tuple[Array, Array, Array, Array]:
    """Enclosures of fields and their first derivatives over boxes.

    Returns
    -------
    tuple
        Lower and upper bounds of the values, shape (n, k), then of the derivatives, shape (n, k, d).
    """
    n, d = lower.shape
    coords = variables([Interval(lower[:, j], upper[:, j]) for j in range(d)], 1)
    low, high = np.empty((n, len(fields), 1 + d)), np.empty((n, len(fields), 1 + d))
    with np.errstate(all="ignore"):
        for i, field in enumerate(fields):
            jet = field(*coords)
            terms = jet.coefficients if isinstance(jet, Jet) else (jet, *(0.0,) * d)
            for j, term in enumerate(terms):
                enclosed = Interval.of(term)
                low[:, i, j], high[:, i, j] = enclosed.lo, enclosed.hi
    low, high = np.nan_to_num(low, nan=-np.inf), np.nan_to_num(high, nan=np.inf)
    return low[..., 0], high[..., 0], low[..., 1:], high[..., 1:]


def halved(lower: Array, upper: Array) -> tuple[Array, Array]:
    """Halves of boxes across their longest side."""
    rows, axis = np.arange(len(lower)), np.argmax(upper - lower, axis=1)
    middle = 0.5 * (lower + upper)[rows, axis]
    left, right = upper.copy(), lower.copy()
    left[rows, axis], right[rows, axis] = middle, middle
    return np.concatenate([lower, right]), np.concatenate([left, upper])


def polished(fields: Sequence[Field], points: Array, size: float) -> Array:
    """Newton's method from points (n, d) that are near zeros."""
    x = points.T.copy()
    for _ in range(NEWTON_STEPS):
        jets = np.stack([partials(field, tuple(x), 1) for field in fields])
        step = np.linalg.solve(np.moveaxis(jets[:, 1:], 2, 0), jets[:, 0].T[..., None])[..., 0]
        x -= step.T
        if np.abs(step).max(initial=0.0) < 4e-16 * size:
            break
    return np.asarray(x.T)


def distinct(points: Array, tolerance: float) -> Array:
    """One point of every cluster narrower than the tolerance, in lexicographic order."""
    ordered = points[np.lexsort(np.round(points / tolerance).T[::-1])]
    kept: list[Array] = []
    for point in ordered:
        if not kept or np.abs(np.array(kept) - point).max(axis=1).min() > tolerance:
            kept.append(point)
    return np.array(kept).reshape(-1, points.shape[1])


def clusters(points: Array, reach: float) -> Array:
    """Centres of the groups of points that are linked by distances below `reach`."""
    rest = points
    centres: list[Array] = []
    while len(rest):
        group, added = rest[:1], rest[:1]
        rest = rest[1:]
        while len(added) and len(rest):
            near = (np.abs(rest[:, None] - added).max(axis=2) < reach).any(axis=1)
            added, rest = rest[near], rest[~near]
            group = np.concatenate([group, added])
        centres.append(0.5 * (group.min(axis=0) + group.max(axis=0)))
    return np.array(centres).reshape(-1, points.shape[1])


def apart(points: Array, others: Array, reach: float) -> Array:
    """Those of the points that are farther than `reach` from all others."""
    if not len(points) or not len(others):
        return points
    nearest = np.abs(points[:, None] - others).max(axis=2).min(axis=1)
    return np.asarray(points[nearest > reach])


def _step(fields: Sequence[Field], lower: Array, upper: Array) -> tuple[Mask, Mask, Array, Array]:
    """Which boxes hold exactly one zero, which are still open, and the boxes cut by Krawczyk's operator."""
    middle, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    wide = (1.0 + INFLATION) * half + ROUNDING * np.abs(middle)
    value_low, value_high, slope_low, slope_high = bounds(fields, middle - wide, middle + wide)
    possible = ((value_low <= 0) & (value_high >= 0)).all(axis=1)
    at_low, at_high, _, _ = bounds(fields, middle, middle)
    slope, spread = 0.5 * (slope_low + slope_high), 0.5 * (slope_high - slope_low)
    with np.errstate(all="ignore"):
        usable = np.asarray(possible & np.isfinite(slope).all(axis=(1, 2)))
        usable &= np.isfinite(at_low + at_high).all(axis=1)
        usable &= np.abs(np.linalg.det(np.where(usable[:, None, None], slope, 0.0))) > 0
        inverse = np.zeros_like(slope)
        inverse[usable] = np.linalg.inv(slope[usable])
        at = 0.5 * (at_low + at_high)
        centre = middle - np.einsum("nij,nj->ni", inverse, at)
        radius = np.einsum("nij,nj->ni", np.abs(inverse), 0.5 * (at_high - at_low))
        shrink = np.abs(np.eye(lower.shape[1]) - inverse @ slope) + np.abs(inverse) @ spread
        radius = radius + np.einsum("nij,nj->ni", shrink, wide) + ROUNDING * np.abs(centre)
        usable &= np.isfinite(radius).all(axis=1)
        inside = np.asarray(usable & ((np.abs(centre - middle) + radius) < wide).all(axis=1))
        cut_low, cut_high = np.maximum(lower, centre - radius), np.minimum(upper, centre + radius)
    new_lower = np.where(usable[:, None], cut_low, lower)
    new_upper = np.where(usable[:, None], cut_high, upper)
    open_boxes = possible & ~inside & (new_lower <= new_upper).all(axis=1)
    new_lower[inside] = new_upper[inside] = centre[inside]
    return inside, open_boxes, new_lower, new_upper
