"""Several processes of JAX that solve one problem: how they are joined, and what they tell each other."""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import NumericsError, RfmError
from solvers.device.backend import NONE, computing
from solvers.device.team import Alone, Team

AUTO = "auto"
"""Address with which JAX asks the environment (Slurm, Open MPI) who the processes are."""
PATIENCE = 60.0
"""Seconds to wait for the other processes."""
AT_ONCE = 2**20
"""Numbers that are summed over the processes at a time."""


def join(
    coordinator: str, count: int | None = None, index: int | None = None, patience: float = PATIENCE
) -> int:
    """Make this process one of several that solve together; to be called before anything is computed by JAX.

    Returns the number of this process.

    Parameters
    ----------
    coordinator
        ``HOST:PORT`` at which process 0 listens, the same for all; ``auto`` under Slurm or Open MPI.
    count, index
        Number of processes, and of this one from 0.
    patience
        Seconds to wait for the others.

    Raises
    ------
    RfmError
        The others are not there, or JAX computes already.
    """
    from solvers.device.rendezvous import meet

    given: dict[str, Any] = {"coordinator_address": coordinator, "num_processes": count, "process_id": index}
    if coordinator == AUTO:
        given = {}
    elif count is None or index is None:
        raise RfmError(f"--coordinator {coordinator} needs --processes and --process")
    else:
        meet(coordinator, count, index, patience)
    import jax

    _keep_standard_output()
    config: Any = jax.config
    config.update("jax_cpu_collectives_implementation", "gloo")
    try:
        jax.distributed.initialize(**given)
    except (RuntimeError, ValueError) as error:
        advice = " (auto needs Slurm or Open MPI; otherwise give HOST:PORT)" if coordinator == AUTO else ""
        raise RfmError(f"the processes cannot be joined: {error}{advice}") from error
    return jax.process_index()


def _keep_standard_output() -> None:
    """Give standard output to Python alone: the processors' collectives report their connections there."""
    output = sys.__stdout__
    if output is None or sys.stdout is not output or output.fileno() != 1:
        return
    output.flush()
    own = os.dup(1)
    os.dup2(2, 1)
    sys.stdout = os.fdopen(own, "w", buffering=1, encoding=output.encoding)


def team_of(kind: str) -> Team:
    """The processes that solve together on devices of a kind."""
    if kind == NONE:
        return Alone()
    import jax

    return Alone() if jax.process_count() == 1 else _joined(kind)


@cache
def _joined(kind: str) -> Processes:
    return Processes(kind)


@contextmanager
def telling(kind: str) -> Iterator[None]:
    """Context whose errors are told to the other processes, which then do not wait for this one."""
    team = team_of(kind)
    if not isinstance(team, Processes):
        yield
        return
    team.depth += 1
    team.informed = team.informed and team.depth > 1
    try:
        yield
    except Exception as error:
        team.fail(error)
        raise
    finally:
        team.depth -= 1


class Processes:
    """Several processes with devices of a kind; see :class:`solvers.device.team.Team`.

    Parameters
    ----------
    kind
        Kind of the devices through which they talk.
    """

    def __init__(self, kind: str) -> None:
        import jax

        self.kind, self.index, self.count = kind, jax.process_index(), jax.process_count()
        self.depth, self.informed = 0, False
        firsts = {one.process_index: one for one in reversed(jax.devices(kind))}
        sharding: Any = jax.sharding
        mesh = sharding.Mesh(np.array([firsts[k] for k in range(self.count)]), ("processes",))
        self._each = sharding.NamedSharding(mesh, sharding.PartitionSpec("processes"))
        self._all = sharding.NamedSharding(mesh, sharding.PartitionSpec())
        self._own = firsts[self.index]

    def gather(self, value: Any) -> list[Any]:
        """See :class:`solvers.device.team.Team`.

        Raises
        ------
        RfmError
            Another process has failed.
        """
        return self._gather(value, None)

    def total(self, array: Array) -> Array:
        """See :class:`solvers.device.team.Team`."""
        found = np.empty(array.size)
        for start in range(0, array.size, AT_ONCE):
            piece = array.ravel()[start : start + AT_ONCE]
            found[start : start + AT_ONCE] = self._everywhere(_sum, piece)
        return found.reshape(array.shape)

    def fail(self, error: Exception) -> None:
        """Tell the others, who call :meth:`gather` meanwhile, that this process has failed."""
        if not self.informed:
            try:
                self._gather(None, error)
            except RfmError:  # several have failed; each says its own
                return

    def _gather(self, value: Any, error: Exception | None) -> list[Any]:
        code = getattr(error, "exit_code", NumericsError.exit_code)
        failure = None if error is None else (code, str(error))
        data = np.frombuffer(pickle.dumps((failure, value)), dtype=np.uint8)
        sizes = self._everywhere(_same, np.array([len(data)], dtype=np.int64))[:, 0]
        room = 1 << int(sizes.max() - 1).bit_length()  # few lengths, few programs
        rows = self._everywhere(_same, np.pad(data, (0, room - len(data))))
        found = [pickle.loads(row[:size].tobytes()) for row, size in zip(rows, sizes, strict=True)]
        for number, (failed, _) in enumerate(found):
            if failed is not None:
                self.informed = True
                code, message = failed
                raise (NumericsError if code == NumericsError.exit_code else RfmError)(
                    f"process {number} has failed: {message}"
                )
        return [one for _, one in found]

    def _everywhere(self, function: Any, own: Array) -> Array:
        """Function of the stacked arrays (processes, n) of all processes."""
        import jax

        with computing(self.kind):
            piece = jax.device_put(own[None], self._own)
            shape = (self.count, *own.shape)
            stacked = jax.make_array_from_single_device_arrays(shape, self._each, [piece])
            found = jax.jit(function, out_shardings=self._all)(stacked)
            return np.asarray(found.addressable_data(0))


def _same(stacked: Any) -> Any:
    return stacked


def _sum(stacked: Any) -> Any:
    return stacked.sum(axis=0)
