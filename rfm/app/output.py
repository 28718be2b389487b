"""Writes the files of a run directory, all of them or none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from rfm.app.record import RunRecord
from rfm.app.run_directory import RUN_FILES, replacing, write_bytes
from rfm.app.samples import Samples, sample

if TYPE_CHECKING:
    from rfm.app.pictures import Gallery


@dataclass(frozen=True)
class Results:
    """A run with what several of its files need, computed once."""

    record: RunRecord
    directory: Path
    names: Sequence[str] = RUN_FILES

    @cached_property
    def samples(self) -> Samples:
        """The field on the fitted mesh."""
        return sample(self.record)

    @cached_property
    def gallery(self) -> Gallery:
        """The pictures."""
        from rfm.app.pictures import Gallery

        return Gallery(self.record, self.samples)

    @cached_property
    def record_with_files(self) -> RunRecord:
        """The record, its summary naming the files."""
        from dataclasses import replace

        return replace(
            self.record, summary={**self.record.summary, "files": file_paths(self.directory, self.names)}
        )


def _summary(results: Results) -> bytes:
    from rfm.app.storage import summary_text

    return summary_text(results.record_with_files.summary).encode("utf-8")


def _solution(results: Results) -> bytes:
    from rfm.app.storage import solution_bytes

    return solution_bytes(results.record_with_files)


def _field(results: Results) -> bytes:
    from rfm.app.vtu import vtu_bytes

    return vtu_bytes(results.samples)


def _picture(results: Results) -> bytes:
    return results.gallery.solution


def _report(results: Results) -> bytes:
    from rfm.app.report import report_html

    return report_html(results.record, results.gallery)


WRITERS: dict[str, Callable[[Results], bytes]] = dict(
    zip(RUN_FILES, (_summary, _solution, _field, _picture, _report), strict=True)
)
"""What makes the content of each file."""


def file_paths(directory: str | Path, names: Sequence[str] = RUN_FILES) -> dict[str, str]:
    """Paths of the files of a run in `directory`, by their names without endings (``report``)."""
    return {Path(name).stem: str(Path(directory) / name) for name in names}


def contents(record: RunRecord, directory: str | Path, names: Sequence[str] = RUN_FILES) -> dict[str, bytes]:
    """Content of files of a run by name, for a `directory` that somebody else writes."""
    results = Results(record, Path(directory), names)
    return {name: WRITERS[name](results) for name in names}


def write_run(
    record: RunRecord, directory: str | Path, progress: Callable[[str], None] | None = None
) -> dict[str, str]:
    """Write the run directory and return its files.

    Parameters
    ----------
    progress
        Told the name of each file before it is made.

    Raises
    ------
    OutputError
        The directory cannot be written; a previous run in it is untouched.
    """
    results = Results(record, Path(directory))
    with replacing(directory) as partial:
        for name, content in WRITERS.items():
            if progress is not None:
                progress(name)
            write_bytes(partial / name, content(results))
    return file_paths(directory)
