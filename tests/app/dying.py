"""Work for processes and clusters in tests: some of it ends the process it runs in."""

import os
import time

from rfm.app.study.task import DONE, Outcome, Task

SUMMARY = {
    "degree": 1,
    "grid": 8,
    "dofs": 1,
    "relative_l2_error": None,
    "relative_h1_error": None,
    "relative_max_error": None,
    "energy": None,
    "seconds": {"total": 0.0},
}


def answer(task: Task) -> Outcome:
    """A run without any work, with a pause so that all processes get one; those of grid 13 end the process."""
    if task.grid == 13:
        os._exit(7)
    time.sleep(0.1)
    summary = {
        **SUMMARY,
        "grid": task.grid,
        "study": {"digest": task.digest, "settings": dict(task.settings)},
    }
    threads = os.environ.get("OMP_NUM_THREADS", "")
    return Outcome(task.name, DONE, summary, where=f"{os.getpid()} {threads}")


def nothing(task: Task) -> Outcome:
    """No work at all."""
    return Outcome(task.name, DONE)
