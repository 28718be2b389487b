"""Simply supported edge of a plate: u = g and the bending moment -D (nu lap u + (1 - nu) u_nn) = m.

    u = u1 - w^2/2 (m/D + nu lap u1 + (1 - nu) N . H(u1) N) + w^3 psi2,    u1 = g + w psi,

N = grad w, H the matrix of second derivatives.  On the edge lap(w psi) = psi lap w + 2 D psi: lap w = -kappa
is the curvature of the edge (kappa = 1/R on a disk) when w is normalised to second order, so that with g = 0
the condition reads -D (u_nn + nu kappa u_n) = m.  Only the boundary values of the bracket count: the general
rule (:mod:`structures.catalogue.rule`) finds them without second derivatives of psi.
"""

from __future__ import annotations

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.plate_conditions import Moment
from structures.catalogue.rule import completed
from structures.catalogue.samples import PLATE, first, second
from structures.features import normalised
from structures.field_expression import FieldExpr
from structures.layers import layer
from structures.operator import Operator, known, unknown


def supported(
    w: Field | FieldExpr,
    poisson_ratio: float,
    value: Datum = 0.0,
    moment: Datum = 0.0,
    stiffness: Datum = 1.0,
) -> Operator:
    """Return u with u = g and bending moment m where w vanishes.

    Parameters
    ----------
    w
        Normalised to first order, in the plane.
    poisson_ratio, stiffness
        nu and D.
    value, moment
        g and m.
    """
    deflection = layer(w, [known(2, value), unknown(2)])
    (u,) = completed([deflection], [Moment(moment, poisson_ratio, stiffness)])
    return u


def examples() -> list[OnBoundary]:
    """An elliptic plate with a hole: given deflection and moment; zero deflection with the curvature term."""
    w, parts = normalised(PLATE, PLATE.part("all"), 1), [PLATE.part(p) for p in ("rim", "hole")]
    given = [(p, t) for p in parts for t in (traces.value(first), traces.moment(second, 0.3, 2.0))]
    zero = [(p, t) for p in parts for t in (traces.value(0.0), traces.moment_on_support(second, 0.3))]
    return [
        OnBoundary(PLATE, [supported(w, 0.3, first, second, 2.0)], given),
        OnBoundary(PLATE, [supported(w, 0.3, 0.0, second)], zero),
    ]


ENTRY = Entry(
    name="simply-supported",
    satisfies="u = g and -D (nu lap u + (1 - nu) u_nn) = m",
    formula="u = u1 - w^2/2 (m/D + nu lap u1 + (1 - nu) N.H(u1)N) + w^3 psi2, u1 = g + w psi",
    conditions=("value", "bending moment"),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
