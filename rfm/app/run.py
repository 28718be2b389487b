"""One run of a case: build, solve, measure, and, when asked, write its directory."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from rfm.app.build import build_discretization, build_problem, located, solver_options
from rfm.app.case import Case
from rfm.app.derived import everywhere, pictured
from rfm.app.methods import build_method
from rfm.app.record import FurtherSpline, LinearFacts, Provenance, Residual, RunRecord
from rfm.app.schema.base import Strict
from rfm.app.singularities import singularities
from rfm.app.summary import Miss, misses, summarise
from rfm.errors import RfmError

if TYPE_CHECKING:
    from solvers.classify import Classification
    from solvers.problem import Discretization, Problem
    from solvers.solution import Solution, Trial
    from solvers.stopwatch import Listener


@dataclass(frozen=True)
class Result:
    """A solved case in memory.

    Attributes
    ----------
    case, solution
        What was asked for and what came out.
    summary
        Everything worth a number, as in ``summary.json``.
    misses
        Expectations of the case that are not met.
    warnings
        What the user should know although the run went through.
    started
        When the run began (UTC).
    """

    case: Case
    solution: Solution
    summary: dict[str, Any]
    misses: tuple[Miss, ...]
    warnings: tuple[str, ...] = ()
    started: datetime = field(default_factory=lambda: datetime.now(UTC))


def compute(case: Case, listener: Listener | None = None) -> Result:
    """Solve a case and measure the result; nothing is written.

    Raises
    ------
    CaseError
        The case is wrong; the message carries the place.
    RfmError
        The shape, the discretisation or the numerics refuse it.
    """
    from rfm.app.warnings import warnings_of
    from solvers import pipeline
    from solvers.device.processes import telling

    started, clock = datetime.now(UTC), time.perf_counter()
    try:
        problem = build_problem(case)
        discretization = build_discretization(case, problem.domain)
        options = solver_options(case)
        method = build_method(case, problem, discretization, options)
        with telling(options.device):
            solution = pipeline.solve(problem, discretization, method, options, listener)
            summary = summarise(case, solution)
            warnings = warnings_of(solution)
    except RfmError as error:
        raise located(case, error) from error
    summary["warnings"] = list(warnings)
    summary["seconds"]["total"] = round(time.perf_counter() - clock, 6)
    missed = tuple(misses(case, summary))
    if missed:
        summary["status"] = "missed"
    return Result(case, solution, summary, missed, warnings, started)


def record_of(result: Result, study: tuple[dict[str, Any], ...] | None = None) -> RunRecord:
    """Everything files, pictures and the report are made of."""
    solution = result.solution
    return make_record(
        result.case,
        solution.problem,
        solution.discretization,
        solution.trial,
        solution.background.classification,
        result.summary,
        Provenance.collect(result.started),
        study,
    )


def make_record(
    case: Case,
    problem: Problem,
    discretization: Discretization,
    trial: Trial,
    classification: Classification,
    summary: Mapping[str, Any],
    provenance: Provenance,
    study: tuple[dict[str, Any], ...] | None = None,
) -> RunRecord:
    """Record of a field that was solved for just now, or loaded."""
    residuals = tuple(
        Residual(c.part.name, given.kind, _data_text(given), summary["boundary_error"].get(c.part.name, 0.0))
        for c, given in zip(problem.conditions, case.boundary_conditions, strict=True)
    )
    linear = summary["linear"]
    return RunRecord(
        name=case.name,
        title=case.title or case.name,
        case=case.to_dict(),
        summary=summary,
        domain=problem.domain,
        grid=trial.grid,
        classification=classification,
        degree=trial.degree,
        basis=discretization.basis,
        coefficients=trial.splines[0].coefficients,
        more=tuple(FurtherSpline(psi.degree, psi.coefficients) for psi in trial.splines[1:]),
        u=trial.values,
        gradient=trial.gradient,
        derived=pictured(problem, trial),
        provenance=provenance,
        exact=everywhere(problem),
        residuals=residuals,
        timings=summary["seconds"],
        linear=LinearFacts(
            linear["method"], linear["reason"], summary["dofs"], linear["residual"], linear["iterations"]
        ),
        study=study,
        singularities=singularities(problem, discretization),
    )


def _data_text(condition: Any) -> str:
    """Data of a condition of the case as the user wrote them."""
    value = getattr(condition, condition.kind)
    if condition.kind == "robin":
        return f"{_text(value.coefficient)} u + k du/dn = {_text(value.value)}"
    if isinstance(value, Strict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value)
    return _text(value)


def _text(datum: Any) -> str:
    if isinstance(datum, tuple):
        return f"[{', '.join('free' if item is None else _text(item) for item in datum)}]"
    return str(getattr(datum, "text", datum))
