"""Natural conditions of the Kirchhoff plate: bending moment and Kirchhoff's shear force.

With the stiffness D and Poisson's ratio nu (Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells,
section 22), n outward, t = (-n_y, n_x) along the edge, H the matrix of second derivatives:

    M = -D (nu lap u + (1 - nu) n . H n)
    V = -D (d(lap u)/dn + (1 - nu) d(n . H t)/ds),

and where D varies, V = n . div m + d(n . m t)/ds with the moments m = -D (nu lap u I + (1 - nu) H).

d/ds acts on n and t too; that is the curvature kappa of the edge: d(n . H t)/ds = u_ntt + kappa (u_tt -
u_nn), and with u = 0 on the edge M = -D (u_nn + nu kappa u_n).  Here n = -grad w and t are fields, whose
derivatives along the edge are right because grad w is the unit normal all along it: first-order normalisation
suffices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rfm.errors import StructureError
from structures.catalogue.condition import Datum, ScalarCondition
from structures.field_expression import FieldExpr, differentiate, field, is_constant, unit
from structures.layers import Layers, directional, partial, slopes
from structures.operator import Operator


@dataclass(frozen=True, eq=False)
class Moment(ScalarCondition):
    """Bending moment M = m; its symbol is -D."""

    poisson_ratio: float
    stiffness: Datum = 1.0
    name: str = "bending moment"
    order: int = 2

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return M u."""
        normal = _plane(slopes(u[0].w, u[0].dimension))
        bending = self.poisson_ratio * _laplacian(u[0]) + (1.0 - self.poisson_ratio) * _second(
            normal, normal, u[0]
        )
        return [(-1.0 * field(self.stiffness)) * bending.trace]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Divide by -D."""
        return [residual[0] * (-1.0 / field(self.stiffness))]


@dataclass(frozen=True, eq=False)
class Shear(ScalarCondition):
    """Kirchhoff's shear force V = v; its symbol is D (outward derivatives against the inward slope of w)."""

    poisson_ratio: float
    stiffness: Datum = 1.0
    name: str = "Kirchhoff shear"
    order: int = 3

    def applied(self, u: Sequence[Layers]) -> list[Operator]:
        """Return V u = n . div m + d(n . m t)/ds, m = -D (nu lap u I + (1 - nu) H)."""
        n = tuple(-slope for slope in _plane(slopes(u[0].w, u[0].dimension)))
        t = (-n[1], n[0])
        stiffness, bending = field(self.stiffness), _laplacian(u[0])
        changes = tuple(differentiate(stiffness, unit(2, axis)) for axis in range(2))
        twist = (1.0 - self.poisson_ratio) * _second(n, t, u[0])
        shear = stiffness * directional(n, bending) + directional(t, stiffness * twist)
        if not all(is_constant(change, 0.0) for change in changes):
            across = changes[0] * n[0] + changes[1] * n[1]
            shear = shear + (self.poisson_ratio * across) * bending
            shear = shear + (1.0 - self.poisson_ratio) * _second(n, changes, u[0])
        return [-shear.trace]

    def solved(self, residual: Sequence[Operator], w: FieldExpr) -> list[Operator]:
        """Divide by D."""
        return [residual[0] * (1.0 / field(self.stiffness))]


def _plane(vector: tuple[FieldExpr, ...]) -> tuple[FieldExpr, ...]:
    if len(vector) != 2:
        raise StructureError(
            f"plate conditions are for edges in the plane, got {len(vector)} dimensions: "
            "use traction conditions for solids"
        )
    return vector


def _laplacian(u: Layers) -> Layers:
    return partial(partial(u, 0), 0) + partial(partial(u, 1), 1)


def _second(a: Sequence[FieldExpr], b: Sequence[FieldExpr], u: Layers) -> Layers:
    """Return a . H b."""
    slope = [partial(u, 0), partial(u, 1)]
    return (
        (a[0] * b[0]) * partial(slope[0], 0)
        + (a[0] * b[1] + a[1] * b[0]) * partial(slope[0], 1)
        + (a[1] * b[1]) * partial(slope[1], 1)
    )
