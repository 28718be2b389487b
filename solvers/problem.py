r"""A boundary value problem and how it is to be discretised, as plain values.

The problem is to find :math:`u` on the domain :math:`\Omega` with an equation inside and, on parts of
the boundary with outward normal :math:`n` and conductivity :math:`k`,

* Dirichlet  :math:`u = g`,
* Neumann    :math:`k\,\partial u/\partial n = g` (the conormal flux),
* Robin      :math:`k\,\partial u/\partial n + h u = g`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from rfm.calculus.types import Field

if TYPE_CHECKING:
    from rfm.geometry.box import Box
    from rfm.geometry.part import Part
    from rfm.geometry.shape import Shape
    from solvers.equations.poisson import Poisson


class FromExact(Enum):
    """Boundary data taken from the exact solution (method of manufactured solutions)."""

    FROM_EXACT = "from exact"


FROM_EXACT = FromExact.FROM_EXACT

Datum = Field | float
"""A number, or a field called as ``f(x, y)`` or ``f(x, y, z)``."""


@dataclass(frozen=True)
class Dirichlet:
    """``u = value`` on ``part``: essential, satisfied exactly by the solution structure."""

    part: Part
    value: Datum | FromExact = 0.0


@dataclass(frozen=True)
class Neumann:
    """``k du/dn = flux`` on ``part``: natural, satisfied through the functional."""

    part: Part
    flux: Datum | FromExact = 0.0


@dataclass(frozen=True)
class Robin:
    """``k du/dn + coefficient * u = value`` on ``part``: natural."""

    part: Part
    coefficient: Datum = 1.0
    value: Datum | FromExact = 0.0


Condition = Dirichlet | Neumann | Robin


@dataclass(frozen=True)
class Problem:
    """A domain, an equation on it, conditions on its boundary and, if known, the exact solution."""

    domain: Shape
    equation: Poisson
    conditions: tuple[Condition, ...]
    exact: Field | None = None


@dataclass(frozen=True)
class Discretization:
    """How the unknown spline is chosen.

    Attributes
    ----------
    degree
        Degree p of the splines, 1 to 8.
    grid
        Cells along the longest side of the box; ignored when `spacing` is given.
    spacing
        Side of a cell, instead of `grid`.
    box
        Background box; the bounding box of the domain when absent.
    basis
        Name of the spline basis, ``web-spline`` or ``b-spline``.
    weight
        Name of the system that builds the weight (see :func:`rfm.geometry.weight.weight`).
    quadrature_points
        Gauss points a direction in cut cells; p + 3 when absent.
    moment_fitting
        Fold the rule of each cut cell into a tensor rule of the whole cell.
    """

    degree: int = 3
    grid: int = 32
    spacing: float | None = None
    box: Box | None = None
    basis: str = "web-spline"
    weight: str = "auto"
    quadrature_points: int | None = None
    moment_fitting: bool = True


@dataclass(frozen=True)
class SolverOptions:
    """The linear solver by name (``auto`` chooses and says why) and its relative tolerance."""

    linear: str = "auto"
    tolerance: float = 1e-12
