"""Conditions on a scalar field: value, flux, Robin, oblique derivative.

Notation: N = grad w the unit normal into the domain, n = -N outward; data follow the conventions of the
program: fluxes are outward conormal ones, ``n . K grad u``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rfm.errors import StructureError
from structures.catalogue.condition import Datum, ScalarCondition, reciprocal
from structures.field_expression import ZERO, FieldExpr, field
from structures.layers import Layers, directional, slopes
from structures.operator import Operator


@dataclass(frozen=True, eq=False)
class Value(ScalarCondition):
    """u = g."""

    name: str = "value"
    order: int = 0

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return u."""
        return [u[0].trace]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """The symbol is one."""
        return [residual[0]]


@dataclass(frozen=True, eq=False)
class Flux(ScalarCondition):
    """k du/dn + h u = g, n outward: Neumann (h = 0) and Robin conditions.

    The symbol is -k: grad w has length one on the part.
    """

    conductivity: Datum = 1.0
    coefficient: Datum = 0.0
    name: str = "flux"
    order: int = 1

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return -k N . grad u + h u."""
        inward = directional(slopes(u[0].w, u[0].dimension), u[0]).trace
        return [field(self.coefficient) * u[0].trace - field(self.conductivity) * inward]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Divide by -k."""
        return [residual[0] * (-1.0 / field(self.conductivity))]


@dataclass(frozen=True, eq=False)
class Oblique(ScalarCondition):
    """l . grad u + h u = g with any direction l that is nowhere tangential.

    The symbol is l . N.
    """

    direction: tuple[Datum, ...]
    coefficient: Datum = 0.0
    name: str = "oblique derivative"
    order: int = 1

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return l . grad u + h u."""
        return [directional(self._along(u[0].dimension), u[0]).trace + field(self.coefficient) * u[0].trace]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Divide by l . N."""
        dimension = residual[0].dimension
        pairs = zip(self._along(dimension), slopes(w, dimension), strict=True)
        return [residual[0] * reciprocal(_sum(a * b for a, b in pairs), w)]

    def _along(self, dimension: int) -> tuple[FieldExpr, ...]:
        if len(self.direction) != dimension:
            raise StructureError(
                f"the direction of an oblique derivative has {len(self.direction)} components in "
                f"{dimension} dimensions; give {dimension}"
            )
        return tuple(field(component) for component in self.direction)


@dataclass(frozen=True, eq=False)
class AnisotropicFlux(ScalarCondition):
    """n . K grad u + h u = g with a symmetric positive definite matrix K.

    The symbol is -N . K N.
    """

    conductivity: tuple[tuple[Datum, ...], ...]
    coefficient: Datum = 0.0
    name: str = "flux"
    order: int = 1

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return -(K N) . grad u + h u."""
        flux = directional(self._conormal(u[0].w), u[0]).trace
        return [field(self.coefficient) * u[0].trace - flux]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Divide by -N . K N."""
        pairs = zip(self._conormal(w), slopes(w, residual[0].dimension), strict=True)
        return [residual[0] * (-reciprocal(_sum(a * b for a, b in pairs), w))]

    def _conormal(self, w: FieldExpr) -> list[FieldExpr]:
        normal = slopes(w, len(self.conductivity))
        return [_sum(field(k) * s for k, s in zip(row, normal, strict=True)) for row in self.conductivity]


def _sum(terms: Iterable[FieldExpr]) -> FieldExpr:
    return sum(terms, start=ZERO)
