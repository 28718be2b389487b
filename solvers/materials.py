r"""Materials in parts of the domain: one field across their interfaces, continuous for every psi.

The inclusions and the matrix around them share the field :math:`v = g_b + \omega_b \psi` of the essential conditions
on boundary that inclusions bear (:math:`v = \psi` when they bear none), psi on the whole domain.  With d zero to first
order on all interfaces and :math:`\omega` on the other essential parts, whose data are g,

.. math:: u_i = v + s_i, \qquad
          u = \frac{\omega}{\omega + \kappa d}\, v + \frac{\kappa d}{\omega + \kappa d}\, g
              + d\, \omega\, \omega_b\, \psi_2

in the inclusion i and in the matrix, so that the value jumps by :math:`s_i` whatever psi and :math:`\psi_2` are: the
structure of :mod:`structures.catalogue.interface` without its flux.  The flux is a natural condition: the functional of
the method knows what work its jump does (:mod:`solvers.equations.two_sided`).  Data g are not asked for in the
inclusions, where a solution of the matrix such as 1/r need not exist.

Each material has cells and quadrature rules of its own, on one grid.  In the matrix psi and :math:`d \psi_2` can both
represent what is smooth, so the system is ill-conditioned (like the square of :math:`h^{-p}`), and a factorisation with
pivoting leaves out what depends on the rest; the field does not suffer (docs/structures.md).  The field of the
inclusions is the one that both share because its continuation into the matrix is usually the smoother one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from types import MappingProxyType

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError, GeometryError, StructureError
from rfm.geometry.part import Part, union
from rfm.geometry.shape import Shape
from rfm.geometry.weight import Weighting, weight
from solvers.background import Background, prepare
from solvers.bases.basis import Psi
from solvers.collar import only_volume
from solvers.equations.two_sided import TwoSided
from solvers.essential import Prescribed, essential_structure, prescribed
from solvers.exact import Exact, components_of, required
from solvers.grid import Grid
from solvers.modes import mode_of
from solvers.periodicity import periods_of, wraps_of
from solvers.problem import (
    Dirichlet,
    Discretization,
    FluxJump,
    FromExact,
    Inclusion,
    Periodic,
    Problem,
    Slip,
)
from solvers.seams import closed, seamless_structure
from solvers.setting import Region, Setting, Structure
from solvers.solution import Trial
from solvers.stopwatch import Stopwatch
from solvers.wrapping import Wraps
from structures.contact import boundary_points, meeting_points
from structures.field_expression import ONE, ZERO, FieldExpr, field, is_constant
from structures.manufactured import manufactured_extension
from structures.operator import Operator, unknown

FLAT = 1e-9
"""Distance, relative to the size of the domain, that counts as none."""


@dataclass(frozen=True, eq=False)
class Side:
    """An inclusion.

    Attributes
    ----------
    inclusion
        What it is.
    region
        Where it is, inside the domain.
    structure
        Its field, one operator for each component.
    interface
        Its boundary inside the domain.
    """

    inclusion: Inclusion
    region: Shape
    structure: Structure
    interface: Part


def structures_of(
    problem: Problem, discretization: Discretization, grid: Grid
) -> tuple[Structure, tuple[Side, ...]]:
    """Structure of the matrix, and the inclusions with theirs.

    Raises
    ------
    StructureError
        An inclusion has no interface with the matrix, or meets conditions that do not go with it.
    """
    require_materials(problem)
    interfaces = [interface_of(problem, inclusion) for inclusion in problem.inclusions]
    system = discretization.weight
    if callable(system):
        raise StructureError(
            "a weight given as a function does not know the interfaces: give the name of a weight"
        )
    shared = seamless_structure(_borne_only(problem), discretization, grid)
    walls = [
        boundary_points(problem.domain & i.region, p)
        for i, p in zip(problem.inclusions, interfaces, strict=True)
    ]
    matrix = _matrix(problem, interfaces, shared, system)
    matrix = closed(problem, matrix, grid, discretization.degree, np.concatenate(walls))
    sides = []
    for inclusion, interface in zip(problem.inclusions, interfaces, strict=True):
        region = problem.domain & inclusion.region
        w = field(weight(region, interface, system))
        fields = [u + _jump(problem, inclusion, interface, w, c, u) for c, u in enumerate(shared)]
        sides.append(Side(inclusion, region, tuple(fields), interface))
    return matrix, tuple(sides)


def _borne_only(problem: Problem) -> Problem:
    """The problem with the essential conditions on boundary of inclusions only."""
    kept = [
        c
        for c in problem.conditions
        if not isinstance(c, Dirichlet) or any(_bears(problem, i, c.part) for i in problem.inclusions)
    ]
    return replace(problem, conditions=tuple(kept))


def _bears(problem: Problem, inclusion: Inclusion, part: Part) -> bool:
    region = problem.domain & inclusion.region
    return bool(part.surfaces & set(region.surfaces)) and len(boundary_points(region, part)) > 0


def _matrix(problem: Problem, interfaces: Sequence[Part], shared: Structure, system: Weighting) -> Structure:
    """Structure of the matrix from the field that it shares with the inclusions."""
    domain, count, dimension = problem.domain, len(shared), problem.domain.dimension
    outside = reduce(lambda left, inclusion: left - inclusion.region, problem.inclusions, domain)
    d = field(weight(outside, interfaces, system))
    rest = [
        c
        for c in problem.conditions
        if isinstance(c, Dirichlet) and not any(_bears(problem, i, c.part) for i in problem.inclusions)
    ]
    held = replace(problem, conditions=tuple(rest))
    own = essential_structure(held, system)
    fields = []
    for c, (common, free) in enumerate(zip(shared, own, strict=True)):
        zero = (0,) * dimension
        omega, borne = free.coefficient(c, zero), common.coefficient(c, zero)
        share = ONE
        if not is_constant(omega, 1.0):
            ends = [boundary_points(outside, piece.part) for piece in prescribed(held, c, count)]
            level = [
                _median(omega, boundary_points(outside, union(interfaces))),
                _median(d, np.concatenate(ends)),
            ]
            share = omega / (omega + (level[0] / level[1]) * d)
        data = (1.0 - share) * free.offset if share is not ONE else ZERO
        fields.append(share * common + data + (omega * borne * d) * unknown(dimension, count + c))
    return tuple(fields)


def _median(f: FieldExpr, points: Array) -> float:
    """Typical value of a function at points (n, d)."""
    return float(np.median(np.broadcast_to(f(*points.T), len(points))))


def _jump(
    problem: Problem, inclusion: Inclusion, interface: Part, w: FieldExpr, component: int, shared: Operator
) -> FieldExpr:
    """Jump of the value, extended into an inclusion, and what its data differ from those of the matrix by."""
    datum = inclusion.jump
    value = datum[component] if isinstance(datum, tuple) else datum
    borne = _borne(problem, inclusion, component)
    omega = shared.coefficient(component, (0,) * shared.dimension)
    taken = [piece.part for piece in borne if isinstance(piece.value, FromExact)]
    given = [piece.part for piece in borne if not isinstance(piece.value, FromExact)]
    if taken or isinstance(value, FromExact):
        fade = w * omega if borne else w
        jump = manufactured_extension(_gap(problem, inclusion, component), fade, problem.domain.box)
    elif value is None or (not callable(value) and float(value) == 0.0):
        return ZERO
    else:
        jump = field(value)
    if given:
        region = problem.domain & inclusion.region
        for part in given:
            _require_apart(region, part, interface, inclusion)
        zero = field(weight(region, given))
        jump = jump * zero / (zero + w * (field(weight(region, taken)) if taken else ONE))
    return jump


def _borne(problem: Problem, inclusion: Inclusion, component: int) -> list[Prescribed]:
    """What is prescribed on the boundary of the domain that an inclusion has."""
    region = problem.domain & inclusion.region
    count = problem.equation.components(problem.domain.dimension)
    return [
        piece
        for piece in prescribed(problem, component, count)
        if piece.part.surfaces & set(region.surfaces) and len(boundary_points(region, piece.part))
    ]


def interface_of(problem: Problem, inclusion: Inclusion) -> Part:
    """Boundary of an inclusion inside the domain.

    Raises
    ------
    StructureError
        There is none.
    """
    region = problem.domain & inclusion.region
    own = [s for s in region.part("all").surfaces if s not in problem.domain.surfaces]
    seen = [s for s in own if _inside_domain(problem.domain, region, Part(s.name, frozenset([s])))]
    if not seen:
        raise StructureError(
            f"the inclusion {inclusion.name} has no interface with the matrix: its region must be a part of the "
            "domain, and not all of it"
        )
    return Part(inclusion.name, frozenset(seen))


def _inside_domain(domain: Shape, region: Shape, part: Part) -> bool:
    points = boundary_points(region, part)
    depth = np.asarray(domain.membership(*points.T)) if len(points) else np.zeros(0)
    return bool((depth > FLAT * max(domain.box.size)).any())


def require_materials(problem: Problem) -> None:
    """Refuse what has no structure across interfaces.

    Raises
    ------
    StructureError
        The equation is of fourth order, or an inclusion reaches a slip or a periodic part.
    """
    if problem.equation.order > 1:
        raise StructureError(
            f"the equation {problem.equation.name} has no inclusions: write its data as where(...)"
        )
    for inclusion in problem.inclusions:
        region = problem.domain & inclusion.region
        for condition in problem.conditions:
            if not isinstance(condition, Slip | Periodic):
                continue
            parts = (
                (condition.part, condition.partner) if isinstance(condition, Periodic) else (condition.part,)
            )
            if any(len(boundary_points(region, part)) for part in parts):
                kind = type(condition).__name__.lower()
                raise StructureError(
                    f"the inclusion {inclusion.name} reaches {condition.part.name}, which has a {kind} condition: that "
                    "has no structure across an interface; keep the inclusion off it"
                )


def _require_apart(region: Shape, part: Part, interface: Part, inclusion: Inclusion) -> None:
    if len(meeting_points(region, part, interface)):
        raise StructureError(
            f"the value cannot jump at the interface of {inclusion.name}, which meets the essential condition on "
            f"{part.name}: give a jump of 0, or a flux there"
        )


def _gap(problem: Problem, inclusion: Inclusion, component: int) -> FieldExpr:
    """Difference of the exact solutions."""
    own, other = (components_of(required(e))[component] for e in (inclusion.exact, problem.exact))
    return field(own) - field(other)


def materials_setting(problem: Problem, discretization: Discretization, background: Background) -> Setting:
    """Spaces and regions of a problem with inclusions.

    Raises
    ------
    DiscretizationError
        The grid is too coarse for a material.
    StructureError
        See :func:`structures_of`.
    """
    grid = background.grid
    matrix, sides = structures_of(problem, discretization, grid)
    outside = reduce(lambda left, side: left - side.inclusion.region, sides, problem.domain)
    rest = _background(outside, "the matrix", discretization, grid, wraps_of(periods_of(problem)))
    regions = [Region(matrix, rest, problem)]
    rules_only = replace(discretization, basis="b-spline")
    for side in sides:
        # it has no splines of its own, so it may be as thin as a cell
        own = _background(side.region, f"the inclusion {side.inclusion.name}", rules_only, grid)
        there = replace(problem, equation=side.inclusion.equation, exact=side.inclusion.exact)
        regions += [Region(side.structure, own, there), _interface(problem, side, matrix, own)]
    count = len(matrix)
    spaces = (background.space,) * count + (rest.space,) * count
    return Setting(matrix, spaces, tuple(regions), sides)


def _background(
    region: Shape,
    name: str,
    discretization: Discretization,
    grid: Grid,
    wraps: Wraps = MappingProxyType({}),
) -> Background:
    """Cells, rules and space of one material on the common grid."""
    try:
        return prepare(region, discretization, Stopwatch(), wraps, grid)
    except (GeometryError, DiscretizationError) as error:
        raise type(error)(f"{name}: {error}") from error


def _interface(problem: Problem, side: Side, matrix: Structure, own: Background) -> Region:
    """Boundary rules of the interface, with the fields of both sides."""
    inclusion = side.inclusion
    rules = {s: batch for s, batch in own.rules.boundary.items() if s in side.interface.surfaces}
    nothing = only_volume(own, own.rules.cut.take(np.zeros(0, dtype=np.int64)))
    background = replace(nothing, rules=replace(nothing.rules, boundary=rules))
    exact: Exact | None = None
    if problem.exact is not None and inclusion.exact is not None:
        exact = (*components_of(inclusion.exact), *components_of(problem.exact))
    pair = Problem(
        problem.domain,
        TwoSided(inclusion.equation, problem.equation),
        (FluxJump(side.interface, inclusion.flux_jump),),
        exact,
    )
    return Region((*side.structure, *matrix), background, pair)


def stored_trial(
    problem: Problem, discretization: Discretization, grid: Grid, splines: Sequence[Psi]
) -> Trial:
    """The field of splines that were solved for with these arguments."""
    if problem.inclusions:
        matrix, sides = structures_of(problem, discretization, grid)
        return Trial(matrix, tuple(splines), sides)
    return Trial(mode_of(discretization).structure(problem, discretization, grid), tuple(splines))
