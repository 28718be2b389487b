"""The solution structure of a problem: essential conditions by construction, the rest left to the functional."""

from __future__ import annotations

from rfm.calculus.types import Field
from rfm.geometry.part import Part
from rfm.geometry.weight import Weighting
from solvers.data import as_field
from solvers.essential import essential_structure, prescribed
from solvers.exact import components_of, required
from solvers.problem import FromExact, Problem
from structures.operator import Operator

__all__ = ["as_field", "prescribed_values", "trial_structure"]


def trial_structure(problem: Problem, weight: Weighting | Field) -> Operator:
    """Structure of a scalar problem; see :func:`solvers.essential.essential_structure`."""
    (operator,) = essential_structure(problem, weight)
    return operator


def prescribed_values(problem: Problem) -> list[list[tuple[Part, Field]]]:
    """For each component, the parts where its value is prescribed with the value, exact ones included."""
    count = problem.equation.components(problem.domain.dimension)
    return [
        [
            (
                piece.part,
                components_of(required(problem.exact))[c]
                if isinstance(piece.value, FromExact)
                else as_field(piece.value),
            )
            for piece in prescribed(problem, c, count)
        ]
        for c in range(count)
    ]
