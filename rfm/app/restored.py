"""A finished run as its file holds it: evaluated, drawn and reported without solving it again."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.app.build import build_discretization, build_problem, solver_options
from rfm.app.case import Case, load_case
from rfm.app.record import RunRecord
from rfm.app.storage import StoredSolution, load

if TYPE_CHECKING:
    from solvers.problem import Discretization, Problem
    from solvers.solution import Trial


@dataclass(frozen=True)
class Restored:
    """What a run is made of, from its ``solution.h5``."""

    stored: StoredSolution
    case: Case
    problem: Problem
    discretization: Discretization
    trial: Trial

    def record(self, study: tuple[dict[str, Any], ...] | None = None) -> RunRecord:
        """Record of the run as it was when it ended."""
        from rfm.app.run import make_record
        from solvers.classify import classify

        stored = self.stored
        record = make_record(
            self.case,
            self.problem,
            self.discretization,
            self.trial,
            classify(self.problem.domain, self.trial.grid),
            stored.summary,
            stored.provenance,
            study,
        )
        return replace(record, name=stored.name, title=stored.title)


def restore(path: str | Path) -> Restored:
    """Restore a run from its directory or its ``solution.h5``.

    Raises
    ------
    StorageError
        The file is no solution of this program.
    """
    from solvers.bases.registry import basis
    from solvers.corners.setting import corner_space, settled
    from solvers.grid import Grid
    from solvers.materials import stored_trial

    stored = load(path)
    case = load_case(stored.case)
    problem = build_problem(case)
    discretization = build_discretization(case, problem.domain)
    grid = Grid(np.array(stored.lower), np.array(stored.spacing), np.array(stored.cells))
    family = basis(stored.basis)
    discretization = settled(discretization, case.solver.method, solver_options(case), problem)
    corners = corner_space(problem, discretization, grid) if stored.more else None
    if corners is None:
        discretization = replace(discretization, singular="none")
    splines = (
        family.load(grid, stored.degree, stored.coefficients),
        *(
            family.load(grid, other.degree, other.coefficients)
            if corners is None
            else corners.load(other.coefficients)
            for other in stored.more
        ),
    )
    trial = stored_trial(problem, discretization, grid, splines)
    return Restored(stored, case, problem, discretization, trial)
