"""`rfm check`: everything that can be wrong with a case before it is solved."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rfm.app.build import build_discretization, build_problem, located, solver_options
from rfm.app.case import Case
from rfm.app.cli.outcome import DONE, print_json
from rfm.app.cli.output import table
from rfm.app.cli.settings import load
from rfm.app.memory import require_memory, required_bytes
from rfm.app.memory import shown as shown_bytes
from rfm.app.methods import build_method
from rfm.errors import RfmError


def check_case(*, file: Path, settings: Sequence[str], allow_large: bool, as_json: bool) -> int:
    """Check a case; returns the exit code."""
    case = load(file, settings)
    facts = findings(case, allow_large)
    rows = [(key, value) for key, value in facts.items() if key != "status"]
    table(("checked", "found"), rows, as_json, title=case.title or case.name)
    if as_json:
        print_json(facts)
    return DONE


def findings(case: Case, allow_large: bool = False) -> dict[str, Any]:
    """Facts about a case that is right.

    Raises
    ------
    CaseError, GeometryError, DiscretizationError
        It is wrong.
    """
    from solvers.background import background_grid
    from solvers.classify import classify

    try:
        problem = build_problem(case)
        discretization = build_discretization(case, problem.domain)
        build_method(case, problem, discretization, solver_options(case))
        if not allow_large:
            require_memory(problem.domain, discretization)
        grid = background_grid(problem.domain, discretization)
        classification = classify(problem.domain, grid)
    except RfmError as error:
        raise located(case, error) from error
    inner, cut = len(classification.inner_cells), len(classification.cut_cells)
    total = int(np.prod(classification.state.shape))
    report = problem.domain.report()
    return {
        "status": "ok",
        "case": case.name,
        "dimension": problem.domain.dimension,
        "parts": list(problem.domain.parts),
        "function": report.lines(),
        "inversion_degree": report.inversion_degree,
        "degree": discretization.degree,
        "cells": [int(n) for n in classification.state.shape],
        "inner_cells": inner,
        "cut_cells": cut,
        "outer_cells": total - inner - cut,
        "memory": shown_bytes(required_bytes(problem.domain, discretization, len(case.unknowns))),
    }
