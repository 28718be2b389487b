"""Carrier functions: the smooth fields of which surfaces are made.

Each is a small frozen object, callable on coordinates of any kind (numbers, arrays, jets, intervals,
device arrays), and knows its image under a similarity.  ``|grad f| = 1`` on the carrier wherever a
*polynomial* can have that: ``(R^2 - r^2) / (2 R)`` for circles, spheres and round cylinders, the
signed distance for lines and planes (Shapiro, Acta Numerica 2007, section 4: normalised primitives).
Polynomials come first because quadrature and the weights are exact and cheap on them; where a
normalised function is needed, ``rfm.geometry.distance`` normalises.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from rfm.calculus.types import Array, Field, Value
from rfm.geometry.similarity import Similarity


@runtime_checkable
class Carrier(Protocol):
    """A field that can be moved without wrapping it."""

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""

    def moved(self, similarity: Similarity) -> Field:
        """Return the field of the moved shape, scaled so that a normalised one stays so."""


@dataclass(frozen=True)
class Plane:
    """The affine form ``normal . x - offset``; signed distance to a line or plane for a unit normal."""

    normal: tuple[float, ...]
    offset: float

    def __call__(self, *coords: Value) -> Value:
        """Skip vanishing components: keeps jets sparse and ``x - a`` exact."""
        total: Any = None
        for component, coordinate in zip(self.normal, coords, strict=True):
            if component == 0.0:
                continue
            term = coordinate if component == 1.0 else component * coordinate
            total = term if total is None else total + term
        if total is None:  # a constant: the height of a section, for instance
            total = coords[0] * 0.0
        if self.offset == 0.0:
            return total
        return total - self.offset

    def moved(self, similarity: Similarity) -> Plane:
        """See :class:`Carrier`."""
        normal = similarity.matrix @ np.array(self.normal)
        return plane(normal, similarity.scale * self.offset + float(normal @ similarity.shift))


@dataclass(frozen=True)
class Quadric:
    """``constant + sum_i factor_i * form_i(x)^2`` with affine forms; every quadric primitive is one."""

    constant: float
    factors: tuple[float, ...]
    forms: tuple[Plane, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        total: Any = self.constant
        for factor, form in zip(self.factors, self.forms, strict=True):
            value = form(*coords)
            total = total + factor * (value * value)
        return total

    def moved(self, similarity: Similarity) -> Quadric:
        """See :class:`Carrier`."""
        forms = tuple(form.moved(similarity) for form in self.forms)
        scale = similarity.scale
        return Quadric(self.constant * scale, tuple(factor / scale for factor in self.factors), forms)


@dataclass(frozen=True)
class Sphere:
    """``(R^2 - |x - c|^2) / (2 R)``: a circle or a sphere, normalised; its forms survive rotations."""

    center: tuple[float, ...]
    radius: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        total: Any = self.radius * self.radius
        for component, coordinate in zip(self.center, coords, strict=True):
            difference = coordinate - component if component != 0.0 else coordinate
            total = total - difference * difference
        return total * (0.5 / self.radius)

    def moved(self, similarity: Similarity) -> Sphere:
        """See :class:`Carrier`."""
        center = similarity(np.array(self.center))
        return Sphere(tuple(center.tolist()), self.radius * similarity.scale)


@dataclass(frozen=True)
class Torus:
    """``(4 R^2 s^2 - (q + t^2)^2) / (8 r R^2)`` with ``s^2`` across, ``t`` along the axis, ``q = s^2 + R^2 - r^2``.

    The rationalised form of ``(r^2 - (s - R)^2 - t^2) / (2 r)``: a quartic polynomial, smooth on the
    axis too; its gradient on the carrier is ``s / R``.
    """

    major: float
    minor: float
    across: tuple[Plane, Plane]
    along: Plane

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        first, second, height = (form(*coords) for form in (*self.across, self.along))
        across = first * first + second * second
        q = across + height * height + (self.major**2 - self.minor**2)
        return (4.0 * self.major**2 * across - q * q) * (0.125 / (self.minor * self.major**2))

    def moved(self, similarity: Similarity) -> Torus:
        """See :class:`Carrier`."""
        first, second, along = (form.moved(similarity) for form in (*self.across, self.along))
        scale = similarity.scale
        return Torus(self.major * scale, self.minor * scale, (first, second), along)


@dataclass(frozen=True, eq=False)
class Moved:
    """Any field under a similarity: ``scale * field(inverse(x))``."""

    field: Field
    similarity: Similarity
    forms: tuple[Plane, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.similarity.scale * self.field(*(form(*coords) for form in self.forms))

    def moved(self, similarity: Similarity) -> Moved:
        """See :class:`Carrier`."""
        return _wrapped(self.field, composed(similarity, self.similarity))


def move_field(field: Field, similarity: Similarity) -> Field:
    """Field of the moved shape: by its own rule when it has one, wrapped otherwise."""
    return field.moved(similarity) if isinstance(field, Carrier) else _wrapped(field, similarity)


def plane(normal: Array, offset: float) -> Plane:
    """Build a :class:`Plane` from an array, with rounding noise of rotations removed from the normal."""
    clean = np.where(np.abs(normal) < 1e-15 * np.abs(normal).max(), 0.0, normal)
    return Plane(tuple(clean.tolist()), float(offset))


def quadric(constant: float, factors: Array, rows: Array, center: Array) -> Quadric:
    """``constant + sum_i factors_i (rows_i . (x - center))^2``."""
    forms = tuple(plane(row, float(row @ center)) for row in rows)
    return Quadric(float(constant), tuple(np.asarray(factors, dtype=float).tolist()), forms)


def composed(outer: Similarity, inner: Similarity) -> Similarity:
    """Return the similarity ``x -> outer(inner(x))``."""
    return Similarity(outer.matrix @ inner.matrix, outer.scale * inner.scale, outer(inner.shift))


def _wrapped(field: Field, similarity: Similarity) -> Moved:
    back = similarity.inverse()
    rows = back.scale * back.matrix
    forms = tuple(plane(row, -float(shift)) for row, shift in zip(rows, back.shift, strict=True))
    return Moved(field, similarity, forms)
