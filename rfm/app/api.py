"""The Python entry: solve a case, load a finished run, evaluate either."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rfm.app.case import Case, load_case

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from rfm.app.record import RunRecord
    from rfm.app.restored import Restored
    from rfm.app.run import Result
    from rfm.calculus.types import Array
    from solvers.solution import Trial
    from solvers.stopwatch import Listener


@dataclass(frozen=True)
class Run:
    """A solved case: evaluate the field, read the summary.

    Attributes
    ----------
    case
        The case as resolved.
    trial
        The field.
    summary
        As in ``summary.json``.
    result
        What was computed in this process; None for a run loaded from a file.
    restored
        What was loaded from a file.
    """

    case: Case
    trial: Trial
    summary: Mapping[str, Any]
    result: Result | None = None
    restored: Restored | None = None

    def u(self, points: ArrayLike) -> Array:
        """Values of u at points (n, d), shape (n,), of a vector (n, d); meaningful inside the domain."""
        return self.trial.values(points)

    def gradient(self, points: ArrayLike) -> Array:
        """Gradient of u at points (n, d), shape (n, d), of a vector (n, d, d)."""
        return self.trial.gradient(points)

    def plot(self) -> Figure:
        """Picture of the field as a matplotlib figure."""
        from rfm.app.pictures import solution_figure
        from rfm.app.samples import sample

        record = self._record()
        return solution_figure(record, sample(record))

    def save(self, directory: str | Path) -> dict[str, str]:
        """Write the run directory and return its files by name."""
        from rfm.app.output import write_run

        return write_run(self._record(), directory)

    def _record(self) -> RunRecord:
        from rfm.app.run import record_of

        if self.restored is not None:
            return self.restored.record()
        if self.result is None:
            raise RuntimeError("a solved run has its result")
        return record_of(self.result)


def solve(
    case: str | Path | Mapping[str, Any] | Case,
    set: Mapping[str, Any] | None = None,
    listener: Listener | None = None,
) -> Run:
    """Solve a case.

    Parameters
    ----------
    case
        Case file, the data of a case, or a case.
    set
        Overrides by dotted path, e.g. ``{"discretization.grid": 64}``.
    listener
        Told about phases and progress.

    Raises
    ------
    RfmError
        The case is wrong or the numerics failed; the message says where and what to do.
    """
    from rfm.app.run import compute

    loaded = case if isinstance(case, Case) else load_case(case, dict(set or {}))
    result = compute(loaded, listener)
    return Run(loaded, result.solution.trial, result.summary, result)


def load(path: str | Path) -> Run:
    """Load a finished run from its directory or its ``solution.h5``; evaluates as the original did.

    Raises
    ------
    StorageError
        The file is no solution of this program.
    """
    from rfm.app.restored import restore

    restored = restore(path)
    return Run(restored.case, restored.trial, restored.stored.summary, restored=restored)
