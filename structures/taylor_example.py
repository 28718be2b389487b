"""Two generalised Taylor polynomials and their transfinite interpolant, after Example 7.1 of the survey.

Shapiro (Acta Numerica 16, 2007) shows there P1 with the data of one piece of the boundary, P2 with those of
another, and the field (7.12) that has both.  Shape and data are this program's own:

    a square plate with a round hole; on the hole     u = 1 + x/2,  du/dn = 2 sin(3 theta)   (P1, m = 1)
    on the rim of the square                          u = x y                                (P2, m = 0)

n points into the plate, theta is the angle around the hole.
"""

from __future__ import annotations

from dataclasses import dataclass

import rfm.geometry as g
from rfm.calculus.functions import atan2, sin
from rfm.calculus.types import Value
from rfm.geometry.shape import Shape
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.taylor import taylor
from structures.transfinite import interpolate_derivatives

CENTER, RADIUS = (0.2, -0.1), 0.35


@dataclass(frozen=True, eq=False)
class TaylorExample:
    """The three fields of the picture.

    Attributes
    ----------
    domain
        The plate.
    hole, rim
        P1 and P2: right on the hole, and on the rim.
    interpolant
        Right on both.
    """

    domain: Shape
    hole: FieldExpr
    rim: FieldExpr
    interpolant: FieldExpr


def taylor_example(normaliser: str = "composition") -> TaylorExample:
    """Return P1, P2 and their interpolant (7.12), see the module's docstring."""
    plate = g.rectangle(min=(-1.0, -1.0), max=(1.0, 1.0)).named("rim")
    domain = plate - g.disk(center=CENTER, radius=RADIUS).named("hole")
    w1, w2 = (normalised(domain, domain.part(name), 1) for name in ("hole", "rim"))
    on_hole, on_rim = (field(hole_value), field(hole_slope)), (field(rim_value),)
    return TaylorExample(
        domain,
        taylor(w1, on_hole, 2, normaliser).offset,
        taylor(w2, on_rim, 2, normaliser).offset,
        interpolate_derivatives([(on_hole, w1), (on_rim, w2)], 2, normaliser),
    )


def hole_value(x: Value, y: Value) -> Value:
    """Value on the hole."""
    return 1.0 + 0.5 * x


def hole_slope(x: Value, y: Value) -> Value:
    """Derivative along the normal into the plate on the hole."""
    return 2.0 * sin(3.0 * atan2(y - CENTER[1], x - CENTER[0]))


def rim_value(x: Value, y: Value) -> Value:
    """Value on the rim."""
    return x * y
