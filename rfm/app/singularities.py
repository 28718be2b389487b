"""Corners and edges of a solved shape for its report: where, how sharp, and how smooth the weight is there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.types import Array, Field

if TYPE_CHECKING:
    from rfm.geometry.shape import Shape
    from rfm.geometry.surface import Surface
    from solvers.problem import Discretization, Problem

MOST_SURFACES = {2: 250, 3: 16}
"""Surfaces up to which the search takes little time."""
ACCURACY = 2e-3
"""How closely the polygon of an edge follows it: for its length and for pictures."""


@dataclass(frozen=True, eq=False)
class Singularity:
    """A corner, or an edge.

    Attributes
    ----------
    points
        The corner (1, 2), or points along the edge (n, 3).
    angle
        Interior angle in degrees, as text: several at a point where the shape touches itself, a range along an edge.
    surfaces
        Names of the surfaces that meet.
    smoothness
        Continuous derivatives of the weight there, at most 4; None without an essential condition.
    """

    points: Array
    angle: str
    surfaces: str
    smoothness: int | None

    @property
    def place(self) -> str:
        """The corner, or the ends of the edge, as text."""
        first, last = self.points[0], self.points[-1]
        if len(self.points) == 1:
            return _shown(first)
        if np.allclose(first, last):
            return f"closed, through {_shown(first)}"
        return f"{_shown(first)} to {_shown(last)}"


def singularities(problem: Problem, discretization: Discretization) -> tuple[Singularity, ...]:
    """Corners of a plane domain or edges of a solid; none where there are too many surfaces to look for them."""
    from rfm.geometry.weight import weight
    from solvers.problem import Clamped, Dirichlet, SimplySupported

    domain = problem.domain
    if len(domain.surfaces) > MOST_SURFACES[domain.dimension] or not domain.box.finite:
        return ()
    held = [c.part for c in problem.conditions if isinstance(c, Dirichlet | Clamped | SimplySupported)]
    chosen = discretization.weight
    own = chosen if callable(chosen) else weight(domain, held, chosen)
    vanishing = own if held else None
    return _corners(domain, vanishing) if domain.dimension == 2 else _edges(domain, vanishing)


def _corners(domain: Shape, weight: Field | None) -> tuple[Singularity, ...]:
    from rfm.geometry.singular.corners import corners

    found = []
    for corner in corners(domain):
        angle = " and ".join(f"{np.degrees(a):.1f}" for a in corner.angles) or "cusp"
        smooth = _smoothness(domain, weight, np.array(corner.point), None)
        found.append(Singularity(np.array([corner.point]), angle, _names(corner.surfaces), smooth))
    return tuple(found)


def _edges(domain: Shape, weight: Field | None) -> tuple[Singularity, ...]:
    from rfm.geometry.singular.edges import edges

    found = []
    for edge in edges(domain, accuracy=ACCURACY):
        low, high = np.degrees(edge.angles.min()), np.degrees(edge.angles.max())
        angle = f"{low:.1f}" if high - low < 0.05 else f"{low:.1f} to {high:.1f}"
        middle = len(edge.points) // 2
        along = edge.points[middle] - edge.points[middle - 1]
        across = np.linalg.svd(along[None])[2][1:]
        smooth = _smoothness(domain, weight, edge.points[middle], across)
        found.append(Singularity(edge.points, angle, _names(edge.surfaces), smooth))
    return tuple(found)


def _smoothness(domain: Shape, weight: Field | None, point: Array, plane: Array | None) -> int | None:
    from rfm.geometry.singular.smoothness import continuous_derivatives

    if weight is None:
        return None
    return continuous_derivatives(weight, domain.membership, point.tolist(), max(domain.box.size), plane)


def _names(surfaces: tuple[Surface, ...]) -> str:
    return ", ".join(surface.name or "unnamed" for surface in surfaces)


def _shown(point: Array) -> str:
    return "(" + ", ".join(f"{x + 0.0:.6g}" for x in np.round(point, 12)) + ")"
