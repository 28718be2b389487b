r"""The constrained optimum by a sequence of regions: F is to be largest where omega >= 0.

Constraints are one inequality, the R-conjunction of all of them.  Whatever is feasible and better than a point x_k with
F(x_k) = c_k lies in the region (Shapiro, Acta Numerica 16, 2007, section 6.4)

.. math:: \omega_k(x) = \omega(x) \wedge (F(x) - c_k) > 0.

The next point is where omega_k is largest, and c_{k+1} = F(x_{k+1}) > c_k: a monotone search, Huard's method of centres
(in *Nonlinear Programming*, North-Holland 1967) with an R-function as the distance.  Inside its region omega_k is as
smooth as its arguments, so that Newton steps with derivatives from jets find the centre; the sequence converges
linearly.  Each start leads to a local optimum; :mod:`rfm.geometry.planning.bounds` proves how far the best of them can
be from the global one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.r_systems import R0, RSystem
from rfm.calculus.types import Array, Field, Value
from rfm.errors import GeometryError
from rfm.geometry.box import Box
from rfm.geometry.spread import spread

MOST_CENTRES = 100
MOST_STEPS = 40
LONGEST = 0.2
"""Longest Newton step, in units of the box."""
SHORTEST = 1e-6
"""Least share of a Newton step."""
ENOUGH = 1e-2
"""Gain of a Newton step, relative to the value, that is not worth another."""
SAMPLES = 4096
"""Points among which starts are chosen."""
STARTS = 5


@dataclass(frozen=True, eq=False)
class Region:
    """R-conjunction of constraints, each satisfied where it is not negative."""

    constraints: tuple[Field, ...]
    system: RSystem

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.system.conjunction(*(constraint(*coords) for constraint in self.constraints))


@dataclass(frozen=True)
class Optimum:
    """What a search found.

    Attributes
    ----------
    point
        The best feasible point, shape (n,).
    value
        The objective there.
    centres
        How many regions were needed.
    """

    point: Array
    value: float
    centres: int


def region(constraints: Sequence[Field], system: RSystem = R0) -> Field:
    """Return one function that is not negative where all constraints are not.

    Raises
    ------
    GeometryError
        There are none.
    """
    if not constraints:
        raise GeometryError("a region needs at least one constraint")
    return Region(tuple(constraints), system)


def monotone_search(
    feasible: Field, objective: Field, box: Box, tolerance: float = 1e-9, starts: Array | int = STARTS
) -> Optimum:
    """Find the largest value of an objective where a function is not negative.

    Parameters
    ----------
    feasible
        omega, for instance of :func:`region`.
    objective
        F.
    box
        Where to look; it also scales the variables.
    tolerance
        The search ends when c grows by less, relative to the largest value met.
    starts
        Points (m, n), or how many to choose among points spread over the box: those deepest in the region and those of
        the largest objective in it.

    Raises
    ------
    GeometryError
        The box is not finite, or no feasible point was found from any start.
    """
    if not box.finite or box.empty:
        raise GeometryError(f"a search needs a finite box, got {box.lower} to {box.upper}")
    size = np.array(box.size)
    points = chosen(feasible, objective, box, starts) if isinstance(starts, int) else starts
    best: Optimum | None = None
    for start in points:
        found = _from(feasible, objective, start, size, tolerance)
        if found is not None and (best is None or found.value > best.value):
            best = found
    if best is None:
        raise GeometryError(
            f"no feasible point was found from {len(points)} starts: the constraints may contradict each other, or the "
            "region is small; give starts near it"
        )
    return best


def chosen(feasible: Field, objective: Field, box: Box, count: int) -> Array:
    """Starts among points spread over the box, at most `count`."""
    points = np.array(box.lower) + spread(SAMPLES, box.dimension) * np.array(box.size)
    coords = tuple(points.T)
    depth, value = partials(feasible, coords, 0)[0], partials(objective, coords, 0)[0]
    deepest = np.argsort(-np.nan_to_num(depth, nan=-np.inf))[: count - count // 2]
    best = np.argsort(-np.where(depth >= 0, np.nan_to_num(value, nan=-np.inf), -np.inf))[: count // 2]
    return np.asarray(points[np.unique(np.concatenate([deepest, best]))])


def _from(feasible: Field, objective: Field, start: Array, size: Array, tolerance: float) -> Optimum | None:
    """Local optimum that a start leads to, None when no feasible point is reached."""
    point = climb(feasible, start, size)
    if float(_value(feasible, point)) < 0:
        return None
    level = _value(objective, point)
    count = 0
    while count < MOST_CENTRES:
        count += 1
        centre = climb(Region((feasible, Above(objective, level)), R0), point, size)
        higher = _value(objective, centre)
        if _value(feasible, centre) < 0 or higher <= level:
            break
        gain, point, level = higher - level, centre, higher
        if gain < tolerance * max(1.0, abs(level)):
            break
    return Optimum(point, level, count)


@dataclass(frozen=True, eq=False)
class Above:
    """F - c."""

    objective: Field
    level: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.objective(*coords) - self.level


def climb(function: Field, start: Array, size: Array) -> Array:
    """Point near a local maximum of a function, by Newton steps with the modulus of the Hessian.

    The steps do not depend on the scale of the region, which becomes a sliver near the optimum.  They end where the
    next one gains less than a hundredth of the value, for a centre need not be exact.
    """
    point, n = start, len(start)
    jet = partials(function, tuple(point), 2)
    for _ in range(MOST_STEPS):
        step = uphill(jet[1 : 1 + n], hessian_of(jet, n))
        longest = float(np.abs(step / size).max())
        if not np.isfinite(longest) or longest == 0.0:
            break
        step *= min(1.0, LONGEST / longest)
        gain = float(jet[1 : 1 + n] @ step)
        share, value = 1.0, float(jet[0])
        while share > SHORTEST:
            trial = partials(function, tuple(point + share * step), 2)
            if np.isfinite(trial).all() and trial[0] > value + 0.1 * share * gain:
                break
            share *= 0.4
        else:
            break
        point, jet = point + share * step, trial
        if share == 1.0 and gain < ENOUGH * abs(float(jet[0])):
            break
    return np.asarray(point)


def uphill(slope: Array, hessian: Array) -> Array:
    """Newton step that is uphill whatever the signs of the curvatures."""
    if not np.isfinite(hessian).all() or not np.isfinite(slope).all():
        return np.nan_to_num(slope)
    curvature, axes = np.linalg.eigh(hessian)
    floor = 1e-10 * max(float(np.abs(curvature).max()), float(np.linalg.norm(slope)))
    if floor == 0.0:
        return np.zeros_like(slope)
    return np.asarray(axes @ ((axes.T @ slope) / np.maximum(np.abs(curvature), floor)))


def hessian_of(jet: Array, n: int) -> Array:
    """Matrix of the second derivatives in a jet of order two of n variables."""
    result = np.empty((n, n))
    for value, alpha in zip(jet, multi_indices(n, 2), strict=True):
        axes = [axis for axis, power in enumerate(alpha) for _ in range(power)]
        if len(axes) == 2:
            result[axes[0], axes[1]] = result[axes[1], axes[0]] = value
    return result


def _value(field: Field, point: Array) -> float:
    return float(partials(field, tuple(point), 0)[0])
