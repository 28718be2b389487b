"""Boundary conditions as numbers: residuals from the derivatives of u, the outward normal and the curvature.

Written independently of the operators in the structures, so that a test compares two derivations.

Notation: n outward unit normal, in the plane t = (-n_y, n_x); kappa = div n the curvature (1/R on a disk),
u_nt = n . H t and so on with the matrix H of second derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.field_expression import field


@dataclass(frozen=True, eq=False)
class BoundaryJets:
    """Derivatives of u at boundary points.

    Attributes
    ----------
    points, normal
        ``(d, n)``.
    curvature
        ``(n,)``.
    values
        ``(components, n_alpha, n)``.
    """

    points: Array
    normal: Array
    curvature: Array
    values: Array

    def d(self, component: int, *axes: int) -> Array:
        """Return the derivative of a component along axes, d(0, 1, 1) = d^2 u_0 / dy^2."""
        dimension = len(self.points)
        alpha = tuple(axes.count(k) for k in range(dimension))
        place = multi_indices(dimension, len(axes)).index(alpha)
        return np.asarray(self.values[component, place])

    def along(self, component: int, *vectors: Array) -> Array:
        """Return the derivative of a component along vector fields ``(d, n)`` held fixed."""
        total = np.zeros(self.points.shape[1])
        for axes in np.ndindex(*[len(self.points)] * len(vectors)):
            term = self.d(component, *axes)
            for vector, axis in zip(vectors, axes, strict=True):
                term = term * vector[axis]
            total = total + term
        return total

    @property
    def tangent(self) -> Array:
        """t, in the plane."""
        return np.stack([-self.normal[1], self.normal[0]])

    def at(self, value: Field | float) -> Array:
        """Return a datum at the points."""
        result: Array = partials(field(value), tuple(self.points), 0)[0]
        return result


@dataclass(frozen=True, eq=False)
class Trace:
    """One condition.

    Attributes
    ----------
    name
        For tables.
    order
        Highest derivative in it.
    residual
        B u - phi, an array ``(n,)`` or ``(rows, n)``.
    """

    name: str
    order: int
    residual: Callable[[BoundaryJets], Array]

    def relative(self, jets: BoundaryJets) -> float:
        """Return the largest residual, at every point relative to the largest derivative of u that may enter there."""
        scale = np.maximum(1.0, np.abs(jets.values).max(axis=(0, 1)))
        return float((np.abs(self.residual(jets)) / scale).max())


def value(g: Field | float, component: int = 0) -> Trace:
    """U = g."""
    return Trace("value", 0, lambda u: u.d(component) - u.at(g))


def flux(g: Field | float, conductivity: Field | float = 1.0, coefficient: Field | float = 0.0) -> Trace:
    """K du/dn + h u = g."""
    return Trace(
        "flux",
        1,
        lambda u: u.at(conductivity) * u.along(0, u.normal) + u.at(coefficient) * u.d(0) - u.at(g),
    )


def conormal(g: Field | float, conductivity: Sequence[Sequence[float]]) -> Trace:
    """N . K grad u = g."""
    return Trace("flux", 1, lambda u: u.along(0, np.array(conductivity).T @ u.normal) - u.at(g))


def oblique(g: Field | float, direction: Sequence[Field | float], coefficient: Field | float = 0.0) -> Trace:
    """L . grad u + h u = g."""
    return Trace(
        "oblique derivative",
        1,
        lambda u: u.along(0, np.stack([u.at(c) for c in direction])) + u.at(coefficient) * u.d(0) - u.at(g),
    )


def normal_derivative(g: Field | float, k: int) -> Trace:
    """d^k u/dn^k = g with n pointing *into* the domain, as in generalised Taylor polynomials."""
    return Trace(f"normal derivative {k}", k, lambda u: (-1.0) ** k * u.along(0, *[u.normal] * k) - u.at(g))


def moment(m: Field | float, poisson_ratio: float, stiffness: float = 1.0) -> Trace:
    """-D (u_nn + nu u_tt) = m; on an edge with u = 0, u_tt = kappa u_n."""
    nu = poisson_ratio
    return Trace(
        "bending moment",
        2,
        lambda u: (
            -stiffness * (u.along(0, u.normal, u.normal) + nu * u.along(0, u.tangent, u.tangent)) - u.at(m)
        ),
    )


def moment_on_support(m: Field | float, poisson_ratio: float, stiffness: float = 1.0) -> Trace:
    """-D (u_nn + nu kappa u_n) = m: the moment on an edge where u = 0, with the curvature term."""
    nu = poisson_ratio
    return Trace(
        "bending moment",
        2,
        lambda u: (
            -stiffness * (u.along(0, u.normal, u.normal) + nu * u.curvature * u.along(0, u.normal)) - u.at(m)
        ),
    )


def shear(v: Field | float, poisson_ratio: float, stiffness: float = 1.0) -> Trace:
    """-D (u_nnn + u_ttn + (1 - nu)(u_ntt + kappa (u_tt - u_nn))) = v."""

    def residual(u: BoundaryJets) -> Array:
        n, t = u.normal, u.tangent
        twist = u.along(0, n, t, t) + u.curvature * (u.along(0, t, t) - u.along(0, n, n))
        return np.asarray(
            -stiffness * (u.along(0, n, n, n) + u.along(0, t, t, n) + (1 - poisson_ratio) * twist) - u.at(v)
        )

    return Trace("Kirchhoff shear", 3, residual)


def normal_component(g: Field | float) -> Trace:
    """N . u = g."""
    return Trace("normal component", 0, lambda u: np.einsum("dn,dn->n", u.normal, u.values[:, 0]) - u.at(g))


def tangential_components(given: Sequence[Field | float]) -> Trace:
    """U - n (n . u) = t - n (n . t)."""

    def residual(u: BoundaryJets) -> Array:
        gap = u.values[:, 0] - np.stack([u.at(g) for g in given])
        return np.asarray(gap - u.normal * np.einsum("dn,dn->n", u.normal, gap))

    return Trace("tangential components", 0, residual)


def traction(given: Sequence[Field | float | None], lame: tuple[float, float]) -> Trace:
    """(lambda div u + mu (grad u + grad u^T)) n = t, for the components that are given."""

    def residual(u: BoundaryJets) -> Array:
        force = _force(u, lame)
        return np.stack([force[c] - u.at(g) for c, g in enumerate(given) if g is not None])

    return Trace("traction", 1, residual)


def tangential_traction(given: Sequence[Field | float], lame: tuple[float, float]) -> Trace:
    """The part of the traction along the boundary."""

    def residual(u: BoundaryJets) -> Array:
        gap = _force(u, lame) - np.stack([u.at(g) for g in given])
        return np.asarray(gap - u.normal * np.einsum("dn,dn->n", u.normal, gap))

    return Trace("tangential traction", 1, residual)


def _force(u: BoundaryJets, lame: tuple[float, float]) -> Array:
    """Return sigma n, one row a component."""
    axes = range(len(u.points))
    slope = np.array([[u.d(c, j) for j in axes] for c in axes])
    stress = lame[1] * (slope + slope.swapaxes(0, 1))
    for c in axes:
        stress[c, c] += lame[0] * np.trace(slope)
    return np.asarray(np.einsum("cjn,jn->cn", stress, u.normal))


def boundary_frame(domain: Shape, part: Part, points: Array) -> tuple[Array, Array]:
    """Return outward unit normals ``(d, n)`` and curvatures div n ``(n,)`` of the surfaces at boundary points."""
    normal, curvature = np.full(points.shape, np.nan), np.full(points.shape[1], np.nan)
    best = np.full(points.shape[1], np.inf)
    dimension = len(points)
    place = {alpha: k for k, alpha in enumerate(multi_indices(dimension, 2))}
    unit = np.eye(dimension, dtype=int)
    for surface in part.surfaces:
        jets = partials(surface.function, tuple(points), 2)
        slope = jets[1 : dimension + 1]
        length = np.sqrt((slope**2).sum(axis=0))
        hessian = np.array([[jets[place[tuple((a + b).tolist())]] for b in unit] for a in unit])
        direction = slope / length
        bend = (np.trace(hessian) - np.einsum("in,ijn,jn->n", direction, hessian, direction)) / length
        step = 1e-6 * direction
        inside = partials(domain.sign, tuple(points + step), 0)[0]
        outside = partials(domain.sign, tuple(points - step), 0)[0]
        sign = np.where(inside > outside, -1.0, 1.0)
        nearer = np.abs(jets[0]) / length < best
        best = np.where(nearer, np.abs(jets[0]) / length, best)
        normal = np.where(nearer, sign * direction, normal)
        curvature = np.where(nearer, sign * bend, curvature)
    return normal, curvature
