r"""Which corners of a problem get functions of their own, and which functions.

.. math:: u = g + \omega \psi + \sum_c \varphi_c \sum_k c_{ck} S_{ck}

with the functions S of the corners (:mod:`structures.corner_functions`) and factors :math:`\varphi` that vanish on the
other essential parts (:mod:`structures.fading`), so that the essential conditions hold for all coefficients.

The functions are those of :math:`-k \Delta u + c u = f` with a constant k; Ritz' method takes them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import reduce

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field
from rfm.errors import DiscretizationError
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.singular.straight import StraightCorner, landmarks, on_boundary, straight_corners
from rfm.geometry.surface import Surface
from rfm.geometry.vanishing import Product
from rfm.geometry.weight import weight
from solvers.bases.registry import basis
from solvers.device.backend import NONE
from solvers.equations.poisson import Poisson
from solvers.grid import Grid
from solvers.problem import Dirichlet, Discretization, Neumann, Problem, Robin, SolverOptions
from structures.contact import boundary_points
from structures.corner_functions import CornerFunctions, times
from structures.fading import VANISHED, Window, fading

AUTO, CORNERS, OFF = "auto", "corners", "none"
CHOICES = (AUTO, OFF, CORNERS)
"""Values of `singular`: where it pays, nowhere, or refuse where it is not possible."""

HIGHEST = 6
"""Largest exponent, measured on L-shapes: for degree 6 a limit of 4 has ten times the error, of 8 hardly less."""
ORDER = 2
"""Order of the factor that vanishes on the other parts; 3 and 4 are flatter at the corner and steeper elsewhere, with
up to twice the error."""
MOST = 8
"""Corners up to which `auto` has singular functions: each has some 20 that are tabulated at all points."""
REACH = 1.499
"""Cells around a corner within which there must be no boundary but its two edges: those of the fan."""
FLAT = 0.5
"""Least value of the factor at the distance of one cell; steeper ones are integrated badly and are of little use."""
CLOSER = 0.95
"""Curved boundary may come closer to a corner than its sampled points."""
SAMPLES = 17
"""Points a direction at which the largest value of a weight is looked for, and the domain behind a corner."""


@dataclass(frozen=True, eq=False)
class Enriched:
    """A corner with its functions and their factor (None: one)."""

    functions: CornerFunctions
    factor: Field | None
    reach: float
    """Distance beyond which the functions are below rounding; infinite without a window."""

    @property
    def corner(self) -> StraightCorner:
        """Where."""
        return self.functions.corner

    def table(self, x: Array, y: Array, order: int) -> Array:
        """Partial derivatives of factor times functions at points (n,), shape (n_alpha, count, n)."""
        if self.factor is None:
            return self.functions.table(x, y, order)
        if self.reach == math.inf:
            return times(partials(self.factor, (x, y), order), self.functions.table(x, y, order), order)
        near = np.flatnonzero(np.hypot(x - self.corner.point[0], y - self.corner.point[1]) < self.reach)
        there = (x[near], y[near])
        result = np.zeros((len(multi_indices(2, order)), self.functions.count, len(x)))
        result[:, :, near] = times(
            partials(self.factor, there, order), self.functions.table(*there, order), order
        )
        return result


def unsuitable(
    method: str, options: SolverOptions, problem: Problem, discretization: Discretization
) -> str | None:
    """Why a problem and its discretisation cannot have functions of corners at all; None when they can."""
    equation = problem.equation
    if not isinstance(equation, Poisson) or callable(equation.conductivity) or equation.advection is not None:
        return "the equation must be poisson with a constant conductivity and no advection"
    if problem.domain.dimension != 2:
        return "the domain must be plane"
    if method != "ritz" or options.device != NONE:
        return "the method must be ritz without a device"
    if options.linear == "multigrid":
        return "the linear solver must not be multigrid, which is for splines alone"
    if not basis(discretization.basis).local or discretization.conditions != "natural":
        return "the basis must be web-spline or b-spline, with conditions: natural"
    if problem.inclusions:
        return "there must be no inclusions"
    if not all(isinstance(c, Dirichlet | Neumann | Robin) for c in problem.conditions):
        return "the conditions must be dirichlet, neumann or robin"
    if any(piece.where is not None for c in problem.conditions for piece in c.part.pieces):
        return "every condition must hold on whole surfaces, not on pieces of them"
    if not any(isinstance(c, Dirichlet) for c in problem.conditions):
        return "a value must be prescribed somewhere"
    return None


def enriched_corners(problem: Problem, discretization: Discretization, grid: Grid) -> tuple[Enriched, ...]:
    """The re-entrant corners of a problem with their functions; () where `singular` is off.

    Parameters
    ----------
    problem, discretization
        What is solved and how.
    grid
        Its background grid: the cells next to a corner must have no other boundary.

    Raises
    ------
    DiscretizationError
        ``singular: corners`` was asked for, and no corner can have functions.
    """
    if discretization.singular == OFF:
        return ()
    corners = straight_corners(problem.domain)
    width = float(np.max(grid.spacing))
    found = [
        one
        for corner in corners
        if _is_sector(problem.domain, corner, REACH * width)
        and (one := _enriched(problem, corner, discretization.degree, width))
    ]
    if discretization.singular == CORNERS and not found:
        raise DiscretizationError(
            "singular must be auto or none here: the domain has no corner above 180 degrees between two straight "
            "edges, each with one condition on all of it, and so far from other boundary that the grid resolves it"
        )
    return () if discretization.singular == AUTO and len(found) > MOST else tuple(found)


def highest(degree: int) -> int:
    """Largest exponent that splines of a degree need help with."""
    return min(degree + 2, HIGHEST)


def _enriched(problem: Problem, corner: StraightCorner, degree: int, width: float) -> Enriched | None:
    """The corner with its functions; None where there is no factor that cells of a width resolve."""
    domain = problem.domain
    kinds = [_held(problem, surface) for surface in (corner.first, corner.second)]
    if None in kinds:
        return None
    held = (bool(kinds[0]), bool(kinds[1]))
    own = frozenset(s for s, yes in zip((corner.first, corner.second), held, strict=True) if yes)
    rays = [a for a, yes in zip((0.0, corner.angle), held, strict=True) if yes]
    essential = reduce(lambda a, b: a | b, (c.part for c in problem.conditions if isinstance(c, Dirichlet)))
    factor: Field | None = None
    alone = all(_alone(domain, corner, corner.start + a) for a in rays)
    if alone:
        others = essential - Part("own edges", own)
        if others.surfaces:
            factor = _fading(domain, others, corner)
        reach = _return(domain, corner)
        if reach < math.inf:
            window = Window(corner.point, reach / VANISHED)
            factor = window if factor is None else Product((factor, window))
    if not alone or not _resolved(factor, corner, width):
        reach = _clearance(domain, corner)
        factor = Window(corner.point, reach / VANISHED)
        if not _resolved(factor, corner, width):
            return None
    size = max(math.dist(corner.point, p) for p in _box_corners(domain))
    functions = CornerFunctions(corner, held, highest(degree), size, _has_products(problem))
    return Enriched(functions, factor, reach)


def _has_products(problem: Problem) -> bool:
    """Whether the solution may hold products of singular functions with r^2: of a reaction, or of what is given."""
    equation = problem.equation
    reaction = getattr(equation, "reaction", 0.0)
    given = (c.value for c in problem.conditions if isinstance(c, Dirichlet))
    return callable(reaction) or reaction != 0 or any(callable(v) or v != 0 for v in given)


def _is_sector(domain: Shape, corner: StraightCorner, radius: float) -> bool:
    """Whether the domain is the sector of the corner in a square, at points of smaller squares and of this one."""
    theta = (np.arange(96) + 0.5) * (2 * np.pi / 96)
    rays = np.stack([np.cos(corner.start + theta), np.sin(corner.start + theta)])
    rays *= radius / np.abs(rays).max(axis=0)
    x, y = np.array(corner.point)[:, None, None] + rays[:, None] * np.array([0.25, 0.5, 0.75, 1.0])[:, None]
    return bool(((np.asarray(domain.sign(x, y)) > 0) == (theta < corner.angle)).all())


def _resolved(factor: Field | None, corner: StraightCorner, width: float) -> bool:
    """Whether a factor is still near one at the distance of a cell from the corner, so that the grid resolves it."""
    if factor is None:
        return True
    theta = corner.start + corner.angle * np.linspace(0.02, 0.98, 25)
    x, y = (corner.point[i] + width * f(theta) for i, f in enumerate((np.cos, np.sin)))
    return bool(partials(factor, (x, y), 0)[0].min() >= FLAT)


def _held(problem: Problem, surface: Surface) -> bool | None:
    """Whether values are given on a surface; None where there is not one condition on all of it."""
    found = [c for c in problem.conditions if surface in c.part.surfaces]
    if len(found) != 1 or found[0].part.where is not None:
        return None
    return isinstance(found[0], Dirichlet)


def _return(domain: Shape, corner: StraightCorner) -> float:
    """Distance at which the ray opposite to a corner's bisector, where its functions jump, comes back to the domain."""
    direction = corner.start + 0.5 * corner.angle + math.pi
    far = np.linspace(0.0, 1.0, 2001)[1:]
    along = 2.0 * max(domain.box.size) * np.concatenate([np.geomspace(1e-6, far[0], 100)[:-1], far])
    x, y = (corner.point[i] + f(direction) * along for i, f in enumerate((np.cos, np.sin)))
    inside = np.flatnonzero(np.asarray(domain.sign(x, y)) > 0)
    return float(along[max(inside[0] - 1, 0)]) if len(inside) else math.inf


def _alone(domain: Shape, corner: StraightCorner, direction: float) -> bool:
    """Whether no boundary lies on the line of an edge behind the corner, where the functions do not vanish."""
    size = max(domain.box.size)
    along = -2.0 * size * np.linspace(0.0, 1.0, 402)[1:]
    x, y = (corner.point[i] + f(direction) * along for i, f in enumerate((np.cos, np.sin)))
    touching = np.abs(np.asarray(domain.sign(x, y))) < 1e-10 * size
    return int(touching.sum()) <= 2  # where the line crosses other boundary


def _fading(domain: Shape, others: Part, corner: StraightCorner) -> Field:
    """Factor that vanishes on the other essential parts."""
    own = weight(domain, others)
    at_corner = float(np.asarray(own(*corner.point)))
    lattice = [np.linspace(a, b, SAMPLES) for a, b in zip(domain.box.lower, domain.box.upper, strict=True)]
    coords = np.meshgrid(*lattice, indexing="ij")
    with np.errstate(all="ignore"):
        values = np.nan_to_num(
            partials(own, coords, 0)[0], nan=0.0, posinf=0.0
        )  # outside it need not be finite
    largest = float(values.max())
    return fading(own, at_corner, largest, ORDER)


def _clearance(domain: Shape, corner: StraightCorner) -> float:
    """Distance from a corner to the boundary that is not on its two edges; of curves, to sampled points."""
    here = np.array(corner.point)
    curves = frozenset(s for s in domain.surfaces if s.degree != 1)
    found = [landmarks(domain), _feet(domain, here)]
    if curves:
        sampled = boundary_points(domain, Part("curves", curves)) - here
        found.append(here + CLOSER * sampled)
    radius = np.hypot(*(np.concatenate(found) - here).T)
    return float(radius[radius > 1e-9 * max(domain.box.size)].min(initial=math.inf))  # not the corner itself


def _feet(domain: Shape, point: Array) -> Array:
    """Points of straight boundary (n, 2) nearest to a point on their lines."""
    feet = []
    for surface in domain.surfaces:
        if surface.degree == 1:
            value, *slope = partials(surface.function, tuple(point), 1)
            gradient = np.array(slope)
            feet.append(point - value * gradient / (gradient @ gradient))
    points = np.array(feet).reshape(-1, 2)
    return points[on_boundary(domain, points)]


def _box_corners(domain: Shape) -> list[tuple[float, float]]:
    (a, b), (c, d) = domain.box.lower, domain.box.upper
    return [(a, b), (c, b), (c, d), (a, d)]
