"""Processes find each other before they compute, so that who is missing is said and not waited for.

JAX ends a process whose partners do not come.  So process 0 first waits at the same address itself: each of the others
calls with the number of processes and its own, and is told to go on when all have called, or why not.
"""

from __future__ import annotations

import json
import socket
import time
from contextlib import ExitStack
from typing import Any

from rfm.errors import RfmError

GO = "go"
PAUSE = 0.05
"""Seconds between two attempts to reach process 0."""


def address_of(text: str) -> tuple[str, int]:
    """Host and port of ``HOST:PORT``.

    Raises
    ------
    RfmError
        It is something else.
    """
    host, _, port = text.rpartition(":")
    if not host or not port.isdigit() or not 0 < int(port) < 65536:
        raise RfmError(f"--coordinator must be HOST:PORT, the same for all processes, got {text!r}")
    return host.strip("[]"), int(port)


def meet(address: str, count: int, index: int, patience: float) -> None:
    """Wait until all processes are there.

    Parameters
    ----------
    address
        ``HOST:PORT`` of process 0.
    count, index
        Number of processes, and of this one.
    patience
        Seconds to wait.

    Raises
    ------
    RfmError
        Somebody is missing or has another idea of who there should be, or the address cannot be used.
    """
    if not 0 <= index < count:
        raise RfmError(f"--process must be from 0 to {count - 1} with --processes {count}, got {index}")
    where, until = address_of(address), time.monotonic() + patience
    if index == 0:
        _receive(where, address, count, until, patience)
    else:
        _call(where, address, count, index, until, patience)


def _receive(where: tuple[str, int], address: str, count: int, until: float, patience: float) -> None:
    """Wait for the calls of all other processes and answer them."""
    with ExitStack() as stack:
        try:
            family = socket.getaddrinfo(*where)[0][0]
            server = stack.enter_context(socket.create_server(where, family=family, backlog=count))
        except OSError as error:
            raise RfmError(
                f"process 0 cannot listen at --coordinator {address} ({error.strerror or error}): give an address of "
                "its own machine and a free port"
            ) from error
        callers: dict[int, socket.socket] = {}
        while len(callers) < count - 1:
            server.settimeout(max(until - time.monotonic(), 0.001))
            try:
                caller, _ = server.accept()
                stack.enter_context(caller)
                caller.settimeout(max(until - time.monotonic(), 0.001))
                number, total = _heard(caller)
            except TimeoutError:
                missing = ", ".join(str(k) for k in range(1, count) if k not in callers)
                _tell(callers, f"process 0 gave up waiting for process {missing}")
                raise RfmError(
                    f"no call from process {missing} at {address} in {patience:g} s: start all {count} processes, and "
                    "see that they can reach this machine"
                ) from None
            except (OSError, ValueError):  # somebody else, or a process that ended
                continue
            why = None
            if total != count:
                why = f"process 0 was started with --processes {count}, process {number} with {total}"
            elif number in callers:
                why = f"two processes were started with --process {number}"
            if why is not None:
                _tell({**callers, -1: caller}, why)
                raise RfmError(f"{why}: all need the same number of processes and each a number of its own")
            callers[number] = caller
        _tell(callers, GO)
        for caller in callers.values():  # the caller closes first, so that the port is free at once
            caller.settimeout(1.0)
            try:
                caller.recv(1)
            except OSError:
                continue


def _call(
    where: tuple[str, int], address: str, count: int, index: int, until: float, patience: float
) -> None:
    """Call process 0 and wait for its answer."""
    while True:
        left = until - time.monotonic()
        if left <= 0:
            raise RfmError(
                f"process 0 does not answer at --coordinator {address} in {patience:g} s: start it there, and see that "
                "no firewall is between"
            )
        try:
            with socket.create_connection(where, timeout=left) as line:
                line.sendall(json.dumps([index, count]).encode() + b"\n")
                line.settimeout(max(left, 1.0) + 1.0)
                answer = line.makefile().readline().strip()
        except OSError:
            time.sleep(PAUSE)
            continue
        if answer == GO:
            return
        if answer:
            raise RfmError(answer)


def _heard(caller: Any) -> tuple[int, int]:
    number, total = json.loads(caller.makefile().readline())
    return int(number), int(total)


def _tell(callers: dict[int, socket.socket], text: str) -> None:
    for caller in callers.values():
        try:
            caller.sendall(text.encode() + b"\n")
        except OSError:
            continue
