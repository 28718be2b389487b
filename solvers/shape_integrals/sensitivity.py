r"""Derivatives of the integrals of a shape with respect to one of its parameters.

A surface f(x, t) = 0 of the boundary moves with the normal velocity

.. math:: v_n = -\frac{\partial f/\partial t}{\nabla f \cdot n}

(n outward), and by Reynolds' transport theorem (Shapiro, Acta Numerica 16, 2007, (6.5))

.. math:: \frac{d}{dt} \int_\Omega g\,dx = \int_{\partial\Omega} g\, v_n\,ds, \qquad
          \frac{dA}{dt} = \int_{\partial\Omega} \kappa\, v_n\,ds + \sum_e \int_e (v \cdot \nu_1 + v \cdot \nu_2)\,dl,

kappa = div n the sum of the principal curvatures, e the edges (in the plane: the corners, without an integral), v their
velocity and nu the conormals of the two faces, pointing out of them (:mod:`solvers.shape_integrals.creases`).

The shape is a function of the parameter; its surfaces must be the same ones, in the same order, for nearby values.
Their derivatives in t at fixed points are central differences of order six, the only approximation besides quadrature.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface
from solvers.shape_integrals.creases import crease_term
from solvers.shape_integrals.properties import CELLS, POINTS, inertia_of, integrate, rules_of

Family = Callable[[float], Shape]

STENCIL = ((1, 0.75), (2, -0.15), (3, 1.0 / 60.0))
"""Offsets and factors of the central difference of order six."""
STEP = 2e-3
"""Step of the difference, relative to the parameter (and absolute for small ones)."""


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives of the integrals with respect to the parameter.

    Attributes
    ----------
    volume, surface
        dV/dt and dA/dt.
    centroid
        dc/dt, shape (d,).
    moments
        dM/dt about the centroid, shape (d, d).
    """

    volume: float
    surface: float
    centroid: Array
    moments: Array

    @property
    def inertia(self) -> Array:
        """dJ/dt about the centroid, shape (d, d)."""
        return inertia_of(self.moments)


@dataclass(frozen=True, eq=False)
class Motion:
    """The surfaces of a family of shapes near one value of its parameter.

    Attributes
    ----------
    shapes
        Shapes at the points of the stencil with their factors.
    surfaces
        Surfaces of the shape itself.
    """

    shapes: tuple[tuple[float, Shape], ...]
    surfaces: tuple[Surface, ...]

    def rate(self, number: int, points: Array) -> Array:
        """Derivative of a surface function in t at points (n, d), shape (n,)."""
        coords = tuple(points.T)
        total: Array = np.zeros(len(points))
        for factor, shape in self.shapes:
            total = total + factor * partials(shape.surfaces[number].function, coords, 0)[0]
        return total


def motion_of(family: Family, at: float) -> Motion:
    """Shapes around a value of the parameter.

    Raises
    ------
    GeometryError
        Nearby shapes have other surfaces.
    """
    step = STEP * max(abs(at), STEP)
    here = family(at)
    shapes = []
    for offset, factor in STENCIL:
        for side in (1, -1):
            shape = family(at + side * offset * step)
            if [s.label for s in shape.surfaces] != [s.label for s in here.surfaces]:
                raise GeometryError(
                    f"the shape has other surfaces at the parameter {at + side * offset * step:.10g} than at "
                    f"{at:.10g}: there is no derivative"
                )
            shapes.append((side * factor / step, shape))
    return Motion(tuple(shapes), here.surfaces)


def sensitivity(family: Family, at: float, cells: int = CELLS, points: int = POINTS) -> Sensitivity:
    """Derivatives of the integrals of a family of shapes.

    Parameters
    ----------
    family
        From the parameter to a bounded shape.
    at
        The parameter.
    cells, points
        Cells along the longest side of the box, Gauss points a direction.

    Raises
    ------
    GeometryError
        The shape is empty or unbounded, or nearby shapes have other surfaces.
    """
    shape = family(at)
    rules = rules_of(shape, cells, points)
    values, motion = integrate(rules), motion_of(family, at)
    d = shape.dimension
    volume, area, first, second = 0.0, 0.0, np.zeros(d), np.zeros((d, d))
    numbers = {surface: i for i, surface in enumerate(shape.surfaces)}
    for surface, batch in rules.rules.boundary.items():
        counts = batch.weights.ravel() != 0
        at_points = np.stack([np.asarray(x).ravel()[counts] for x in batch.points(rules.grid)], axis=1)
        weights, normals = batch.weights.ravel()[counts], np.asarray(batch.normals).reshape(-1, d)[counts]
        jet = partials(surface.function, tuple(at_points.T), 2)
        velocity = -motion.rate(numbers[surface], at_points) / (jet[1 : 1 + d].T * normals).sum(axis=1)
        moved, offset = weights * velocity, at_points - values.centroid
        volume += float(moved.sum())
        area += float((moved * curvature(jet, normals)).sum())
        first += moved @ offset
        second += (moved[:, None] * offset).T @ offset
    area += crease_term(shape, motion.rate)
    return Sensitivity(volume, area, first / values.volume, second)


def curvature(jet: Array, normals: Array) -> Array:
    """Sum of the principal curvatures, positive for a ball.

    Parameters
    ----------
    jet
        Jet of order 2 of the surface's function at n points.
    normals
        Outward normals there, shape (n, d).
    """
    d = normals.shape[1]
    indices = multi_indices(d, 2)
    slope = jet[1 : 1 + d].T
    length = np.linalg.norm(slope, axis=1)
    side = np.sign((slope * normals).sum(axis=1))  # -1 where f is positive inside
    hessian = np.empty((len(normals), d, d))
    for row, alpha in enumerate(indices):
        axes = [axis for axis, power in enumerate(alpha) for _ in range(power)]
        if len(axes) == 2:
            hessian[:, axes[0], axes[1]] = hessian[:, axes[1], axes[0]] = jet[row]
    unit = slope / length[:, None]
    bend = np.trace(hessian, axis1=1, axis2=2) - np.einsum("ni,nij,nj->n", unit, hessian, unit)
    return np.asarray(side * bend / length)
