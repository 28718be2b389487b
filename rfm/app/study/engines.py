"""Who computes the runs of a study: this process, or processes of this computer.

All have one method, ``outcomes``, which yields the outcomes of tasks as they end, in any order.  Stopping the
iteration stops the work. :mod:`rfm.app.study.cluster` is their sibling for many computers.
"""

from __future__ import annotations

import os
import signal
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING, Protocol

from rfm.app.study.task import Outcome, Task, execute, lost, one_thread

if TYPE_CHECKING:
    from solvers.stopwatch import Listener

Work = Callable[[Task], Outcome]

PATIENCE = 5.0
"""Seconds of work in this process before others are started: a process takes about one second to be of use."""

TRIES = 2
"""Times a run is begun before the loss of its process counts as its failure."""


class Engine(Protocol):
    """Computes runs."""

    def outcomes(self, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Outcomes of `tasks` as they end."""
        ...


@dataclass(frozen=True)
class Here:
    """Computes one run after the other in this process.

    Attributes
    ----------
    listener
        Told about phases and progress.
    """

    listener: Listener | None = None

    def outcomes(self, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Outcomes in the order of the tasks."""
        for task in tasks:
            yield execute(task, self.listener)


@dataclass(frozen=True)
class Automatic:
    """Begins in this process, and goes on in several when the study turns out to be long.

    Attributes
    ----------
    listener
        Told about phases and progress of what runs here.
    patience
        Seconds of work here.
    """

    listener: Listener | None = None
    patience: float = PATIENCE

    def outcomes(self, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Outcomes as they end."""
        begun = time.monotonic()
        for done, task in enumerate(tasks, start=1):
            yield execute(task, self.listener)
            rest = tasks[done:]
            jobs = min(processors(), len(rest))
            if jobs > 1 and time.monotonic() - begun > self.patience:
                yield from Processes(jobs).outcomes(rest)
                return


@dataclass(frozen=True)
class Processes:
    """Computes runs in processes of this computer, each with one thread and its share of the memory.

    A run whose process dies is begun once more in a new one; the others go on.

    Attributes
    ----------
    jobs
        Number of processes.
    work
        What makes a run.
    """

    jobs: int
    work: Work = execute

    def outcomes(self, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Outcomes as they end."""
        jobs = min(self.jobs, len(tasks))
        waiting = deque((replace(task, share=1.0 / jobs), TRIES) for task in tasks)
        workers = [_Worker(self.work) for _ in range(jobs)]
        try:
            while waiting or any(worker.busy for worker in workers):
                for worker in workers:
                    if waiting and not worker.busy:
                        worker.begin(*waiting.popleft())
                for worker in _ready(workers):
                    task, tries = worker.task, worker.tries - 1
                    outcome = worker.outcome()
                    if outcome is None:
                        workers[workers.index(worker)] = _Worker(self.work)
                        if tries:
                            waiting.append((task, tries))
                            continue
                        outcome = lost(
                            task, f"its process ended {TRIES} times ({worker.ending}); out of memory?"
                        )
                    yield outcome
        finally:
            for worker in workers:
                worker.stop()


class _Worker:
    """A process that makes one run after the other."""

    def __init__(self, work: Work) -> None:
        context = get_context("spawn")  # a fork would copy the threads of BLAS, which do not live on
        self._pipe, other = context.Pipe()
        self._process = context.Process(target=_serve, args=(other, work), daemon=True)
        self._process.start()
        other.close()
        self.busy = False

    def begin(self, task: Task, tries: int) -> None:
        """Begin a run that may be begun this many times."""
        self.task, self.tries, self.busy = task, tries, True
        try:
            self._pipe.send(task)
        except OSError:  # it died while it had nothing to do: seen by outcome()
            self._pipe.close()

    @property
    def ready(self) -> Connection | int:
        """What becomes ready when the run has ended, or the process."""
        return self._process.sentinel if self._pipe.closed else self._pipe

    def outcome(self) -> Outcome | None:
        """Outcome of the run; None when the process is gone."""
        self.busy = False
        try:
            outcome: Outcome = self._pipe.recv()
        except (EOFError, OSError):
            self._process.join()
            return None
        return outcome

    @property
    def ending(self) -> str:
        """How the process ended."""
        code = self._process.exitcode or 0
        return f"signal {-code}" if code < 0 else f"exit code {code}"

    def stop(self) -> None:
        """End the process, whatever it does."""
        self._pipe.close()
        self._process.terminate()
        self._process.join()


def _ready(workers: Sequence[_Worker]) -> list[_Worker]:
    """Wait until a run has ended; the workers whose runs have."""
    found = wait([worker.ready for worker in workers if worker.busy])
    return [worker for worker in workers if worker.busy and worker.ready in found]


def _serve(pipe: Connection, work: Work) -> None:
    """Make runs until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all; the process of the study decides
    one_thread()
    while True:
        try:
            pipe.send(work(pipe.recv()))
        except (EOFError, BrokenPipeError):  # the study has ended, or its process was killed
            return


def processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
