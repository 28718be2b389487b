r"""Choice of the directions in which surfaces are graphs.

A surface is a graph over the base in direction ``k`` when :math:`\partial_k f` keeps its sign on the box.  How well
Gauss rules converge on the base is decided by how much it varies: the height function has a branch point where
:math:`\partial_k f = 0`, and with :math:`\rho = \max|\partial_k f| / \min|\partial_k f|` it is :math:`1/(\rho^2 - 1)`
base lengths away (for a quadric).  So the direction with the least :math:`\rho` is chosen, and boxes with
:math:`\rho` above :data:`STEADY` are halved.

In three dimensions the base is swept in lines along a second direction ``j`` for values of the third coordinate; the
traces of surfaces on the faces ``x_k = const`` have to be graphs in direction ``j``, and so do the edges in which two
surfaces meet: :math:`\partial_k f\,\partial_j g - \partial_j f\,\partial_k g` has to keep its sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np

from solvers.quadrature import bernstein
from solvers.quadrature.traces import crosses

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.logic import Mask
    from solvers.grid import Integers
    from solvers.quadrature.boxes import Boxes

STEADY = 2.5
"""Largest accepted ratio of derivatives along the height direction."""

STEADY_EDGE = 4.0
"""The same for the traces on faces and for edges."""

COMBINATIONS = (-4.0, -2.0, -1.0, -0.5, -0.25, 0.25, 0.5, 1.0, 2.0, 4.0)
"""Multiples of a second function that are added to a first one to see that they do not vanish together."""

PROHIBITIVE = 1e4
"""Score of what must not be chosen."""


SUSPECT = 1
"""Number of halvings after which traces that seem to turn on a face are looked at closely."""


@dataclass(frozen=True, eq=False)
class Choice:
    """Directions of a group of boxes.

    Attributes
    ----------
    axes
        Order ``(k, j[, l])`` of the directions, shape ``(n, d)``.
    upright
        Which slots do not depend on ``x_k``, shape ``(n, m)``.
    valid
        Whether everything is a graph, shape ``(n,)``.
    height
        Whether at least the surfaces are graphs in direction ``k``, shape ``(n,)``.
    base_only
        Whether halving the directions other than ``k`` may be enough, shape ``(n,)``.
    """

    axes: Integers
    upright: Mask
    valid: Mask
    height: Mask
    base_only: Mask


def choose(boxes: Boxes, heights: int) -> Choice:
    """Choose directions.

    Parameters
    ----------
    boxes
        A group of boxes with at least one slot.
    heights
        How many of the first slots need a height: all for a volume, 1 for the boundary on slot 0.
    """
    d = boxes.dimension
    low, high = _slopes(boxes.c, d)
    level = 4 * (boxes.degree + 1) * boxes.noise[..., None]
    upright = np.maximum(np.abs(low), np.abs(high)) <= level
    unsteady = _unsteadiness(low, high)
    steep = np.maximum(np.abs(low), np.abs(high)).sum(axis=2, keepdims=True) / np.maximum(
        _least(low, high), 1e-300
    )
    unsteady = np.where(upright, np.inf if heights == 1 else 1.0, unsteady)[:, :heights].max(axis=1)
    fits = unsteady <= STEADY
    # Among directions that fit, prefer steady and then flat surfaces.
    flatness = np.where(upright, 0.2, np.minimum(0.02 * steep, 1.0))[:, :heights].max(axis=1)
    score = unsteady + flatness + np.where(fits, 0.0, PROHIBITIVE)
    orders = list(permutations(range(d)))
    rows = np.arange(len(boxes))
    if d == 2:
        best = score.argmin(axis=1)
        never = np.zeros(len(boxes), dtype=bool)
        axes, good = np.asarray(orders)[best], fits[rows, best]
        return Choice(axes, upright[rows, :, best], good, good.copy(), never)
    totals = np.empty((len(boxes), len(orders)))
    apart = _apart(boxes, 0.5 * (low + high), heights)
    for number, order in enumerate(orders):
        k, j, _ = order
        traces = _trace_score(boxes, k, j, heights)
        edges = _edge_score(low, high, upright, apart, k, j)
        totals[:, number] = score[:, k] + 0.1 * traces + 0.05 * edges
    best = totals.argmin(axis=1)
    axes = np.asarray(orders)[best]
    height = fits.any(axis=1)
    valid = totals[rows, best] < 0.01 * PROHIBITIVE
    # Halve the base in the direction of the best height when only the base is in the way.
    axes = np.where(valid[:, None], axes, np.asarray(orders)[2 * score.argmin(axis=1)])
    base_only = height & (boxes.slots.shape[1] == 1)
    return Choice(axes, upright[rows, :, axes[:, 0]], valid, height, base_only)


def _slopes(c: Array, d: int) -> tuple[Array, Array]:
    """Bounds of the derivatives in every direction, two arrays ``(n, m, d)``."""
    ranges = [bernstein.bounds(bernstein.derivative(c, axis), d) for axis in range(-d, 0)]
    return np.stack([r[0] for r in ranges], axis=-1), np.stack([r[1] for r in ranges], axis=-1)


def _least(low: Array, high: Array) -> Array:
    """Least modulus of a range, 0 when it contains 0."""
    return np.where(low > 0, low, np.where(high < 0, -high, 0.0))


def _unsteadiness(low: Array, high: Array) -> Array:
    """Greatest over least modulus, infinite when the range contains 0."""
    least = _least(low, high)
    greatest = np.maximum(np.abs(low), np.abs(high))
    return np.where(least > 0, greatest / np.where(least > 0, least, 1.0), np.inf)


def _trace_score(boxes: Boxes, k: int, j: int, heights: int) -> Array:
    """Unsteadiness along ``j`` of the surfaces on the two faces across ``k``: 0 if fine, large if not."""
    axis = j if j < k else j - 1
    noise = boxes.noise[:, :heights]
    worst = np.zeros(len(boxes))
    for side in (0, -1):
        face = np.take(boxes.c[:, :heights], side, axis=2 + k)
        low, high = bernstein.bounds(face, 2)
        d_low, d_high = bernstein.bounds(bernstein.derivative(face, 2 + axis), 2)
        flat = np.maximum(np.abs(d_low), np.abs(d_high)) <= 4 * (boxes.degree + 1) * noise
        score = np.where(flat | (low >= -noise) | (high <= noise), 0.0, _unsteadiness(d_low, d_high))
        bad = score > STEADY_EDGE
        # A trace that only touches the face breaks nothing; most others are dealt with by halving.
        suspect = bad & (boxes.depth >= SUSPECT)[:, None]
        if suspect.any() and boxes.degree > 1:
            bad[suspect] = crosses(face[suspect], noise[suspect])
        worst = np.maximum(
            worst, np.where(bad, PROHIBITIVE, np.where(score > STEADY_EDGE, 0.0, score)).max(axis=1)
        )
    return worst


def _apart(boxes: Boxes, gradient: Array, heights: int) -> dict[tuple[int, int], Mask]:
    """Pairs of slots and where they certainly do not meet: where some combination of the two has no zero.

    For nearly parallel surfaces that is the combination in which the mean gradients ``(n, m, d)`` cancel.
    """
    m = boxes.slots.shape[1]
    size = np.abs(boxes.c.reshape(len(boxes), m, -1)).max(axis=2)
    found = {}
    for a in range(min(heights, m)):
        for b in range(a + 1, m):
            apart = np.zeros(len(boxes), dtype=bool)
            parallel = -(gradient[:, a] * gradient[:, b]).sum(axis=1)
            parallel /= np.maximum((gradient[:, b] ** 2).sum(axis=1), np.finfo(np.float64).tiny)
            for factor in (parallel, *(share * size[:, a] / size[:, b] for share in COMBINATIONS)):
                factors = factor.reshape(-1, *[1] * boxes.dimension)
                low, high = bernstein.bounds(boxes.c[:, a] + factors * boxes.c[:, b], boxes.dimension)
                noise = 2 * (boxes.noise[:, a] + np.abs(factor) * boxes.noise[:, b])
                apart |= (low > noise) | (high < -noise)
            found[a, b] = apart
    return found


def _edge_score(
    low: Array, high: Array, upright: Mask, apart: dict[tuple[int, int], Mask], k: int, j: int
) -> Array:
    """Unsteadiness along ``j`` of the edges between slots, 0 if there are none."""
    worst = np.zeros(len(low))
    zero = np.where(upright, 0.0, 1.0)
    low, high = low * zero, high * zero
    for (a, b), never in apart.items():
        first = _product(low[:, a, k], high[:, a, k], low[:, b, j], high[:, b, j])
        second = _product(low[:, a, j], high[:, a, j], low[:, b, k], high[:, b, k])
        minor_low, minor_high = first[0] - second[1], first[1] - second[0]
        flat = (minor_low == 0) & (minor_high == 0)
        score = _unsteadiness(minor_low, minor_high)
        score = np.where(score <= STEADY_EDGE, score, PROHIBITIVE)
        worst = np.maximum(worst, np.where(flat | never, 0.0, score))
    return worst


def _product(a_low: Array, a_high: Array, b_low: Array, b_high: Array) -> tuple[Array, Array]:
    products = np.stack([a_low * b_low, a_low * b_high, a_high * b_low, a_high * b_high])
    return products.min(axis=0), products.max(axis=0)
