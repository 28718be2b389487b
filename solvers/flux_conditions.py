"""Conditions of a problem that are not values (or slopes), as conditions of the catalogue for an exact structure.

Data taken from the exact solution are extended as its flux (traction, moment, shear force) through the level sets of w,
plus w times a fixed generic field: the values on the part are told, never those inside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from rfm.errors import DiscretizationError
from rfm.geometry.part import Part
from solvers.equations.elasticity import Elasticity
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.essential import prescribed
from solvers.exact import components_of, required
from solvers.problem import (
    Clamped,
    Condition,
    Datum,
    Dirichlet,
    Free,
    FromExact,
    Neumann,
    Oblique,
    Periodic,
    Pressure,
    Problem,
    Robin,
    SimplySupported,
    Slip,
    Traction,
)
from structures.catalogue import plate_conditions, scalar_conditions, vector_conditions
from structures.catalogue.condition import Condition as ExactCondition
from structures.catalogue.rule import Site, changes
from structures.contact import boundary_points
from structures.field_expression import ONE, ZERO, FieldExpr, field
from structures.layers import layer, slopes
from structures.manufactured import generic_field
from structures.operator import known, unknown

Data = tuple[Datum | FieldExpr | FromExact, ...]
"""What a condition of the catalogue is to take, one for each of its rows."""
Asked = tuple[ExactCondition, Data]
"""A condition, its data yet to be filled in, and these data."""


def boundary_pieces(problem: Problem) -> Iterator[tuple[Part, Condition]]:
    """Each surface that bears boundary, with each condition on it."""
    for condition in problem.conditions:
        for member in condition.part.pieces:
            for surface in sorted(member.surfaces, key=lambda s: s.label):
                piece = Part(member.name, frozenset([surface]), member.where)
                if len(boundary_points(problem.domain, piece)):
                    yield piece, condition


def has_flux(condition: Condition) -> bool:
    """Whether something else than values (and slopes) is prescribed."""
    if isinstance(condition, Dirichlet):
        return isinstance(condition.value, tuple) and None in condition.value
    return not isinstance(condition, Clamped | Periodic)


def site_of(problem: Problem, condition: Condition, w: FieldExpr) -> Site:
    """Return the part of a condition, with what an exact structure has to satisfy there and what it must keep.

    Parameters
    ----------
    problem, condition
        The problem and one of its conditions.
    w
        Normalised on the piece of boundary.

    Raises
    ------
    DiscretizationError
        There is no exact structure for it; the message names what there is.
    """
    held = _held(problem, condition)
    if not has_flux(condition):
        return Site(w, (), kept=2 if isinstance(condition, Clamped) else 1)
    return Site.of(w, [_filled(problem, w, *asked) for asked in _asked(problem, condition, w)], held)


def derivatives(problem: Problem) -> int:
    """Highest derivative of a spline in the exact structure of a problem.

    Raises
    ------
    DiscretizationError
        There is no exact structure for one of the conditions.
    """
    dimension = problem.domain.dimension
    w = field(sum)  # any field will do: only the form of the operators counts
    u = [w * unknown(dimension, c) for c in range(problem.equation.components(dimension))]
    highest = 0
    for condition in filter(has_flux, problem.conditions):
        conditions = [asked for asked, _ in _asked(problem, condition, w)]
        found = changes([layer(w, [c]) for c in u], conditions, _held(problem, condition))
        highest = max(highest, *(level.order for change in found for level in change.levels))
    return highest


def _held(problem: Problem, condition: Condition) -> dict[int, int]:
    """Order to which the share of each spline vanishes where a condition holds."""
    count = problem.equation.components(problem.domain.dimension)
    return {
        c: 1 for c in range(count) if any(p.part is condition.part for p in prescribed(problem, c, count))
    }


def _filled(problem: Problem, w: FieldExpr, condition: ExactCondition, data: Data) -> ExactCondition:
    """Return the condition with its data, those of the exact solution extended generically."""
    extended: Sequence[FieldExpr] = (ZERO,) * len(data)
    if any(isinstance(value, FromExact) for value in data):
        truth = [
            layer(w, [known(problem.domain.dimension, c)]) for c in components_of(required(problem.exact))
        ]
        generic = w * generic_field(problem.domain.box)
        extended = [generic + b.offset for b in condition.applied(truth)]
    return condition.prescribing(
        [
            exact if isinstance(value, FromExact) else field(value)
            for value, exact in zip(data, extended, strict=True)
        ]
    )


def _asked(problem: Problem, condition: Condition, w: FieldExpr) -> list[Asked]:
    """Return what a condition asks beside values."""
    found = ASKED.get(type(problem.equation), _nothing)(problem, condition, w)
    if found:
        return found
    raise DiscretizationError(
        f"conditions: exact has no structure for {type(condition).__name__} with the equation "
        f"{problem.equation.name} ({condition.part.name}): it has those of poisson, elasticity and plate; "
        "use conditions: natural"
    )


def _nothing(problem: Problem, condition: Condition, w: FieldExpr) -> list[Asked]:
    return []


def _scalar(problem: Problem, condition: Condition, w: FieldExpr) -> list[Asked]:
    """Conditions of Poisson's equation."""
    match problem.equation, condition:
        case Poisson(conductivity=k), Neumann(flux=value):
            return [(scalar_conditions.Flux(0.0, k), (value,))]
        case Poisson(conductivity=k), Robin(coefficient=h, value=value):
            return [(scalar_conditions.Flux(0.0, k, h), (value,))]
        case _, Oblique(direction=b, coefficient=h, value=value):
            return [(scalar_conditions.Oblique(0.0, b, h), (value,))]
    return []


def _vector(problem: Problem, condition: Condition, w: FieldExpr) -> list[Asked]:
    """Conditions of an elastic body."""
    if not isinstance(problem.equation, Elasticity):
        return []
    count = problem.domain.dimension
    lame, zeros = moduli(problem.equation), (0.0,) * count
    match condition:
        case Traction(traction=given):
            return [(vector_conditions.Traction(zeros, lame), _components(given, count))]
        case Pressure(pressure=p):  # sigma n = -p n and n = -grad w
            push = tuple(field(p) * slope for slope in slopes(w, count))
            return [(vector_conditions.Traction(zeros, lame), push)]
        case Slip(traction=given):
            data = zeros if given is None else _components(given, count)
            return [(vector_conditions.TangentialTraction(zeros, lame), data)]
        case Dirichlet(value=tuple() as values):
            free = tuple(0.0 if value is None else None for value in values)
            return [(vector_conditions.Traction(free, lame), (0.0,) * free.count(0.0))]
    return []


def _plate(problem: Problem, condition: Condition, w: FieldExpr) -> list[Asked]:
    """Conditions of a plate."""
    if not isinstance(problem.equation, Plate):
        return []
    nu, d = problem.equation.poisson_ratio, field(problem.equation.stiffness)
    match condition:
        case SimplySupported(moment=m):
            return [(plate_conditions.Moment(0.0, nu, d), (m,))]
        case Free(moment=m, shear=v):
            return [(plate_conditions.Moment(0.0, nu, d), (m,)), (plate_conditions.Shear(0.0, nu, d), (v,))]
    return []


ASKED: Mapping[type, Callable[[Problem, Condition, FieldExpr], list[Asked]]] = {
    Poisson: _scalar,
    Elasticity: _vector,
    Plate: _plate,
}
"""What the conditions of each equation ask."""


def moduli(equation: Elasticity) -> tuple[FieldExpr, FieldExpr]:
    """Lame's moduli lambda and mu as fields."""
    young, ratio = _material(equation.young_modulus), _material(equation.poisson_ratio)
    return equation.first_modulus(young, ratio), young / (2.0 * (1.0 + ratio))


def _components(given: Sequence[Datum] | FromExact, count: int) -> Data:
    return (given,) * count if isinstance(given, FromExact) else tuple(given)


def _material(datum: Datum) -> FieldExpr:
    return field(datum) if callable(datum) else float(datum) * ONE
