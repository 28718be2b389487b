"""Free edge of a plate: bending moment M u = m and Kirchhoff's shear force V u = v.

    u1 = psi - w^2/2 (m - M psi) / D,    u = u1 + w^3/6 (v - V u1) / D + w^4 psi2,

M and V of :mod:`structures.catalogue.plate_conditions` with n = -grad w.  M has the symbol -D, V the symbol
D, and the second correction sees the field of the first.  V u1 on the edge contains third derivatives of psi;
the general rule (:mod:`structures.catalogue.rule`) drops the fourth and fifth, which would be multiplied with
w.

At a corner of a free plate the twisting moments leave a force as third condition; it is not in this structure.
"""

from __future__ import annotations

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.plate_conditions import Moment, Shear
from structures.catalogue.rule import completed
from structures.catalogue.samples import PLATE, first, second
from structures.features import normalised
from structures.field_expression import FieldExpr
from structures.layers import layer
from structures.operator import Operator, unknown


def free(
    w: Field | FieldExpr,
    poisson_ratio: float,
    moment: Datum = 0.0,
    shear: Datum = 0.0,
    stiffness: Datum = 1.0,
) -> Operator:
    """Return u with bending moment m and shear force v where w vanishes.

    Parameters
    ----------
    w
        Normalised to first order, in the plane.
    poisson_ratio, stiffness
        nu and D.
    moment, shear
        m and v.
    """
    conditions = [Moment(moment, poisson_ratio, stiffness), Shear(shear, poisson_ratio, stiffness)]
    (u,) = completed([layer(w, [unknown(2)])], conditions)
    return u


def examples() -> list[OnBoundary]:
    """An elliptic plate with a hole, loaded on both edges."""
    u = free(normalised(PLATE, PLATE.part("all"), 1), 0.3, first, second, 2.0)
    loads = traces.moment(first, 0.3, 2.0), traces.shear(second, 0.3, 2.0)
    return [OnBoundary(PLATE, [u], [(PLATE.part(p), load) for p in ("rim", "hole") for load in loads])]


ENTRY = Entry(
    name="free-edge",
    satisfies="bending moment M u = m and Kirchhoff shear V u = v",
    formula="u = u1 + w^3/6 (v - V u1)/D + w^4 psi2, u1 = psi - w^2/2 (m - M psi)/D",
    conditions=("bending moment", "Kirchhoff shear"),
    unknowns=2,
    normalisation=1,
    derivatives=3,
    examples=examples,
)
