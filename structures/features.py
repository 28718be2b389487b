"""Features: points, curves and regions that carry data, with functions that vanish exactly on them.

The weights of transfinite interpolation (Shapiro, Acta Numerica 16, 2007, (7.10)) need omega >= 0, zero on the
feature only.  Three kinds:

    point    |x - p|; not smooth at p, its even powers are
    curve    a part of a boundary (in space: a surface), omega normalised
    region   a shape: zero in all of it, positive outside

A feature has a dimension; a normal exists on features of codimension one only.

Notation: omega as in the paper, mu the exponent of a weight, d the number of coordinates.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.functions import guarded_power, maximum, sqrt
from rfm.calculus.types import Array, Field, Value
from rfm.errors import StructureError
from rfm.geometry.distance import distance
from rfm.geometry.normalisation import normalise
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.contact import boundary_points, size_of, spread_points
from structures.field_expression import FieldExpr, field
from structures.jet_matrix import evaluate
from structures.operator import known


class Feature(ABC):
    """Something that carries data.

    Attributes
    ----------
    name
        For messages.
    dimension
        0 for a point, d - 1 for a boundary, d for a region.
    """

    name: str
    dimension: int

    @abstractmethod
    def raised(self, mu: float) -> FieldExpr:
        """Return omega^mu, as smooth as it can be."""

    def normalised(self, order: int) -> FieldExpr:
        """Return omega with unit normal slope and vanishing derivatives up to ``order`` along the normal.

        Raises
        ------
        StructureError
            When the feature has no normal.
        """
        kind = "a point" if self.dimension == 0 else "a region"
        raise StructureError(
            f"{self.name} is {kind} and has no normal: prescribe a value there, "
            "or a normal derivative on a curve (in space a surface)"
        )


@dataclass(frozen=True, eq=False)
class Point(Feature):
    """A point p; omega = |x - p|, and omega^mu a polynomial for even mu."""

    at: tuple[float, ...]
    name: str = "point"
    dimension: int = 0

    def raised(self, mu: float) -> FieldExpr:
        """Return |x - p|^mu."""
        return field(_PowerOfDistance(self.at, mu))


@dataclass(frozen=True, eq=False)
class Curve(Feature):
    """A part of the boundary of a shape; omega its normalised distance, positive inside the shape."""

    shape: Shape
    part: Part

    @property
    def name(self) -> str:  # type: ignore[override]
        """Name of the part."""
        return self.part.name

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """One less than the shape's."""
        return self.shape.dimension - 1

    def raised(self, mu: float) -> FieldExpr:
        """Return omega^mu."""
        return field(distance(self.shape, self.part)) ** mu

    def normalised(self, order: int) -> FieldExpr:
        """Return the distance, after a look at whether the shape is smooth enough for that order."""
        return normalised(self.shape, self.part, order)


@dataclass(frozen=True, eq=False)
class Region(Feature):
    """A shape; omega is zero in it and its (normalised) membership outside: mu - 1 continuous derivatives."""

    shape: Shape
    name: str = "region"

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """That of the shape."""
        return self.shape.dimension

    def raised(self, mu: float) -> FieldExpr:
        """Return max(0, -f)^mu, f the membership."""
        return field(_Outside(normalise(self.shape.membership, self.shape.dimension), mu))


def feature(of: Feature | Shape | Sequence[float], part: Part | None = None) -> Feature:
    """Return a point for coordinates, a region for a shape, a curve for a shape and a part of it."""
    if isinstance(of, Feature):
        return of
    if isinstance(of, Shape):
        return Region(of) if part is None else Curve(of, part)
    return Point(tuple(float(x) for x in of))


SAMPLES = 128
HALVINGS = 3
STEP = 0.02  # of the domain's size: far above rounding for high orders, below most features


def normalised(domain: Shape, part: Part, order: int) -> FieldExpr:
    """Return w of a part, normalised to an order that the shape really has.

    The distance of :func:`rfm.geometry.distance.distance`, after a look at whether the part's functions are
    smooth enough.

    Parameters
    ----------
    domain, part
        The shape and a part of its boundary.
    order
        w = t + O(t^(order + 1)) at the distance t from the part, away from its corners.

    Raises
    ------
    StructureError
        When the part's functions have too few derivatives, measured by the order of w - t.
    """
    w = field(distance(domain, part, order))
    reached = _contact_order(w, domain, part, order) if order > 1 else order
    if reached < order:
        raise StructureError(
            f"{part.name} cannot be normalised to order {order}: its function has about {reached} continuous "
            f"derivatives across it; take a condition of lower order, or replace abs, min and max in the shape's "
            f"function"
        )
    return w


def _contact_order(w: FieldExpr, domain: Shape, part: Part, order: int) -> int:
    """Measure k in w(p + t N) = t + O(t^(k+1)); the median over points p does not see corners."""
    points = boundary_points(domain, part, spread_points(domain, SAMPLES)).T
    if not points.size:
        return order
    inward = expansion(w, points, 1)[1:]
    largest = STEP * size_of(domain)
    errors = []
    with np.errstate(all="ignore"):  # derivatives that do not exist show as an order that is not reached
        for t in largest / 2.0 ** np.arange(HALVINGS + 1):
            along = expansion(w, points + t * inward, 0)[0]
            errors.append(np.nan_to_num(np.abs(along - t), nan=np.inf))
        tiny = np.array(errors[1:]) < 1e-12 * largest
        orders = np.where(tiny, np.inf, np.log2(np.array(errors[:-1]) / errors[1:]))
    # the next features of a shape are near at the first step, rounding at the last
    measured = np.nanmax(np.where(np.isnan(orders), -np.inf, orders), axis=0)
    middle = float(np.median(np.nan_to_num(measured, neginf=0.0, posinf=99.0)))
    return order if middle > order + 0.5 else max(0, round(middle) - 1)


def expansion(f: FieldExpr, points: Array, order: int) -> Array:
    """Return the partial derivatives ``(n_alpha, n)`` of a field at points ``(d, n)``, sharing evaluations."""
    return evaluate(known(len(points), f), tuple(points), order).offset


@dataclass(frozen=True, eq=False)
class _PowerOfDistance:
    center: tuple[float, ...]
    mu: float

    def __call__(self, *coords: Value) -> Value:
        squared: Value = 0.0
        for x, c in zip(coords, self.center, strict=True):
            squared = squared + (x - c) * (x - c)
        half = self.mu / 2
        return squared ** int(half) if half == int(half) else guarded_power(squared, half)


@dataclass(frozen=True, eq=False)
class _Outside:
    inside: Field
    mu: float

    def __call__(self, *coords: Value) -> Value:
        outside = maximum(-self.inside(*coords), 0.0)
        whole = int(self.mu)
        return outside**whole if whole == self.mu else sqrt(outside) ** (2 * self.mu)
