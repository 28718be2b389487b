r"""The problems of the benchmark: domains as plain data, solutions and sources as formulas of any kind of number.

Every formula takes the mathematics to compute with as its first argument, a namespace with ``sin``, ``exp``,
``arctan2`` and so on: NumPy, jets, or the coefficient functions of a finite element program.  So all programs
evaluate the same closed forms.

=============================  ======================================  ============================================
problem                        equation                                solution
=============================  ======================================  ============================================
annulus, sine                  :math:`-\Delta u = f`, u = 0            :math:`\sin w`, w the product of both disks
annulus                        the same                                :math:`w\,e^x \sin 3y`
plate with three holes         the same, u given                       :math:`e^x \sin y + 0.3 \cos 2x \cosh y`
L-shape                        the same, f = 0                         :math:`r^{2/3} \sin(2\theta/3)`
Kirsch plate, a quarter        plane stress, rollers and tractions     Kirsch 1898 (Timoshenko and Goodier, section 35)
clamped plate                  :math:`\Delta^2 u = f`                  :math:`(1 - r^2)^2 e^x \sin(2y + 0.3)`
ball minus cylinder            :math:`-\Delta u = f`, u given          :math:`xz + AB\,e^x \sin(y + 0.4) \cos z`
=============================  ======================================  ============================================

The sine on the annulus is nearly a multiple of the product weight (Example 4.1 of the paper on spline R-functions is
of this kind), so a solver that multiplies by a weight has little to do there; the others are generic.
Quantities of the Kirsch plate are those of a unit tension along x, Young's modulus 1 and Poisson's ratio 0.3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Any

Formula = Callable[..., Any]
"""``formula(maths, x, y)`` or ``formula(maths, x, y, z)``; of a vector it returns a tuple."""


@dataclass(frozen=True)
class Ball:
    """Ball, in the plane a disk."""

    center: tuple[float, ...]
    radius: float


@dataclass(frozen=True)
class Block:
    """Rectangle with sides along the axes."""

    low: tuple[float, float]
    high: tuple[float, float]


@dataclass(frozen=True)
class Bore:
    """Unbounded cylinder about the z axis."""

    radius: float


@dataclass(frozen=True)
class Polygon:
    """Polygon by its vertices, counterclockwise."""

    vertices: tuple[tuple[float, float], ...]


Solid = Ball | Block | Bore | Polygon


@dataclass(frozen=True)
class Problem:
    """What every program needs to know.

    Attributes
    ----------
    name
        Heading in the tables, and what the options of the command select by.
    equation
        ``poisson``, ``elasticity`` or ``plate``.
    dimension
        2 or 3.
    outer, holes
        The domain is `outer` without `holes`.
    exact
        The solution.
    source
        Minus the Laplacian of it, of the plate the Laplacian of its Laplacian; None where it is zero.
    data
        A formula that has the boundary values of the solution; None where they are zero.
    extended
        `data` may be used inside, as an extension that is not the solution.
    """

    name: str
    equation: str
    dimension: int
    outer: Solid
    holes: tuple[Solid, ...]
    exact: Formula
    source: Formula | None
    data: Formula | None
    extended: bool = True

    @property
    def slug(self) -> str:
        """Name for files."""
        return "_".join(self.name.replace(",", "").replace("-", " ").lower().split())


# Annulus of radii 0.1 and 0.4 around (1/2, 1/2); rho is the squared distance from the center.

RING = (Ball((0.5, 0.5), 0.4), (Ball((0.5, 0.5), 0.1),))


def ring_weight(x: Any, y: Any) -> tuple[Any, Any, Any]:
    """Return the product w of the two disks' polynomials with half its derivative by rho, and its Laplacian."""
    rho = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return (0.16 - rho) * (rho - 0.01), 0.085 - rho, 0.68 - 16 * rho


def sine_exact(m: Any, x: Any, y: Any) -> Any:
    """Sine of the weight."""
    return m.sin(ring_weight(x, y)[0])


def sine_source(m: Any, x: Any, y: Any) -> Any:
    """``|grad w|^2 sin w - laplacian(w) cos w`` with ``grad w = 4 half (x - 1/2, y - 1/2)``."""
    w, half, laplacian = ring_weight(x, y)
    squared = 16 * half**2 * ((x - 0.5) ** 2 + (y - 0.5) ** 2)
    return squared * m.sin(w) - laplacian * m.cos(w)


def annulus_exact(m: Any, x: Any, y: Any) -> Any:
    """``w g`` with g = exp(x) sin(3y), whose Laplacian is -8 g."""
    return ring_weight(x, y)[0] * m.exp(x) * m.sin(3 * y)


def annulus_source(m: Any, x: Any, y: Any) -> Any:
    """``-(g laplacian(w) + 2 grad w . grad g - 8 w g)``."""
    w, half, laplacian = ring_weight(x, y)
    sine = m.sin(3 * y)
    slope = (x - 0.5) * sine + 3 * (y - 0.5) * m.cos(3 * y)
    return -m.exp(x) * (laplacian * sine + 8 * half * slope - 8 * w * sine)


# Square [-1, 1]^2 with three holes.

THREE = (Ball((-0.4, -0.3), 0.2), Ball((0.45, 0.35), 0.25), Ball((0.3, -0.5), 0.15))


def holes_exact(m: Any, x: Any, y: Any) -> Any:
    """A harmonic function and one that is not."""
    return m.exp(x) * m.sin(y) + 0.3 * m.cos(2 * x) * m.cosh(y)


def holes_source(m: Any, x: Any, y: Any) -> Any:
    """Minus the Laplacian of the second term."""
    return 0.9 * m.cos(2 * x) * m.cosh(y)


# L-shape; the angle is counted so that its jump lies in the quadrant left out.

ELL = Polygon(((0, 0), (1, 0), (1, 1), (-1, 1), (-1, -1), (0, -1)))


def ell_exact(m: Any, x: Any, y: Any) -> Any:
    """Harmonic; the gradient is infinite at the corner."""
    angle = m.arctan2(-x - y, y - x) + 0.75 * pi
    return (x * x + y * y) ** (1 / 3) * m.sin(2 / 3 * angle)


def ell_data(m: Any, x: Any, y: Any) -> Any:
    """Equal to the solution on the boundary, where it vanishes or x^2 = 1 or y^2 = 1, and smoother at the corner."""
    return ell_exact(m, x, y) * (x * x + y * y - x * x * y * y)


# A quarter of the plate with a hole, [0, 2]^2 without the disk of radius 1/2: rollers at x = 0 and at y = 0, tractions
# on the sides x = 2 and y = 2, no traction on the hole.

YOUNG, POISSON = 1.0, 0.3
MU = YOUNG / (2 * (1 + POISSON))
LAMBDA = YOUNG * POISSON / (1 - POISSON**2)
"""Moduli of plane stress."""

HOLE = 0.5
SIDE = 2.0


def kirsch_exact(m: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Displacement under a unit tension along x, far from the hole."""
    k = (3 - POISSON) / (1 + POISSON)
    squared = x * x + y * y
    q = HOLE**2 / squared
    triple_cos = x * (x * x - 3 * y * y) / squared
    triple_sin = y * (3 * x * x - y * y) / squared
    along = (k + 1) * x + 2 * q * ((1 + k) * x + triple_cos) - 2 * q * q * triple_cos
    across = (k - 3) * y + 2 * q * ((1 - k) * y + triple_sin) - 2 * q * q * triple_sin
    return along / (8 * MU), across / (8 * MU)


def kirsch_stress(m: Any, x: Any, y: Any) -> tuple[Any, Any, Any]:
    """Stresses xx, yy and xy of it."""
    squared = x * x + y * y
    cos2, sin2 = (x * x - y * y) / squared, 2 * x * y / squared
    cos4, sin4 = 2 * cos2 * cos2 - 1, 2 * sin2 * cos2
    q = HOLE**2 / squared
    return (
        1 - q * (1.5 * cos2 + cos4) + 1.5 * q * q * cos4,
        -q * (0.5 * cos2 - cos4) - 1.5 * q * q * cos4,
        -q * (0.5 * sin2 + sin4) + 1.5 * q * q * sin4,
    )


# Clamped unit disk.


def clamped_exact(m: Any, x: Any, y: Any) -> Any:
    """``A g`` with A = (1 - s)^2, s = x^2 + y^2 and g = exp(x) sin(2y + 0.3), whose Laplacian is -3 g."""
    return (1 - x * x - y * y) ** 2 * m.exp(x) * m.sin(2 * y + 0.3)


def clamped_source(m: Any, x: Any, y: Any) -> Any:
    """Load: the product rule for the square of the Laplacian.

    With ``A_x = -4 (1-s) x``, ``A_xx = 8 x x - 4 (1-s)``, laplacian(A) = 16 s - 8, whose gradient is 32 (x, y)
    and whose Laplacian is 64.
    """
    s = x * x + y * y
    sine, cosine = m.sin(2 * y + 0.3), m.cos(2 * y + 0.3)
    slope = x * sine + 2 * y * cosine
    bend = (x * x - 4 * y * y) * sine + 4 * x * y * cosine
    factor = 160 - 144 * s + 9 * (1 - s) ** 2
    return m.exp(x) * (factor * sine + (176 - 48 * s) * slope + 32 * bend)


# Unit ball without the cylinder of radius 0.3 about the z axis.


def bore_exact(m: Any, x: Any, y: Any, z: Any) -> Any:
    """``x z + A B h`` with A = 1 - r^2, B = x^2 + y^2 - 0.09 and h = exp(x) sin(y + 0.4) cos(z)."""
    s = x * x + y * y
    return x * z + (1 - s - z * z) * (s - 0.09) * m.exp(x) * m.sin(y + 0.4) * m.cos(z)


def bore_source(m: Any, x: Any, y: Any, z: Any) -> Any:
    """The Laplacian of h is -h, the gradient of A B is (2(A-B) x, 2(A-B) y, -2 B z)."""
    s = x * x + y * y
    A, B = 1 - s - z * z, s - 0.09
    S, C = m.sin(y + 0.4), m.cos(z)
    slope = 2 * (A - B) * (x * S + y * m.cos(y + 0.4)) * C + 2 * B * z * S * m.sin(z)
    return -m.exp(x) * ((4 * A - 8 * s - 6 * B) * S * C + 2 * slope - A * B * S * C)


def bore_data(m: Any, x: Any, y: Any, z: Any) -> Any:
    """Boundary data."""
    return x * z


PROBLEMS = (
    Problem("annulus, sine", "poisson", 2, *RING, sine_exact, sine_source, None),
    Problem("annulus", "poisson", 2, *RING, annulus_exact, annulus_source, None),
    Problem(
        "plate with three holes", "poisson", 2, Block((-1, -1), (1, 1)), THREE, holes_exact, holes_source,
        holes_exact, extended=False,
    ),
    Problem("L-shape", "poisson", 2, ELL, (), ell_exact, None, ell_data),
    Problem(
        "Kirsch plate", "elasticity", 2, Block((0, 0), (SIDE, SIDE)), (Ball((0, 0), HOLE),), kirsch_exact, None,
        kirsch_exact, extended=False,
    ),
    Problem("clamped plate", "plate", 2, Ball((0, 0), 1), (), clamped_exact, clamped_source, None),
    Problem(
        "ball minus cylinder", "poisson", 3, Ball((0, 0, 0), 1), (Bore(0.3),), bore_exact, bore_source, bore_data
    ),
)  # fmt: skip


def problem(name: str) -> Problem:
    """The problem of a name.

    Raises
    ------
    KeyError
        There is none.
    """
    return {one.name: one for one in PROBLEMS}[name]
