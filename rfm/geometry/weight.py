"""Weights: smooth functions, positive inside, zero to first order exactly on a part of the boundary.

The weight w of the structure ``u = u0 + w psi`` is the *product* of the factors of
``rfm.geometry.vanishing``.  R-conjunctions have the right zero set too, but at every convex corner
they leave a kink of type r in psi, which costs two orders; the product of smooth factors is smooth.

With many factors of small features the product spans orders of magnitude, and psi with it.  Then the
factors are saturated, ``f / sqrt(1 + (f/d)^2)`` with d the feature's size: slope 1 at the boundary,
almost constant (d) away from it, smooth on both sides of the boundary.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import reduce
from types import MappingProxyType

from rfm.calculus.functions import sqrt
from rfm.calculus.r_systems import NAMES, R0, RSystem
from rfm.calculus.r_systems import system as r_system
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.part import Part, union
from rfm.geometry.shape import Shape
from rfm.geometry.vanishing import Factor, factors

FEW_CURVED = 3
"""Up to so many curved factors the raw product is the better weight (annulus: 2, nine holes: 9)."""


def weight(shape: Shape, part: Part | Iterable[Part], system: str = "auto") -> Field:
    """Return a weight for a part of the boundary of a shape.

    Parameters
    ----------
    shape
        The domain.
    part
        Where the weight vanishes: a part of the shape, or several.
    system
        ``product``: raw product of the factors; ``saturated``: product of the saturated factors;
        ``auto``: the raw product for up to three curved factors, otherwise the saturated one; or the
        name of a system of R-functions (``r0``, ``r0m2``, ``rp2``, ``r1``), whose conjunction then
        joins the factors.

    Returns
    -------
    Field
        Positive in the closed shape except on the part; the constant 1 for an empty part.

    Raises
    ------
    GeometryError
        For an unknown system.
    """
    wanted = part if isinstance(part, Part) else union(part)
    combine = COMBINATIONS.get(system)
    if combine is not None:
        return combine(factors(shape.expression, wanted, R0))
    try:
        chosen = r_system(system)
    except GeometryError:
        known = ", ".join([*COMBINATIONS, *NAMES])
        raise GeometryError(f"unknown weight {system!r}; choose one of {known}") from None
    return _conjunction(factors(shape.expression, wanted, chosen), chosen)


@dataclass(frozen=True, eq=False)
class Product:
    """Product of fields."""

    fields: tuple[Field, ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates; 1 without fields."""
        return reduce(lambda first, second: first * second, [field(*coords) for field in self.fields])


@dataclass(frozen=True, eq=False)
class Saturated:
    """``f / sqrt(1 + (f / size)^2)``: slope of f at its zeros, between -size and size everywhere."""

    field: Field
    size: float

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        value = self.field(*coords)
        return value / sqrt(1.0 + (value * value) * (1.0 / self.size**2))


@dataclass(frozen=True, eq=False)
class Joined:
    """R-conjunction of fields."""

    fields: tuple[Field, ...]
    system: RSystem

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return self.system.conjunction(*(field(*coords) for field in self.fields))


def _one(*coords: Value) -> Value:
    return 1.0


def _product(given: list[Factor]) -> Field:
    fields = tuple(factor.field for factor in given)
    return fields[0] if len(fields) == 1 else Product(fields) if fields else _one


def _saturated(given: list[Factor]) -> Field:
    return _product(
        [
            Factor(Saturated(factor.field, factor.size), factor.surfaces)
            if factor.size < float("inf")
            else factor
            for factor in given
        ]
    )


def _auto(given: list[Factor]) -> Field:
    curved = sum(factor.curved for factor in given)
    return (_product if curved <= FEW_CURVED else _saturated)(given)


def _conjunction(given: list[Factor], system: RSystem) -> Field:
    fields = tuple(factor.field for factor in given)
    return fields[0] if len(fields) == 1 else Joined(fields, system) if fields else _one


COMBINATIONS: MappingProxyType[str, Callable[[list[Factor]], Field]] = MappingProxyType(
    {"auto": _auto, "product": _product, "saturated": _saturated}
)
"""How the factors of a weight are put together, by name."""
