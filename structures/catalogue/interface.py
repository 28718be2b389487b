"""Interface between two materials: continuity of value and flux, or given jumps of both.

w is positive in material 1, negative in material 2, with unit slope on the interface w = 0.  One psi for both
and

    u1 = psi + s + w F + w^2 psi1,    u2 = psi - w F + w^2 psi2,
    (k1 + k2) F = q - k1 D (psi + s) + k2 D psi,    D = grad w . grad,

satisfy u1 - u2 = s and k1 D u1 - k2 D u2 = q there.  The kink is shared evenly by both sides, so that for
equal conductivities and no jumps F vanishes and u is smooth.  The general rule
(:mod:`structures.catalogue.rule`) for the two fields together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Field
from rfm.geometry.shape import Shape
from structures.catalogue.condition import Datum
from structures.catalogue.entry import COUNT, Entry, Example, jets_of, random_fields, random_points
from structures.catalogue.samples import BALL, ELLIPSE, first, positive, second
from structures.catalogue.traces import BoundaryJets, boundary_frame
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.operator import D, Operator, unknown


def interface(
    w: Field | FieldExpr,
    dimension: int,
    conductivities: tuple[Datum, Datum],
    jump: Datum = 0.0,
    flux_jump: Datum = 0.0,
) -> tuple[Operator, Operator]:
    """Return (u1, u2), the field in the material where w > 0 and where w < 0.

    Parameters
    ----------
    w
        Normalised to first order on the interface, from both sides.
    dimension
        Number of coordinates.
    conductivities
        (k1, k2).
    jump, flux_jump
        s = u1 - u2 and q = k1 D u1 - k2 D u2 on the interface, D the derivative towards material 1.
    """
    w, s, q = field(w), field(jump), field(flux_jump)
    k1, k2 = (field(k) for k in conductivities)
    psi, psi1, psi2 = (unknown(dimension, m) for m in range(3))
    F = (q - k1 * D(w, psi + s) + k2 * D(w, psi)) / (k1 + k2)
    return psi + s + w * F + w**2 * psi1, psi - w * F + w**2 * psi2


@dataclass(frozen=True, eq=False)
class Joined(Example):
    """Two sides of the boundary of an inclusion."""

    inclusion: Shape
    operators: Sequence[Operator]
    conductivities: tuple[Field, Field]
    jumps: tuple[Field, Field]

    def residual(self, seed: int, count: int = COUNT) -> dict[str, float]:
        """See :meth:`Example.residual`."""
        rng = np.random.default_rng(seed)
        psi, part = random_fields(self.operators, rng), self.inclusion.part("all")
        points = random_points(self.inclusion, part, rng, count)
        normal, curvature = boundary_frame(self.inclusion, part, points)
        u = BoundaryJets(points, normal, curvature, jets_of(self.operators, psi, points, 1))
        flux = [u.at(k) * u.along(c, -normal) for c, k in enumerate(self.conductivities)]
        scale = np.maximum(1.0, np.abs(u.values).max(axis=(0, 1)))
        gaps = u.d(0) - u.d(1) - u.at(self.jumps[0]), flux[0] - flux[1] - u.at(self.jumps[1])
        return {
            name: float((np.abs(gap) / scale).max())
            for name, gap in zip(("value jump", "flux jump"), gaps, strict=True)
        }


def examples() -> list[Joined]:
    """An ellipse and an ellipsoid in another material, with jumps."""
    found = []
    for shape in (ELLIPSE, BALL):
        w = normalised(shape, shape.part("all"), 1)
        pair = interface(w, shape.dimension, (positive, 3.0), first, second)
        found.append(Joined(shape, pair, (positive, lambda *x: 3.0), (first, second)))
    return found


ENTRY = Entry(
    name="interface",
    satisfies="u1 - u2 = s and k1 du1/dn - k2 du2/dn = q between two materials",
    formula="u1 = psi + s + w F + w^2 psi1, u2 = psi - w F + w^2 psi2, (k1 + k2) F = q - k1 D(psi + s) + k2 D psi",
    conditions=("value jump", "flux jump"),
    unknowns=3,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
