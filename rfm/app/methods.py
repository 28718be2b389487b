"""The method of solution of a case."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from rfm.app.case import Case
from rfm.app.yaml_reader import Path

if TYPE_CHECKING:
    from solvers.method import Method
    from solvers.problem import Discretization, Problem, SolverOptions

PLACES: dict[str, Path] = {
    "method": ("solver", "method"),
    "degree": ("discretization", "degree"),
    "basis": ("discretization", "basis"),
    "linear": ("solver", "linear"),
    "conditions": ("solver", "conditions"),
    "device": ("solver", "device"),
    "shards": ("solver", "shards"),
    "singular": ("discretization", "singular"),
}
"""Keys of what can fail to combine."""

SETTINGS = ("weights", "boundary_weight")
"""Keys of the section `solver` that belong to single methods."""


def build_method(
    case: Case, problem: Problem, discretization: Discretization, options: SolverOptions
) -> Method:
    """Method of a case, with its settings.

    Raises
    ------
    CaseError
        It does not combine with the equation, the degree, the linear solver or a setting.
    """
    from solvers.method import refused
    from solvers.methods import METHODS

    method: Any = METHODS[case.solver.method]
    known = {field.name for field in fields(method)}
    given = {key: getattr(case.solver, key) for key in SETTINGS if getattr(case.solver, key) is not None}
    for key in given:
        if key not in known:
            owners = [
                name
                for name, other in METHODS.items()
                if key in {f.name for f in fields(other)}  # type: ignore[arg-type]
            ]
            message = f"the method {method.name} has no {key}; those that have: {', '.join(owners)}"
            raise case.error(("solver", key), message, key=True)
    equations = problem.equation.components(problem.domain.dimension)
    if "weights" in given and len(given["weights"]) != equations:
        message = f"must have {equations} entries, one for each equation, got {len(given['weights'])}"
        raise case.error(("solver", "weights"), message)
    refusal = refused(method, problem, discretization, options)
    if refusal is not None and refusal.of == "method" and "method" not in case.solver.model_fields_set:
        raise case.error(_without_energy(case), refusal.message, key=True)
    if refusal is not None:
        # the place says "solver.device:" already
        raise case.error(PLACES[refusal.of], refusal.message.removeprefix(f"{refusal.of}: "))
    chosen: Method = replace(method, **given)
    return chosen


def _without_energy(case: Case) -> Path:
    """Place of what leaves a problem without an energy: an oblique derivative, or the equation."""
    oblique = [i for i, condition in enumerate(case.boundary_conditions) if condition.kind == "oblique"]
    return ("boundary_conditions", oblique[0], "oblique") if oblique else ("equation", case.equation.name)
