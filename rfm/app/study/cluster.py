"""The runs of a study on a cluster of Dask (https://distributed.dask.org).

The scheduler gives the runs to its workers; records and files come back to the process of the study, so that the
computers need not share a file system.  A run whose worker is lost is begun again when all others have ended, alone,
and fails when that worker is lost too.
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from rfm import __version__
from rfm.app.study.engines import processors
from rfm.app.study.task import Outcome, Task, execute, lost
from rfm.errors import RfmError

LOCAL = "local"

REACHED, JOINED = 10.0, 30.0
"""Seconds to wait for the scheduler, and for its first worker."""


class ClusterError(RfmError):
    """The cluster cannot be used."""


@dataclass(frozen=True)
class Cluster:
    """Computes runs on a cluster.

    Attributes
    ----------
    address
        Of the scheduler, such as ``tcp://host:8786``; ``local`` starts a cluster on this computer for the study.
    jobs
        Workers of a local cluster.
    work
        What makes a run.
    timeout
        Seconds to wait for the scheduler.
    """

    address: str = LOCAL
    jobs: int | None = None
    work: Callable[[Task], Outcome] = execute
    timeout: float = REACHED

    def outcomes(self, tasks: Sequence[Task]) -> Iterator[Outcome]:
        """Outcomes as they end.

        Raises
        ------
        ClusterError
            Dask is not installed, the scheduler is not reached, it has no worker, or a worker has another version.
        """
        if not tasks:
            return
        try:
            distributed: Any = import_module("distributed")
        except ImportError as error:
            message = "--scheduler needs the package distributed: install it with pip install 'rfm[cluster]'"
            raise ClusterError(message) from error
        with self._client(distributed, len(tasks)) as client:
            self._require_workers(client)
            suspects = []
            for task, outcome in self._submitted(distributed, client, tasks):
                if outcome is None:
                    suspects.append(task)
                else:
                    yield outcome
            for task in suspects:
                # alone: a run that waited at the worker of another that ended it is not to blame
                for _, outcome in self._submitted(distributed, client, [task]):
                    yield outcome or lost(task, "its worker was lost each time it was begun; out of memory?")

    def _submitted(
        self, distributed: Any, client: Any, tasks: Sequence[Task]
    ) -> Iterator[tuple[Task, Outcome | None]]:
        """Outcomes of tasks as they end; None for one whose workers were lost."""
        study = f"run-{uuid.uuid4().hex}"  # one name for all: of equal tasks the scheduler gives a worker one at a time
        keys = [(study, number) for number in range(len(tasks))]
        futures = dict(zip(client.map(self.work, tasks, key=keys, pure=False), tasks, strict=True))
        try:
            ended = distributed.as_completed(
                list(futures), loop=client.loop, with_results=True, raise_errors=False
            )
            for future, result in ended:
                task = futures.pop(future)
                yield task, _outcome(future, result, task)
                future.release()
        finally:
            if futures:
                client.cancel(list(futures), force=True)

    @contextmanager
    def _client(self, distributed: Any, count: int) -> Iterator[Any]:
        if self.address == LOCAL:
            jobs = min(self.jobs or processors(), count)
            with _local(distributed, jobs) as cluster, distributed.Client(cluster) as client:
                yield client
            return
        try:
            comm = import_module("distributed.comm")
            comm.get_address_host_port(comm.normalize_address(self.address), strict=True)
            client = distributed.Client(self.address, timeout=self.timeout, set_as_default=False)
        except (OSError, ValueError) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise ClusterError(
                f"cannot reach a scheduler at {self.address}: {reason}; start one with `dask scheduler` and give its "
                "address, such as tcp://host:8786, or leave out --scheduler"
            ) from error
        with client:
            yield client

    def _require_workers(self, client: Any) -> None:
        try:
            client.wait_for_workers(1, timeout=JOINED)
        except TimeoutError as error:
            raise ClusterError(
                f"the scheduler at {self.address} has no workers: start some with "
                f"`dask worker {self.address} --nthreads 1 --nworkers auto`"
            ) from error
        try:
            found = client.run(installed)
        except Exception as error:
            raise ClusterError(
                f"the workers of {self.address} cannot load rfm ({error}): install it there, the same version"
            ) from error
        for worker, version in found.items():
            if version != __version__:
                raise ClusterError(
                    f"the worker {worker} has rfm {version}, this is rfm {__version__}: install the same version on all"
                )


def installed() -> str:
    """Version of the program where this is called."""
    return __version__


@contextmanager
def _local(distributed: Any, jobs: int) -> Iterator[Any]:
    """Start a cluster of processes with one thread each on this computer."""
    import logging

    import dask

    settings = {
        "distributed.scheduler.allowed-failures": 0,
        "distributed.scheduler.worker-saturation": 1.0,  # no run waits at a worker that another run may end
    }
    with (
        dask.config.set(settings),
        distributed.LocalCluster(
            n_workers=jobs,
            threads_per_worker=1,
            processes=True,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.CRITICAL,
        ) as cluster,
    ):
        yield cluster


def _outcome(future: Any, result: Any, task: Task) -> Outcome | None:
    """What became of a run; None when its workers were lost."""
    if isinstance(result, Outcome):
        return result
    if future.status == "error":
        error = future.exception()
        return (
            None if type(error).__name__ == "KilledWorker" else lost(task, f"{type(error).__name__}: {error}")
        )
    return lost(task, f"the scheduler gave it up ({future.status}): was the connection lost?")
