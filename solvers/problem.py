r"""A boundary value problem and how it is to be discretised, as plain values.

The problem is to find :math:`u` on the domain :math:`\Omega` with an equation inside and, on parts of
the boundary with outward normal :math:`n` and conductivity :math:`k`,

* Dirichlet  :math:`u = g`, of a vector component by component,
* Neumann    :math:`k\,\partial u/\partial n = g` (the conormal flux),
* Robin      :math:`k\,\partial u/\partial n + h u = g`,
* Oblique    :math:`b \cdot \nabla u + h u = g` with a direction b that is nowhere tangential;

of an elastic body with the stress :math:`\sigma`

* Traction   :math:`\sigma n = t`,   Pressure  :math:`\sigma n = -p n`,
* Slip       :math:`u \cdot n = 0` and no tangential traction;

of a plate with bending moment M and Kirchhoff's shear force V (:mod:`solvers.equations.plate`)

* Clamped    :math:`w = g`, :math:`\partial w/\partial n = s`,
* SimplySupported  :math:`w = g`, :math:`M = m`,
* Free       :math:`M = m`, :math:`V = q`;

and of any equation, between two opposite parts A and B = A + T,

* Periodic   :math:`u(x + T) = c\,u(x)` with all derivatives, c = 1 or -1.
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
    from rfm.geometry.weight import Weighting
    from solvers.equations.equation import Equation
    from solvers.exact import Exact


class FromExact(Enum):
    """Boundary data taken from the exact solution (method of manufactured solutions)."""

    FROM_EXACT = "from exact"


FROM_EXACT = FromExact.FROM_EXACT

Datum = Field | float
"""A number, or a field called as ``f(x, y)`` or ``f(x, y, z)``."""

VectorDatum = Datum | FromExact | tuple[Datum | FromExact | None, ...]
"""A datum, or one for each component of a vector; None leaves a component free."""


@dataclass(frozen=True)
class Dirichlet:
    """``u = value`` on ``part``: essential, satisfied exactly by the solution structure.

    Of a vector, `value` is a tuple with one entry for each component, None where the component is free of
    displacement and of traction (a roller); a single value holds for all components.
    """

    part: Part
    value: VectorDatum = 0.0


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


@dataclass(frozen=True)
class Oblique:
    """``direction . grad u + coefficient * u = value`` on ``part``: natural; there is no energy.

    The direction is a vector of numbers or fields, nowhere tangential to the part; its length counts.
    """

    part: Part
    direction: tuple[Datum, ...]
    coefficient: Datum = 0.0
    value: Datum | FromExact = 0.0


@dataclass(frozen=True)
class Traction:
    """``sigma n = traction`` on ``part``, n outward: natural."""

    part: Part
    traction: tuple[Datum, ...] | FromExact


@dataclass(frozen=True)
class Pressure:
    """``sigma n = -pressure n`` on ``part``, n outward: natural."""

    part: Part
    pressure: Datum = 0.0


@dataclass(frozen=True)
class Slip:
    """``u . n = 0`` on ``part``, essential; the tangential part of `traction` (None: zero) is natural."""

    part: Part
    traction: tuple[Datum, ...] | FromExact | None = None


@dataclass(frozen=True)
class Clamped:
    """Edge of a plate with ``w = value`` and outward slope ``dw/dn = slope``: both essential."""

    part: Part
    value: Datum | FromExact = 0.0
    slope: Datum | FromExact = 0.0


@dataclass(frozen=True)
class SimplySupported:
    """Edge of a plate with ``w = value``, essential, and bending moment ``M = moment``, natural."""

    part: Part
    value: Datum | FromExact = 0.0
    moment: Datum | FromExact = 0.0


@dataclass(frozen=True)
class Free:
    """Edge of a plate with bending moment ``M = moment`` and shear force ``V = shear``: both natural."""

    part: Part
    moment: Datum | FromExact = 0.0
    shear: Datum | FromExact = 0.0


@dataclass(frozen=True)
class Periodic:
    """``u(x + T) = factor u(x)`` for x on ``part`` and x + T on ``partner``, with all derivatives: essential.

    Both parts lie across one coordinate axis and bound the domain along it; T is the way from the one to the other,
    or given as `shift`.  The factor is 1, or -1 of an antiperiodic field.
    """

    part: Part
    partner: Part
    factor: float = 1.0
    shift: tuple[float, ...] | None = None


@dataclass(frozen=True)
class FluxJump:
    """``F_1 u_1 . n - F_2 u_2 . n = value`` on the interface ``part``, n out of the inclusion 1: natural."""

    part: Part
    value: VectorDatum = 0.0


@dataclass(frozen=True)
class Inclusion:
    """A part of the domain with another material.

    Attributes
    ----------
    name
        For messages and results.
    region
        Where it is: the part of the domain in this shape.
    equation
        Its equation, of the kind of that of the problem.
    jump
        u of the inclusion minus u of the matrix on the interface; of a vector one for each component.
    flux_jump
        Flux of the inclusion minus that of the matrix on the interface, along the normal out of the inclusion.
    exact
        The exact solution in it.
    """

    name: str
    region: Shape
    equation: Equation
    jump: VectorDatum = 0.0
    flux_jump: VectorDatum = 0.0
    exact: Exact | None = None


Condition = (
    Dirichlet
    | Neumann
    | Robin
    | Oblique
    | Traction
    | Pressure
    | Slip
    | Clamped
    | SimplySupported
    | Free
    | Periodic
    | FluxJump
)


@dataclass(frozen=True)
class Problem:
    """A domain, an equation on it, conditions on its boundary and, if known, the exact solution.

    With `inclusions` equation and exact solution are those of the rest of the domain, the matrix.
    """

    domain: Shape
    equation: Equation
    conditions: tuple[Condition, ...]
    exact: Exact | None = None
    inclusions: tuple[Inclusion, ...] = ()

    @property
    def oblique(self) -> bool:
        """Whether there is an oblique derivative among the conditions, so that there is no energy."""
        return any(isinstance(condition, Oblique) for condition in self.conditions)


@dataclass(frozen=True)
class Discretization:
    """How the unknown spline is chosen.

    Attributes
    ----------
    degree
        Degree p as the basis counts it: of splines 1 to 8, of polynomials 1 to 40, highest frequency, smoothness.
    grid
        Cells along the longest side of the box; ignored when `spacing` is given.
    spacing
        Side of a cell, instead of `grid`.
    box
        Background box; the bounding box of the domain when absent.
    basis
        Name of the basis, one of :data:`solvers.bases.registry.BASES`.
    weight
        What builds the weight, a name or a system of R-functions (see :func:`rfm.geometry.weight.weight`), or the
        weight itself: a field that vanishes, with a slope, where values are prescribed and is positive elsewhere.
    quadrature_points
        Gauss points a direction in cut cells; p + 3 when absent.
    moment_fitting
        Fold the rule of each cut cell into a tensor rule of the whole cell, unless the weight is known not to go on
        smoothly across the boundary.
    conditions
        ``natural`` leaves flux conditions to the functional, ``exact`` builds them into the solution structure.
    singular
        Singular functions at re-entrant corners (:mod:`solvers.corners`): ``auto`` where there are such corners and the
        method has them, ``corners`` refuses where not, ``none``.
    """

    degree: int = 3
    grid: int = 32
    spacing: float | None = None
    box: Box | None = None
    basis: str = "web-spline"
    weight: Weighting | Field = "auto"
    quadrature_points: int | None = None
    moment_fitting: bool = True
    conditions: str = "natural"
    singular: str = "auto"


@dataclass(frozen=True)
class SolverOptions:
    """How linear systems are solved.

    Attributes
    ----------
    linear
        The linear solver by name; ``auto`` chooses and says why.
    tolerance
        Relative residual at which iterative solvers stop.
    device
        Where: ``none`` assembles the matrix and solves with NumPy; ``cpu`` and ``gpu`` apply it cell by cell by JAX.
    shards
        Boxes into which the grid is cut, one for each device; ``all`` takes all devices.  When absent, one box, or one
        for each device where several processes solve together.
    redundant
        The unknowns may depend on each other to rounding (set by the basis).
    """

    linear: str = "auto"
    tolerance: float = 1e-12
    device: str = "none"
    shards: int | str | None = None
    redundant: bool = False
