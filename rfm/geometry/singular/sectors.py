"""What a shape looks like near a point where several of its surfaces vanish.

To first order each surface is a line through the point (in space: a plane through a common tangent, seen along it), and
the lines cut the neighbourhood into sectors.  In a sector every surface has a definite sign, so the Boolean expression
says whether it belongs to the shape.  The point is smooth when the shape is one half-plane, inside when all sectors
belong to it, and a corner otherwise.

Notation: g_a gradients of the active surfaces, shape (k, 2); angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.geometry.logic import Integers, Logic, Mask, Signs

PARALLEL = 1e-7
"""Angles below which two lines count as one."""


@dataclass(frozen=True)
class Sectors:
    """The sectors of the shape around a point.

    Attributes
    ----------
    angles
        Widths of the connected sectors that belong to the shape, in radians; empty at an isolated point or a cusp.
    smooth
        Whether the boundary has one tangent here, or does not pass.
    tangent
        Whether two of the lines coincide, so that first order does not tell everything.
    """

    angles: tuple[float, ...]
    smooth: bool
    tangent: bool


def sectors(
    logic: Logic,
    signs: Signs,
    active: Integers,
    gradients: Array,
    parallel: float = PARALLEL,
    curves: int | None = None,
) -> Sectors:
    """Sectors around a point.

    Parameters
    ----------
    logic
        Expression and surfaces of the shape.
    signs
        Signs of all surfaces at the point, shape (S,); those of the active ones do not matter.
    active
        Numbers of the surfaces that vanish there, shape (k,).
    gradients
        Their gradients, shape (k, 2).
    parallel
        Angle below which two lines count as one.
    curves
        Number of different curves among the surfaces, all by default; surfaces that coincide do not touch.
    """
    along = np.arctan2(-gradients[:, 0], gradients[:, 1])
    lines = np.sort(along % np.pi)
    gaps = np.diff(np.append(lines, lines[0] + np.pi))
    tangent = int((gaps > parallel).sum()) < min(len(lines), curves or len(lines))
    rays = np.concatenate([lines, lines + np.pi])
    widths = np.diff(np.append(rays, rays[0] + 2 * np.pi))
    wide = widths > parallel
    start, widths = rays[wide], widths[wide]
    middles = start + 0.5 * widths
    directions = np.stack([np.cos(middles), np.sin(middles)], axis=1)
    trial = np.repeat(signs[None, :], len(middles), axis=0)
    trial[:, active] = np.where(directions @ gradients.T > 0, 1, -1)
    inside = logic.value(trial) > 0
    angles = _runs(inside, widths)
    whole = bool(inside.all() or not inside.any())
    half = len(angles) == 1 and abs(angles[0] - np.pi) < parallel
    return Sectors(() if whole else angles, (whole or half) and not tangent, tangent)


def _runs(inside: Mask, widths: Array) -> tuple[float, ...]:
    """Total widths of neighbouring sectors inside, around the circle."""
    if inside.all():
        return (float(widths.sum()),)
    first = int(np.argmin(inside))  # begin outside, so that no run is cut
    total, found = 0.0, []
    for belongs, width in zip(np.roll(inside, -first), np.roll(widths, -first), strict=True):
        if belongs:
            total += float(width)
        elif total:
            found.append(total)
            total = 0.0
    if total:
        found.append(total)
    return tuple(found)
