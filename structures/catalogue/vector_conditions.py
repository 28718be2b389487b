"""Conditions on a vector field: components, normal and tangential displacement, traction.

Notation: N = grad w the unit normal into the domain, n = -N outward; lambda, mu Lame's parameters,
sigma(u) = lambda div u I + mu (grad u + grad u^T).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from structures.catalogue.condition import Datum, ScalarCondition, VectorCondition
from structures.field_expression import ONE, ZERO, FieldExpr, field
from structures.layers import Layers, directional, partial, slopes
from structures.operator import Operator, known


@dataclass(frozen=True, eq=False)
class Components(VectorCondition):
    """u_c = g_c for the components with a value; None leaves a component free."""

    name: str = "components"
    order: int = 0

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return the prescribed components of u."""
        return [u[c].trace for c in self.fixed]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """The symbol is the identity on the prescribed components."""
        return _scattered(residual, self.fixed, self.components)


@dataclass(frozen=True, eq=False)
class Normal(ScalarCondition):
    """n . u = g, n outward: slip on a wall, a roller on a curved one.

    F = n r solves n . F = r, and leaves the tangential displacement alone.
    """

    components: int
    name: str = "normal component"
    order: int = 0

    @property
    def rows(self) -> frozenset[tuple[int, int]]:
        """One of the values, in no fixed direction."""
        return frozenset({(0, -1)})

    @property
    def needs_normal(self) -> bool:
        """Yes."""
        return True

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return -N . u."""
        return [-_dot(slopes(u[0].w, self.components), [component.trace for component in u])]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Return -N r."""
        return [(-1.0 * slope) * residual[0] for slope in slopes(w, self.components)]


@dataclass(frozen=True, eq=False)
class Tangential(VectorCondition):
    """u - n (n . u) = t - n (n . t): no sliding along the wall, free to leave it."""

    name: str = "tangential components"
    order: int = 0

    @property
    def rows(self) -> frozenset[tuple[int, int]]:
        """All values but the normal one."""
        return frozenset((0, -2 - c) for c in range(self.components - 1))

    @property
    def needs_normal(self) -> bool:
        """Yes."""
        return True

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return u: the projection is applied to the whole residual."""
        return [component.trace for component in u]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Return r - N (N . r)."""
        return _projected(residual, w)


@dataclass(frozen=True, eq=False)
class Traction(VectorCondition):
    """(sigma(u) n)_c = t_c, n outward, for the components that are given: all of them, or those that a roller leaves.

    On the part the symbol is sigma F = -(mu F + (lambda + mu) N (N . F)).  With F and N restricted to the given
    components, F = 0 elsewhere, its inverse is

        F = -(r - s N (N . r)) / mu,    s = (lambda + mu) / (mu + (lambda + mu) N . N),

    N . N = 1 where all are given.
    """

    lame: tuple[Datum, Datum]
    name: str = "traction"
    order: int = 1

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return -sigma(u) N."""
        forces = stress_along(slopes(u[0].w, self.components), u, self.lame)
        return [-forces[c].trace for c in self.fixed]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Apply the inverse of the symbol."""
        first, shear = (field(value) for value in self.lame)
        normal = [slopes(w, self.components)[c] for c in self.fixed]
        length: FieldExpr = ONE
        if len(self.fixed) < self.components:
            length = sum((slope * slope for slope in normal), start=ZERO)
        across = ((first + shear) / (shear + (first + shear) * length)) * _dot(normal, residual)
        found = [(r - slope * across) * (-1.0 / shear) for r, slope in zip(residual, normal, strict=True)]
        return _scattered(found, self.fixed, self.components)


@dataclass(frozen=True, eq=False)
class TangentialTraction(VectorCondition):
    """sigma(u) n - n (n . sigma(u) n) = t - n (n . t): friction along a wall, none where a body slips.

    On tangential F the symbol is -mu.
    """

    lame: tuple[Datum, Datum]
    name: str = "tangential traction"
    order: int = 1

    @property
    def rows(self) -> frozenset[tuple[int, int]]:
        """All first derivatives but that of the normal component."""
        return frozenset((1, -2 - c) for c in range(self.components - 1))

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return -sigma(u) N: the projection is applied to the whole residual."""
        forces = stress_along(slopes(u[0].w, self.components), u, (ZERO, self.lame[1]))
        return [-force.trace for force in forces]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Return -(r - N (N . r)) / mu."""
        return [r * (-1.0 / field(self.lame[1])) for r in _projected(residual, w)]


def stress_along(normal: Sequence[FieldExpr], u: Sequence[Layers], lame: tuple[Datum, Datum]) -> list[Layers]:
    """Return sigma(u) N = lambda N div u + mu (grad u + grad u^T) N."""
    first, shear = (field(value) for value in lame)
    axes = range(len(u))
    divergence = partial(u[0], 0)
    for c in axes[1:]:
        divergence = divergence + partial(u[c], c)
    forces = []
    for c in axes:
        force = (first * normal[c]) * divergence + shear * directional(normal, u[c])
        for j in axes:
            force = force + (shear * normal[j]) * partial(u[j], c)
        forces.append(force)
    return forces


def _scattered(found: Sequence[Operator], fixed: Sequence[int], count: int) -> list[Operator]:
    """Return one operator for every component, zero for those not `fixed`."""
    table, nothing = dict(zip(fixed, found, strict=True)), known(found[0].dimension, 0.0)
    return [table.get(c, nothing) for c in range(count)]


def _projected(residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
    """Return r - N (N . r)."""
    normal = slopes(w, len(residual))
    across = _dot(normal, residual)
    return [r - slope * across for r, slope in zip(residual, normal, strict=True)]


def _dot(vector: Sequence[FieldExpr], operators: Sequence[Operator]) -> Operator:
    total = known(operators[0].dimension, ZERO)
    for component, operator in zip(vector, operators, strict=True):
        total = total + component * operator
    return total
