r"""Volume, surface, centroid and inertia of a shape, by the rules that every solve uses.

.. math:: V = \int_\Omega dx, \quad A = \int_{\partial\Omega} ds, \quad c = \frac1V \int_\Omega x\,dx, \quad
          M = \int_\Omega (x - c)(x - c)^T dx, \quad J = (\operatorname{tr} M)\, I - M

for unit density; in the plane V is the area, A the length of the boundary and tr M the polar moment.  Inner cells have
the tensor Gauss rule, cut cells the height-function rule: what is a polynomial of low degree on a polynomial shape
comes out to rounding.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape
from solvers.classify import classify
from solvers.grid import Grid
from solvers.quadrature import DomainRules, domain_rules

CELLS = 12
"""Cells along the longest side of the box."""
POINTS = 8
"""Gauss points a direction."""


@dataclass(frozen=True)
class Properties:
    """Integrals of a shape.

    Attributes
    ----------
    volume, surface
        V and A.
    surfaces
        Measure of the boundary on each named surface.
    centroid
        c, shape (d,).
    moments
        M about the centroid, shape (d, d).
    """

    volume: float
    surface: float
    surfaces: Mapping[str, float]
    centroid: Array
    moments: Array

    @property
    def inertia(self) -> Array:
        """Tensor of inertia J about the centroid for unit density, shape (d, d)."""
        return inertia_of(self.moments)


def inertia_of(moments: Array) -> Array:
    """Tensor (tr M) I - M of a matrix of second moments."""
    return np.asarray(np.trace(moments) * np.eye(len(moments)) - moments)


@dataclass(frozen=True, eq=False)
class Rules:
    """Grid and quadrature rules of a shape, as points."""

    shape: Shape
    grid: Grid
    rules: DomainRules

    def volume(self) -> Iterator[tuple[Array, Array]]:
        """Points (q, d) and weights (q,) of the domain, batch by batch."""
        for batch in (self.rules.inner, self.rules.cut):
            points = np.stack([np.asarray(x).ravel() for x in batch.points(self.grid)], axis=1)
            yield (
                points,
                np.broadcast_to(batch.weights, (len(points),))
                if batch.weights.ndim == 0
                else (np.asarray(batch.weights).ravel()),
            )


def rules_of(shape: Shape, cells: int = CELLS, points: int = POINTS) -> Rules:
    """Quadrature rules of a bounded shape.

    Raises
    ------
    GeometryError
        The shape is empty or unbounded.
    """
    if not shape.box.finite:
        raise GeometryError(
            f"the shape has the box {shape.box.lower} to {shape.box.upper}: only a bounded shape has a volume"
        )
    grid = Grid.cover(shape.box, cells)
    return Rules(shape, grid, domain_rules(shape, classify(shape, grid), points, points))


def properties(shape: Shape, cells: int = CELLS, points: int = POINTS) -> Properties:
    """Integrals of a shape.

    Parameters
    ----------
    shape
        A bounded shape.
    cells, points
        Cells along the longest side of its box, Gauss points a direction.

    Raises
    ------
    GeometryError
        The shape is empty or unbounded.
    """
    return integrate(rules_of(shape, cells, points))


def integrate(rules: Rules) -> Properties:
    """Integrals by given rules."""
    d = rules.shape.dimension
    middle = np.array(rules.shape.box.center)
    volume, first, second = 0.0, np.zeros(d), np.zeros((d, d))
    for points, weights in rules.volume():
        offset = points - middle
        volume += float(weights.sum())
        first += weights @ offset
        second += (weights[:, None] * offset).T @ offset
    shift = first / volume
    measures: dict[str, float] = {}
    for surface, batch in rules.rules.boundary.items():
        measures[surface.name] = measures.get(surface.name, 0.0) + float(batch.weights.sum())
    return Properties(
        volume, sum(measures.values()), measures, middle + shift, second - volume * np.outer(shift, shift)
    )
