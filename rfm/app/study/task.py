"""One run of a study: what is sent to whoever computes it, and what comes back.

Both are plain data, so that they pass between processes and computers; the files of a run come back as their content
and are written by the process of the study.  Little is imported here before a run begins: a worker sets its threads
first.
"""

from __future__ import annotations

import os
import platform
import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from rfm.app.source import Document
from rfm.errors import CaseError, DiscretizationError, RfmError

if TYPE_CHECKING:
    from solvers.stopwatch import Listener

DONE, REFUSED, FAILED, PENDING = "done", "refused", "failed", "pending"
"""States of a run; refused: its grid is too coarse for its degree, or would not fit into memory."""


@dataclass(frozen=True)
class Task:
    """A run that is to be made.

    Attributes
    ----------
    name
        Name of its folder, unique in the study.
    settings
        Values of the keys that vary.
    document
        The case with these values.
    degree, grid
        Of the case with these values; no grid where the spacing is given.
    digest
        Of the resolved case and the version of the program: a run with another one is not this run.
    folder
        Folder of the run, for its summary.
    files
        Names of the files to make.
    share
        Part of the available memory that it may use.
    allow_large
        Whether it may use more.
    """

    name: str
    settings: Mapping[str, Any]
    document: Document
    degree: int
    grid: int | None
    digest: str
    folder: str = ""
    files: tuple[str, ...] = ()
    share: float = 1.0
    allow_large: bool = False


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes
    ----------
    name, state
        Of its task; ``done``, ``refused`` or ``failed``.
    summary, files
        Of a run that is done: as in ``summary.json``, and the content of its files by name.
    error
        Of one that is not: ``kind``, ``message``, ``text`` (with the place), ``exit_code``, and of a defect of the
        program the ``traceback``.
    seconds, where
        Wall time, files included, and the computer.
    """

    name: str
    state: str
    summary: Mapping[str, Any] | None = None
    files: Mapping[str, bytes] = field(default_factory=dict)
    error: Mapping[str, Any] | None = None
    seconds: float = 0.0
    where: str = ""


def execute(task: Task, listener: Listener | None = None) -> Outcome:
    """Make a run; whatever goes wrong with it is in the outcome."""
    clock = time.perf_counter()
    summary: Mapping[str, Any] | None = None
    files: Mapping[str, bytes] = {}
    error, state = None, DONE
    try:
        summary, files = _computed(task, listener)
    except Exception as failure:  # a study goes on whatever becomes of one run
        small = isinstance(failure, CaseError) and isinstance(failure.__cause__, DiscretizationError)
        state, error = REFUSED if small else FAILED, _facts(failure)
    seconds = round(time.perf_counter() - clock, 6)
    return Outcome(task.name, state, summary, files, error, seconds, platform.node())


def _computed(task: Task, listener: Listener | None) -> tuple[Mapping[str, Any], Mapping[str, bytes]]:
    from rfm.app.case import case_from_document
    from rfm.app.memory import refuse_large
    from rfm.app.output import contents
    from rfm.app.run import compute, record_of

    case = case_from_document(task.document, {})
    if not task.allow_large:
        refuse_large(case, task.share)
    result = compute(case, listener)
    result.summary["study"] = {"run": task.name, "settings": dict(task.settings), "digest": task.digest}
    if not task.files:
        return result.summary, {}
    return result.summary, contents(record_of(result), task.folder, task.files)


def _facts(failure: Exception) -> dict[str, Any]:
    known = isinstance(failure, RfmError)
    message = failure.message if isinstance(failure, CaseError) else str(failure)
    facts = {
        "kind": type(failure).__name__,
        "message": message or type(failure).__name__,
        "text": str(failure) or type(failure).__name__,
        "exit_code": failure.exit_code if isinstance(failure, RfmError) else 3,
    }
    if isinstance(failure, MemoryError):
        facts["message"] = facts["text"] = "not enough memory; take a coarser grid or a lower degree"
    elif not known:
        facts["traceback"] = "".join(traceback.format_exception(failure))
    return facts


def lost(task: Task, why: str) -> Outcome:
    """Outcome of a run whose process or computer is gone."""
    error = {"kind": "WorkerLost", "message": why, "text": why, "exit_code": 3}
    return Outcome(task.name, FAILED, error=error)


def one_thread() -> None:
    """Make this process, which has begun no work yet, compute with one thread: it is one of several."""
    for library in ("OMP", "OPENBLAS", "MKL", "NUMEXPR"):
        os.environ[f"{library}_NUM_THREADS"] = "1"
