r"""The rho-blend: R-functions that round the corner where two boundaries meet, and change nothing elsewhere.

Notation: f, g are functions with unit slope, ``t = max(0, rho^2 - f^2 - g^2)``; upper sign intersection, lower union:

    f + g -+ sqrt(f^2 + g^2 + t^(k+1) / (4 rho^(2k)))                                        k = 1: (6.2)

Where t = 0 this is the R0-function.  For k = 1 its zeros with t > 0 are those of ``2 f g = t^2/(4 rho^2)``, that is
``(f - rho)^2 + (g - rho)^2 = rho^2`` with the sign of the fillet: the arc of a circle of radius rho that touches both
boundaries, exactly where f and g are coordinates, to first order otherwise.  The function is k times
continuously differentiable across t = 0 and smooth elsewhere, also where f = g = 0, where R0 has a corner.  It
increases in f and g for k <= 7.

Source: V. Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), equation (6.2), after Rvachev.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

from rfm.calculus.functions import maximum, power, sqrt
from rfm.calculus.systems.base import monotone
from rfm.calculus.types import Field, Value
from rfm.errors import GeometryError
from rfm.geometry.blending.operands import blended, function_of, require_operands, require_small
from rfm.geometry.checks import positive, shown
from rfm.geometry.shape import Shape

SMOOTHEST = 7


@dataclass(frozen=True, eq=False)
class RhoBlend:
    """The blend of two fields, see the module's docstring; ``sign`` is that of the root."""

    first: Field
    second: Field
    radius: float
    sign: float
    smoothness: int

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates."""
        return rho_blend(self.first(*coords), self.second(*coords), self.radius, self.sign, self.smoothness)


def rho_blend(f: Value, g: Value, radius: float, sign: float, smoothness: int = 1) -> Value:
    """Blend two values: union for ``sign`` 1, intersection for -1."""

    def formula(a: Value, b: Value) -> Value:
        squares = a * a + b * b
        excess = maximum(1.0 - squares * (1.0 / radius**2), 0.0)
        return a + b + sign * sqrt(squares + (0.25 * radius**2) * power(excess, smoothness + 1))

    return monotone(formula, f, g)


def blend(of: Sequence[Shape], radius: float, operation: str = "union", smoothness: int = 1) -> Shape:
    """Join shapes with a fillet, or intersect them with rounded edges.

    Parameters
    ----------
    of
        Two or more, combined from the left.  Of one smooth surface each, so that the blend is one smooth
        surface; others keep their corners.
    radius
        Radius of the fillet, not larger than the features of the shapes.
    operation
        ``union`` or ``intersection``.
    smoothness
        Continuous derivatives where the fillet begins, 1 to 7; 1 makes it the arc of a circle.

    Returns
    -------
    Shape
        One surface without a name.

    Raises
    ------
    GeometryError
        For a radius that is not positive or larger than the shapes, and whatever
        :func:`~rfm.geometry.blending.operands.require_operands` refuses.
    """
    sign = require_operands(of, operation)
    radius = positive("radius", radius)
    require_small("radius", radius, of)
    if smoothness != int(smoothness) or not 1 <= smoothness <= SMOOTHEST:
        raise GeometryError(
            f"smoothness must be a whole number from 1 to {SMOOTHEST}, got {shown(smoothness)}"
        )
    fields = [function_of(shape) for shape in of]
    field = reduce(lambda f, g: RhoBlend(f, g, radius, sign, int(smoothness)), fields)
    return blended(of, field, sign, radius if sign > 0.0 else 0.0)
