"""Weights: smooth functions, positive inside, zero to first order exactly on a part of the boundary.

The weight w of the structure ``u = u0 + w psi`` is the *product* of the factors of
``rfm.geometry.vanishing``.  R-conjunctions have the right zero set too, but at every convex corner
they leave a kink of type r in psi, which costs two orders; the product of smooth factors is smooth.

Two things limit the raw product, both measured with a constant load (docs/geometry.md):

* Holes.  Each factor grows from zero to many hole radii, u does not: with many holes the product
  spans orders of magnitude and psi with it.  Then holes are *saturated*: ``f / (1 + f/d)`` with
  ``d = 1.4 peak`` where f is the outside of a disk, ball, ellipse, round cylinder or torus.  Such an f
  is bounded below by ``-peak`` in all of space, so there is no pole, and u ~ log r gives an analytic
  psi.  Other holes take ``f / sqrt(1 + (f/d)^2)``, d the feature's size, which has no pole at all.
* Many outlines that meet at obtuse corners (a polygon of many sides): u vanishes there like
  ``r^(pi/angle)``, the product like ``r^2``, and psi is unbounded.  Then the outlines are joined by
  the R0-conjunction, which vanishes like r.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TypeAlias

from rfm.calculus.functions import sqrt
from rfm.calculus.r_systems import NAMES, R0, RSystem
from rfm.calculus.r_systems import system as r_system
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.distance import distance
from rfm.geometry.part import Part, union
from rfm.geometry.shape import Shape
from rfm.geometry.vanishing import Factor, Joined, Product, factors
from rfm.geometry.weight_forms import FORMS, form

FEW_HOLES = 3
"""Up to so many holes ``auto`` takes the raw product (an annulus has one)."""

FEW_OUTLINES = 6
"""Up to so many outlines are multiplied, as many as a box has; more are joined by R0."""

_CLEARANCE = 1.4


Weighting: TypeAlias = str | RSystem
"""How a weight is built: a name that :func:`weight` knows, or a system of R-functions itself."""


def weight(shape: Shape, part: Part | Iterable[Part], system: Weighting = "auto") -> Field:
    """Return a weight for a part of the boundary of a shape.

    Parameters
    ----------
    shape
        The domain.
    part
        Where the weight vanishes: a part of the shape, or several.
    system
        ``product``: raw product of the factors; ``saturated``: holes saturated, more than six
        outlines joined by R0; ``auto``: like ``product`` for up to three holes and six outlines,
        otherwise like ``saturated`` for what is more; a system of R-functions or the name of one
        (``r0``, ``r0m2``, ``rp2``, ``spline2``), whose conjunction then joins the factors; or a form with its
        parameters, ``scaled:beta5:alpha2`` of the automatic weight, ``plateau:delta0.1:gamma3`` of the distance
        (``rfm.geometry.weight_forms``).

    Returns
    -------
    Field
        Positive in the closed shape except on the part; the constant 1 for an empty part.

    Raises
    ------
    GeometryError
        For an unknown system, or a parameter out of range.
    """
    wanted = part if isinstance(part, Part) else union(part)
    if isinstance(system, RSystem):
        return _conjunction(factors(shape.expression, wanted, system), system)
    levelled = form(system)
    if levelled is not None and wanted.surfaces:
        return levelled((distance if levelled.of_distance else weight)(shape, wanted))
    combine = COMBINATIONS.get("auto" if levelled else system)
    if combine is not None:
        return combine(factors(shape.expression, wanted, R0))
    try:
        chosen = r_system(system)
    except GeometryError as error:
        if not str(error).startswith("unknown"):
            raise  # a parameter out of range
        known = ", ".join([*COMBINATIONS, *FORMS, *NAMES])
        raise GeometryError(f"unknown weight {system!r}; choose one of {known}") from None
    return _conjunction(factors(shape.expression, wanted, chosen), chosen)


def analytic_across(shape: Shape, system: Weighting) -> bool:
    """Whether the weights of a shape go on smoothly across its boundary, so that nodes outside may be used."""
    used = list(shape.expression.systems())
    if isinstance(system, RSystem):
        used.append(system)
    elif system not in COMBINATIONS and form(system) is None:
        used.append(r_system(system))
    return all(one.analytic_across for one in used)


@dataclass(frozen=True, eq=False)
class Rational:
    """``f / (1 + f / size)``: slope of f at its zeros, below ``size``; needs ``f > -size``."""

    field: Field
    size: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value = self.field(*coords)
        return value / (1.0 + value * (1.0 / self.size))


@dataclass(frozen=True, eq=False)
class Bounded:
    """``f / sqrt(1 + (f / size)^2)``: slope of f at its zeros, between -size and size everywhere."""

    field: Field
    size: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value = self.field(*coords)
        return value / sqrt(1.0 + (value * value) * (1.0 / self.size**2))


def _one(*coords: Value) -> Value:
    return 1.0


def _product(given: list[Factor]) -> Field:
    fields = tuple(factor.field for factor in given)
    return fields[0] if len(fields) == 1 else Product(fields) if fields else _one


def _saturated(given: list[Factor], few_holes: int = 0) -> Field:
    outlines = [factor for factor in given if not factor.hole]
    holes = [factor for factor in given if factor.hole]
    if len(outlines) > FEW_OUTLINES:
        joined = _conjunction(outlines, R0)
        outlines = [Factor(joined, tuple(s for factor in outlines for s in factor.surfaces), hole=False)]
    if len(holes) > few_holes:
        holes = [replace(factor, field=_limited(factor)) for factor in holes]
    return _product([*outlines, *holes])


def _auto(given: list[Factor]) -> Field:
    return _saturated(given, FEW_HOLES)


def _limited(factor: Factor) -> Field:
    if factor.depth < math.inf:
        return Rational(factor.field, _CLEARANCE * factor.depth)
    return Bounded(factor.field, factor.size) if factor.size < math.inf else factor.field


def _conjunction(given: list[Factor], system: RSystem) -> Field:
    fields = tuple(factor.field for factor in given)
    return fields[0] if len(fields) == 1 else Joined(fields, system) if fields else _one


COMBINATIONS: MappingProxyType[str, Callable[[list[Factor]], Field]] = MappingProxyType(
    {"auto": _auto, "product": _product, "saturated": _saturated}
)
"""How the factors of a weight are put together, by name."""
