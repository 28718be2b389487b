"""Progress on a terminal, silence elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from solvers.stopwatch import Listener

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


class Bar(Listener):
    """Shows the running phase with a bar."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._task: TaskID = progress.add_task("starting", total=None)

    def phase(self, name: str) -> None:
        """Begin a bar for the phase."""
        self._progress.reset(self._task, description=name, total=None)

    def advance(self, done: int, total: int) -> None:
        """Move the bar."""
        self._progress.update(self._task, completed=done, total=max(total, 1))


@contextmanager
def listening() -> Iterator[Listener]:
    """Listener that draws a bar on standard error when that is a terminal."""
    if not sys.stderr.isatty():
        yield Listener()
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description:>12}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        yield Bar(progress)
