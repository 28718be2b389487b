r"""The three problems timed, as formulas on any coordinates and as shapes for both programs.

Each is :math:`-\Delta u = f` with Dirichlet data.  The solutions are generic: none is a multiple of a weight,
and none is handed over as the extension of its own boundary data.  Sources and data are written out by hand, so
that both programs evaluate the same closed form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gmsh

from rfm.calculus.functions import cos, cosh, exp, sin
from rfm.geometry import Shape, ball, cylinder, disk, rectangle
from solvers.equations.poisson import Poisson
from solvers.problem import FROM_EXACT, Dirichlet, Problem

Formula = Callable[..., Any]


@dataclass(frozen=True)
class Benchmark:
    """A problem with all that the two programs need to know of it.

    Attributes
    ----------
    name
        Heading in the tables.
    dimension
        2 or 3.
    exact, source
        The solution and ``-laplacian`` of it.
    shape
        Builds the domain of rfm.
    data
        Boundary data of rfm: a formula of its own, or FROM_EXACT.
    draw
        Adds the domain to the geometry kernel of gmsh.
    degrees, grids
        What rfm is tried with: degrees, and cells along the longest side.
    sizes
        Mesh sizes for scikit-fem.
    """

    name: str
    dimension: int
    exact: Formula
    source: Formula
    shape: Callable[[], Shape]
    data: Any
    draw: Callable[[], None]
    degrees: tuple[int, ...]
    grids: tuple[int, ...]
    sizes: tuple[float, ...]

    def problem(self) -> Problem:
        """The problem as rfm states it, shapes built anew (they are part of the time)."""
        domain = self.shape()
        condition = Dirichlet(domain.part("all"), self.data)
        return Problem(domain, Poisson(source=self.source), (condition,), self.exact)


# Annulus of radii 0.1 and 0.4 around (1/2, 1/2); with rho the squared distance from the centre,
# w = (0.16 - rho)(rho - 0.01), g = exp(x) sin(3y), laplacian(g) = -8 g and u = w g.


def annulus_exact(x: Any, y: Any) -> Any:
    """Solution on the annulus."""
    rho = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return (0.16 - rho) * (rho - 0.01) * exp(x) * sin(3 * y)


def annulus_source(x: Any, y: Any) -> Any:
    """Source on the annulus."""
    X, Y = x - 0.5, y - 0.5
    rho = X**2 + Y**2
    w, slope, laplacian = (0.16 - rho) * (rho - 0.01), 2 * (0.17 - 2 * rho), 0.68 - 16 * rho
    e, s = exp(x), sin(3 * y)
    return -e * (laplacian * s + 2 * slope * (X * s + 3 * Y * cos(3 * y)) - 8 * w * s)


def annulus_shape() -> Shape:
    """Shape of the annulus."""
    return disk(center=(0.5, 0.5), radius=0.4) - disk(center=(0.5, 0.5), radius=0.1)


def annulus_draw() -> None:
    """Add to gmsh the annulus."""
    occ = gmsh.model.occ
    occ.cut([(2, occ.addDisk(0.5, 0.5, 0, 0.4, 0.4))], [(2, occ.addDisk(0.5, 0.5, 0, 0.1, 0.1))])


# Square [-1, 1]^2 with three holes; u = exp(x) sin(y) + 0.3 cos(2x) cosh(y).

HOLES = ((-0.4, -0.3, 0.2), (0.45, 0.35, 0.25), (0.3, -0.5, 0.15))


def holes_exact(x: Any, y: Any) -> Any:
    """Solution on the plate with three holes."""
    return exp(x) * sin(y) + 0.3 * cos(2 * x) * cosh(y)


def holes_source(x: Any, y: Any) -> Any:
    """Source on the plate with three holes."""
    return 0.9 * cos(2 * x) * cosh(y)


def holes_shape() -> Shape:
    """Shape of the plate with three holes."""
    plate = rectangle(min=(-1, -1), max=(1, 1))
    for x, y, r in HOLES:
        plate = plate - disk(center=(x, y), radius=r)
    return plate


def holes_draw() -> None:
    """Add to gmsh the plate with three holes."""
    occ = gmsh.model.occ
    occ.cut([(2, occ.addRectangle(-1, -1, 0, 2, 2))], [(2, occ.addDisk(x, y, 0, r, r)) for x, y, r in HOLES])


# Unit ball minus the cylinder of radius 0.3 about the z axis, data x z.
# With A = 1 - r^2, B = x^2 + y^2 - 0.09, h = exp(x) sin(y + 0.4) cos(z), laplacian(h) = -h: u = x z + A B h.


def bore_exact(x: Any, y: Any, z: Any) -> Any:
    """Solution on the ball minus the cylinder."""
    s = x**2 + y**2
    return x * z + (1 - s - z**2) * (s - 0.09) * exp(x) * sin(y + 0.4) * cos(z)


def bore_source(x: Any, y: Any, z: Any) -> Any:
    """Source on the ball minus the cylinder."""
    s = x**2 + y**2
    A, B = 1 - s - z**2, s - 0.09
    e, S, C = exp(x), sin(y + 0.4), cos(z)
    across = 2 * (A - B)  # gradient of A B is (across x, across y, -2 B z)
    first = across * (x * S + y * cos(y + 0.4)) * C + 2 * B * z * S * sin(z)
    return -e * ((4 * A - 8 * s - 6 * B) * S * C + 2 * first - A * B * S * C)


def bore_data(x: Any, y: Any, z: Any) -> Any:
    """Boundary data of the ball minus the cylinder."""
    return x * z


def bore_shape() -> Shape:
    """Shape of the ball minus the cylinder."""
    return ball(center=(0, 0, 0), radius=1) - cylinder(center=(0, 0, 0), axis=(0, 0, 1), radius=0.3)


def bore_draw() -> None:
    """Add to gmsh the ball minus the cylinder."""
    occ = gmsh.model.occ
    occ.cut([(3, occ.addSphere(0, 0, 0, 1))], [(3, occ.addCylinder(0, 0, -2, 0, 0, 4, 0.3))])


BENCHMARKS = (
    Benchmark(
        "annulus", 2, annulus_exact, annulus_source, annulus_shape, 0.0, annulus_draw,
        degrees=(2, 3, 4, 5, 6, 7, 8), grids=(4, 5, 6, 8, 10, 12, 16, 24, 32, 48),
        sizes=tuple(0.1 / 1.6**i for i in range(8)),
    ),
    Benchmark(
        "plate with three holes", 2, holes_exact, holes_source, holes_shape, FROM_EXACT, holes_draw,
        degrees=(2, 3, 4, 5, 6, 7, 8), grids=(3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48),
        sizes=tuple(0.25 / 1.6**i for i in range(8)),
    ),
    Benchmark(
        "ball minus cylinder", 3, bore_exact, bore_source, bore_shape, bore_data, bore_draw,
        degrees=(2, 3, 4, 5, 6), grids=(3, 4, 5, 6, 8, 10, 12, 14, 16, 20, 24),
        sizes=tuple(0.4 / 1.5**i for i in range(6)),
    ),
)  # fmt: skip
