"""Flux conditions of a problem in the normal form of :mod:`structures.localized`.

Data taken from the exact solution are extended as its flux through the level sets of w, plus w times a fixed generic
field: the values on the part are told, never those inside.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from rfm.errors import DiscretizationError
from rfm.geometry.part import Part
from solvers.data import as_field
from solvers.equations.elasticity import Elasticity
from solvers.equations.poisson import Poisson
from solvers.exact import components_of
from solvers.problem import (
    Clamped,
    Condition,
    Datum,
    Dirichlet,
    FromExact,
    Neumann,
    Periodic,
    Pressure,
    Problem,
    Robin,
    Traction,
)
from structures.contact import boundary_points
from structures.field_expression import ONE, ZERO, FieldExpr, differentiate, field, unit
from structures.localized import FluxCondition, conormal, gradient, traction
from structures.manufactured import generic_field


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


def flux_condition(problem: Problem, condition: Condition, w: FieldExpr) -> FluxCondition:
    """Return a condition of the problem in normal form.

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
    equation, dimension = problem.equation, problem.domain.dimension
    match equation, condition:
        case Poisson(conductivity=k), Neumann(flux=value) | Robin(value=value):
            h = as_field(condition.coefficient) if isinstance(condition, Robin) else 0.0
            made = conormal(
                w, dimension, as_field(k), h, ZERO if isinstance(value, FromExact) else field(as_field(value))
            )
            return manufactured(problem, made) if isinstance(value, FromExact) else made
        case Elasticity(), Traction(traction=value):
            if isinstance(value, FromExact):
                return manufactured(problem, traction(w, moduli(equation), (ZERO,) * dimension))
            return traction(w, moduli(equation), [field(as_field(t)) for t in value])
        case Elasticity(), Pressure(pressure=value):
            push = field(as_field(value))  # sigma n = -p n and n = -grad w
            return traction(w, moduli(equation), [push * slope for slope in gradient(w, dimension)])
    raise DiscretizationError(
        f"conditions: exact has no structure for {type(condition).__name__} with the equation "
        f"{equation.name} ({condition.part.name}): it has Neumann and Robin of poisson, Traction and Pressure of "
        "elasticity; use conditions: natural"
    )


def moduli(equation: Elasticity) -> tuple[FieldExpr, FieldExpr]:
    """Lame's moduli lambda and mu as fields."""
    young, ratio = _material(equation.young_modulus), _material(equation.poisson_ratio)
    return equation.first_modulus(young, ratio), young / (2.0 * (1.0 + ratio))


def manufactured(problem: Problem, condition: FluxCondition) -> FluxCondition:
    """Return the condition with the values that the exact solution has on the part, extended generically."""
    if problem.exact is None:
        raise ValueError("data 'from exact' need an exact solution")
    exact = [field(component) for component in components_of(problem.exact)]
    dimension = problem.domain.dimension
    generic = condition.w * generic_field(problem.domain.box)
    values = []
    for row in condition.rows:
        total = generic
        for position, coefficient in row.items():
            component, beta = divmod(position, dimension + 1)
            u = exact[component]
            total = total + coefficient * (u if beta == 0 else differentiate(u, unit(dimension, beta - 1)))
        values.append(total)
    return replace(condition, values=tuple(values))


def _material(datum: Datum) -> FieldExpr:
    return field(datum) if callable(datum) else float(datum) * ONE
