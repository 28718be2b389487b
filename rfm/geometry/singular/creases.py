"""Where two surfaces of a solid meet in an edge: is it an edge of the final boundary, and at which angle.

Away from vertices only the two surfaces vanish; seen along the edge they are two lines, which cut the plane across it
into four sectors, and the Boolean expression says which of them belong to the shape.  The boundary is smooth where
that is nothing, everything or the one side of one surface.

Notation: f, g the two surfaces, s_f, s_g their signs in a sector; the sector s_f, s_g has the angle
pi - arccos(s_f s_g grad f . grad g / (|grad f| |grad g|)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array
from rfm.geometry.logic import Logic, Mask
from rfm.geometry.singular.boxes import signs_on

SECTORS = ((1, 1), (1, -1), (-1, 1), (-1, -1))


@dataclass(frozen=True)
class Crease:
    """An edge or none at n points.

    Attributes
    ----------
    sharp
        Whether the boundary has an edge there, shape (n,).
    angle
        Interior angle in radians, shape (n,).
    """

    sharp: Mask
    angle: Array


def crease(logic: Logic, first: int, second: int, points: Array) -> Crease:
    """What the final boundary does at points (n, 3) where two surfaces, given by their numbers, vanish."""
    signs = signs_on(logic, points, points)
    inside = np.empty((len(points), len(SECTORS)), dtype=bool)
    for k, (s, t) in enumerate(SECTORS):
        signs[:, first], signs[:, second] = s, t
        inside[:, k] = logic.value(signs) > 0
    on_first = (inside[:, 0] != inside[:, 2]) | (inside[:, 1] != inside[:, 3])
    on_second = (inside[:, 0] != inside[:, 1]) | (inside[:, 2] != inside[:, 3])
    f, g = (partials(logic.surfaces[i].function, tuple(points.T), 1)[1:] for i in (first, second))
    with np.errstate(all="ignore"):
        cosine = (f * g).sum(axis=0) / np.sqrt((f * f).sum(axis=0) * (g * g).sum(axis=0))
    equal = np.arccos(np.clip(cosine, -1.0, 1.0))
    widths = np.stack([np.pi - equal, equal, equal, np.pi - equal], axis=1)
    return Crease(on_first & on_second, (widths * inside).sum(axis=1))
