"""Processes that solve one problem together."""

from __future__ import annotations

from typing import Any, Protocol

from rfm.calculus.types import Array


class Team(Protocol):
    """What processes tell each other outside of compiled programs; each calls the same, in the same order."""

    @property
    def index(self) -> int:
        """Number of this process."""
        ...

    @property
    def count(self) -> int:
        """Number of processes."""
        ...

    def gather(self, value: Any) -> list[Any]:
        """Value of every process, by its number."""
        ...

    def total(self, array: Array) -> Array:
        """Sum of an array over the processes."""
        ...


class Alone:
    """One process."""

    index = 0
    count = 1

    def gather(self, value: Any) -> list[Any]:
        """See :class:`Team`."""
        return [value]

    def total(self, array: Array) -> Array:
        """See :class:`Team`."""
        return array
