"""Wall time of the named phases of one solve."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


class Stopwatch:
    """Adds up wall seconds per phase, and tells a listener when a phase begins.

    Parameters
    ----------
    listener
        Called with the name of a phase as it begins (a progress display), or None.
    """

    def __init__(self, listener: Listener | None = None) -> None:
        self.seconds: dict[str, float] = {}
        self._listener = listener

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time the body of the ``with`` statement as (part of) phase `name`."""
        if self._listener is not None:
            self._listener.phase(name)
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start

    def advance(self, done: int, total: int) -> None:
        """Tell the listener that `done` of `total` cells of the running phase are finished."""
        if self._listener is not None:
            self._listener.advance(done, total)


class Listener:
    """What a progress display implements; this one stays silent."""

    def phase(self, name: str) -> None:
        """Phase `name` begins."""

    def advance(self, done: int, total: int) -> None:
        """`done` of `total` cells of the phase are finished."""
