"""The solution structure of a problem: essential conditions by construction, the rest left to the functional."""

from __future__ import annotations

from rfm.calculus.types import Field
from rfm.geometry.part import Part
from rfm.geometry.weight import weight as build_weight
from solvers.boundary import require_exact
from solvers.problem import Dirichlet, FromExact, Problem
from structures.dirichlet import dirichlet
from structures.manufactured import manufactured_extension
from structures.operator import Operator


def trial_structure(problem: Problem, weight: str) -> Operator:
    """Structure ``u = u0 + w psi`` of the Dirichlet conditions of `problem` (``u = psi`` without any).

    Data taken from the exact solution are extended as ``exact + w q`` with a fixed generic q: the solver is
    told the values on the boundary, never the answer inside.
    """
    data: list[tuple[Part, Field]] = []
    manufactured: list[Part] = []
    for condition in problem.conditions:
        if isinstance(condition, Dirichlet):
            if isinstance(condition.value, FromExact):
                manufactured.append(condition.part)
            else:
                data.append((condition.part, as_field(condition.value)))
    if manufactured:
        part = manufactured[0]
        for other in manufactured[1:]:
            part = part | other
        vanishing = build_weight(problem.domain, part, weight)
        extended = manufactured_extension(require_exact(problem), vanishing, problem.domain.box)
        data += [(part, extended) for part in manufactured]
    return dirichlet(problem.domain, data, weight=weight)


def prescribed_values(problem: Problem) -> list[tuple[Part, Field]]:
    """Dirichlet parts with their values, those from the exact solution included."""
    return [
        (c.part, require_exact(problem) if isinstance(c.value, FromExact) else as_field(c.value))
        for c in problem.conditions
        if isinstance(c, Dirichlet)
    ]


def as_field(datum: Field | float) -> Field:
    """Return `datum` as a field, numbers as constants."""
    if callable(datum):
        return datum
    number = float(datum)

    def constant(*_: object) -> float:
        return number

    constant.source = repr(number)  # type: ignore[attr-defined]
    return constant
