"""Conditions on a vector field: components, normal and tangential displacement, traction.

Notation: N = grad w the unit normal into the domain, n = -N outward; lambda, mu Lame's parameters,
sigma(u) = lambda div u I + mu (grad u + grad u^T).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from structures.catalogue.condition import Condition
from structures.catalogue.scalar_conditions import Datum
from structures.field_expression import ZERO, FieldExpr, field
from structures.layers import Layers, directional, partial, slopes
from structures.operator import Operator, known


@dataclass(frozen=True, eq=False)
class Components(Condition):
    """u_c = g_c for the components with a value; None leaves a component free."""

    given: tuple[Datum | None, ...]
    name: str = "components"
    order: int = 0

    @property
    def components(self) -> int:  # type: ignore[override]
        """Number of components of u."""
        return len(self.given)

    @property
    def values(self) -> tuple[FieldExpr, ...]:
        """The prescribed values, without the free ones."""
        return tuple(field(value) for value in self.given if value is not None)

    @property
    def fixed(self) -> tuple[int, ...]:
        """Indices of the prescribed components."""
        return tuple(c for c, value in enumerate(self.given) if value is not None)

    @property
    def rows(self) -> frozenset[tuple[int, int]]:
        """What is determined."""
        return frozenset((0, c) for c in self.fixed)

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return the prescribed components of u."""
        return [u[c].trace for c in self.fixed]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """The symbol is the identity on the prescribed components."""
        found = dict(zip(self.fixed, residual, strict=True))
        nothing = known(residual[0].dimension, 0.0)
        return [found.get(c, nothing) for c in range(len(self.given))]


@dataclass(frozen=True, eq=False)
class Normal(Condition):
    """n . u = g, n outward: slip on a wall, a roller on a curved one.

    F = n r solves n . F = r, and leaves the tangential displacement alone.
    """

    value: Datum
    components: int
    name: str = "normal component"
    order: int = 0

    @property
    def values(self) -> tuple[FieldExpr, ...]:
        """The prescribed g."""
        return (field(self.value),)

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
class Tangential(Condition):
    """u - n (n . u) = t: no sliding along the wall, free to leave it."""

    given: tuple[Datum, ...]
    name: str = "tangential components"
    order: int = 0

    @property
    def components(self) -> int:  # type: ignore[override]
        """Number of components of u."""
        return len(self.given)

    @property
    def values(self) -> tuple[FieldExpr, ...]:
        """The prescribed vector; only its tangential part counts."""
        return tuple(field(value) for value in self.given)

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
        normal = slopes(w, self.components)
        across = _dot(normal, residual)
        return [r - slope * across for r, slope in zip(residual, normal, strict=True)]


@dataclass(frozen=True, eq=False)
class Traction(Condition):
    """sigma(u) n = t, n outward.

    On the part the symbol is sigma F = -(mu F + (lambda + mu) N (N . F)), whose inverse is

        F = -(r - (lambda + mu) / (lambda + 2 mu) N (N . r)) / mu.
    """

    given: tuple[Datum, ...]
    lame: tuple[Datum, Datum]
    name: str = "traction"
    order: int = 1

    @property
    def components(self) -> int:  # type: ignore[override]
        """Number of components of u."""
        return len(self.given)

    @property
    def values(self) -> tuple[FieldExpr, ...]:
        """The prescribed t."""
        return tuple(field(value) for value in self.given)

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return -sigma(u) N."""
        first, shear = (field(value) for value in self.lame)
        axes = range(self.components)
        normal = slopes(u[0].w, self.components)
        divergence = partial(u[0], 0)
        for c in axes[1:]:
            divergence = divergence + partial(u[c], c)
        forces = []
        for c in axes:
            force = (first * normal[c]) * divergence + shear * directional(normal, u[c])
            for j in axes:
                force = force + (shear * normal[j]) * partial(u[j], c)
            forces.append(-force.trace)
        return forces

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Apply the inverse of the symbol."""
        first, shear = (field(value) for value in self.lame)
        normal = slopes(w, self.components)
        across = ((first + shear) / (first + 2.0 * shear)) * _dot(normal, residual)
        return [(r - slope * across) * (-1.0 / shear) for r, slope in zip(residual, normal, strict=True)]


def _dot(vector: Sequence[FieldExpr], operators: Sequence[Operator]) -> Operator:
    total = known(operators[0].dimension, ZERO)
    for component, operator in zip(vector, operators, strict=True):
        total = total + component * operator
    return total
