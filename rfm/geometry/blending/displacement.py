r"""Displacement blends: the R0-function of two shapes, lifted or lowered where their boundaries meet.

Notation: f, g are functions with unit slope, a0 the amount, a1 and a2 the ranges, h the function of a bounding set:

    displacement   R0(f, g) + a0 / (1 + (f/a1)^2 + (g/a2)^2)                                            (6.1)
    bounded        R0(f, g) + a0 (1 - q)^3 / (1 + q),   q = r / (r + max(0, h/a3)^2),   r = (f/a1)^2 + (g/a2)^2

A positive a0 adds material, a negative one removes it.  The first never ends, it only decays; the second is zero
outside the bounding set and joins it with two continuous derivatives and more.  Both keep the corner that R0 has
where f = g = 0, but inside (a0 > 0) or outside (a0 < 0) the shape, not on its boundary.

Sources: A. Pasko and V. Savchenko, Blending operations for the functionally based constructive geometry (CSG 94,
1994), in V. Shapiro, Acta Numerica 16 (2007), equation (6.1); G. Pasko, A. Pasko, T. Kunii, Bounded blending for
function-based shape modeling, IEEE Computer Graphics and Applications 25 (2005) 36-45.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rfm.calculus.functions import maximum, minimum, where
from rfm.calculus.jets import Jet
from rfm.calculus.r_systems import R0
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.blending.operands import blended, function_of, require_operands, require_small
from rfm.geometry.checks import number, positive
from rfm.geometry.shape import Shape

_TINY = 1e-200


@dataclass(frozen=True, eq=False)
class DisplacementBlend:
    """Equation (6.1)."""

    first: Field
    second: Field
    sign: float
    amount: float
    ranges: tuple[float, float]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        f, g = self.first(*coords), self.second(*coords)
        return R0.pair(f, g, self.sign) + self.amount / (1.0 + _nearness(f, g, self.ranges))


@dataclass(frozen=True, eq=False)
class BoundedBlend:
    """The blend that ends at a bounding set."""

    first: Field
    second: Field
    within: Field
    sign: float
    amount: float
    ranges: tuple[float, float, float]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        f, g = self.first(*coords), self.second(*coords)
        inner = maximum(self.within(*coords), 0.0) * (1.0 / self.ranges[2])
        r, s = _nearness(f, g, self.ranges[:2]), inner * inner
        total = r + s
        value = total.value if isinstance(total, Jet) else total
        # q = r/(r + s), 1 - q = s/(r + s); both vanish only in a corner of the bounding set on the edge
        safe = where(value <= _TINY, 1.0, total)
        rest = minimum(maximum(s / safe, 0.0), 1.0)
        return R0.pair(f, g, self.sign) + self.amount * (rest * rest * rest) / (2.0 - rest)


def displacement_blend(
    of: Sequence[Shape],
    amount: float,
    ranges: Sequence[float] | None = None,
    operation: str = "union",
) -> Shape:
    """Blend two shapes by displacement, (6.1).

    Parameters
    ----------
    of
        Two shapes, best of one smooth surface each.
    amount
        a0: positive adds material, negative removes it; at most the size of the shapes.
    ranges
        (a1, a2): how far from each boundary; the amount by default.
    operation
        ``union`` or ``intersection``.

    Returns
    -------
    Shape
        One surface without a name.

    Raises
    ------
    GeometryError
        For an amount of zero or larger than the shapes, ranges that are not positive, not two shapes.
    """
    sign, amount, lengths = _checked(of, amount, ranges, operation, 2)
    fields = [function_of(shape) for shape in of]
    field = DisplacementBlend(fields[0], fields[1], sign, amount, (lengths[0], lengths[1]))
    return blended(of, field, sign, _margin(amount))


def bounded_blend(
    of: Sequence[Shape],
    within: Shape,
    amount: float,
    ranges: Sequence[float] | None = None,
    operation: str = "union",
) -> Shape:
    """Blend two shapes inside a bounding set only.

    Parameters
    ----------
    of, amount, operation
        As for :func:`displacement_blend`.
    within
        The set outside which nothing changes.
    ranges
        (a1, a2, a3), a3 for the bounding set; the amount by default.

    Raises
    ------
    GeometryError
        As for :func:`displacement_blend`.
    """
    sign, amount, lengths = _checked([*of, within], amount, ranges, operation, 3)
    fields = [function_of(shape) for shape in of]
    field = BoundedBlend(
        fields[0], fields[1], function_of(within), sign, amount, (lengths[0], lengths[1], lengths[2])
    )
    return blended(of, field, sign, _margin(amount))


def _checked(
    shapes: Sequence[Shape], amount: float, ranges: Sequence[float] | None, operation: str, count: int
) -> tuple[float, float, list[float]]:
    sign, amount = require_operands(shapes, operation), number("amount", amount)
    if len(shapes) != count:
        raise GeometryError(f"a displacement joins two shapes, got {len(shapes) - count + 2}")
    if amount == 0.0:
        raise GeometryError("amount must not be 0: there would be no blend")
    require_small("amount", abs(amount), shapes[:2])
    given = [abs(amount)] * count if ranges is None else list(ranges)
    if len(given) != count:
        raise GeometryError(f"ranges must be {count} numbers, got {len(given)}")
    return sign, amount, [positive("ranges", value) for value in given]


def _nearness(f: Value, g: Value, ranges: Sequence[float]) -> Value:
    a, b = f * (1.0 / ranges[0]), g * (1.0 / ranges[1])
    return a * a + b * b


def _margin(amount: float) -> float:
    """Points outside both shapes by m have R0 < -0.58 m, so a displacement by a0 reaches 1.71 a0 at most."""
    return max(0.0, 1.71 * amount)
