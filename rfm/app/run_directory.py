"""A run directory is replaced as a whole or not at all.

Everything is written into a hidden sibling directory, flushed to the disk, and then the two are
exchanged by one system call (``renameat2`` with ``RENAME_EXCHANGE`` on Linux, two renames with a way
back elsewhere).  An interruption, a full disk or a crash before that moment leaves the previous run as
it was.  Files that a user put beside the results are carried over.
"""

from __future__ import annotations

import errno
import hashlib
import os
import platform
import shutil
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rfm.errors import RfmError

RUN_FILES = ("summary.json", "solution.h5", "field.vtu", "picture.png", "report.html")
"""The files of a run directory; what else is in there belongs to the user."""

STUDY_FILE = "study.json"
"""By this file a directory is known as that of a study; its runs are in a directory of their own."""

REASONS = {
    errno.ENOSPC: "no space left on the disk",
    errno.EDQUOT: "the disk quota is exhausted",
    errno.EACCES: "permission denied",
    errno.EPERM: "permission denied",
    errno.EROFS: "the file system is read-only",
    errno.EFBIG: "the file system does not take files of this size",
    errno.EIO: "the disk reports an input/output error",
    errno.EBUSY: "it is in use (a mount point?)",
    errno.ENAMETOOLONG: "its name is too long",
    errno.ENOTDIR: "a part of its path is a file",
    errno.ELOOP: "its path is a loop of symbolic links",
}

_AT_FDCWD, _RENAME_EXCHANGE = -100, 2


class OutputError(RfmError):
    """The run directory cannot be written; the previous run in it is untouched."""


def check_output(directory: str | Path) -> Path:
    """Resolve `directory` and refuse it, writing nothing, where a run could not be put.

    Raises
    ------
    OutputError
        It is a file, holds something that is not a run, or is not writable.
    """
    try:
        target = Path(os.path.realpath(directory, strict=False))
        exists = os.path.lexists(target)
    except OSError as error:
        raise _refused(directory, error) from error
    if exists and not target.is_dir():
        raise OutputError(f"{directory} is a file, not a directory: choose another place with --out")
    if exists and _holds_something_else(target):
        raise OutputError(
            f"{directory} holds files that are not of a run (no {RUN_FILES[0]}): "
            "choose a new or empty directory with --out"
        )
    ancestor = target.parent
    while not ancestor.exists() and ancestor != ancestor.parent:
        ancestor = ancestor.parent
    if not ancestor.is_dir():
        raise OutputError(f"cannot write {directory}: {ancestor} is a file: choose another place with --out")
    if not os.access(ancestor, os.W_OK | os.X_OK):
        raise OutputError(f"cannot write {directory}: no permission to write in {ancestor}: use --out")
    return target


@contextmanager
def replacing(directory: str | Path) -> Iterator[Path]:
    """Give an empty directory to write a run into; it becomes `directory` when the body succeeds.

    When the body raises anything, :class:`KeyboardInterrupt` included, nothing of it remains and the
    previous run stays.

    Raises
    ------
    OutputError
        The directory cannot be written: not permitted, disk full, not a run directory.
    """
    target = check_output(directory)
    partial: Path | None = None
    complete = False
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        _sweep(target)
        partial = target.parent / f".{target.name}.{_host_tag()}-{os.getpid()}-{uuid.uuid4().hex[:8]}.partial"
        partial.mkdir()
        yield partial
        _flush(partial)
        complete = True
        _put_in_place(partial, target)
    except OSError as error:
        if error.errno not in REASONS:
            raise
        raise _refused(directory, error) from error
    finally:
        if partial is not None and complete:
            discard(partial)  # it may be the previous run by now, with the user's own files in it
        elif partial is not None:
            shutil.rmtree(partial, ignore_errors=True)


def write_bytes(path: Path, content: bytes) -> None:
    """Write `content` to the new file `path` (all of it, or an :class:`OSError` is raised)."""
    with path.open("xb") as stream:
        stream.write(content)


def _refused(directory: str | Path, error: OSError) -> OutputError:
    reason = REASONS.get(error.errno or 0, error.strerror or str(error))
    return OutputError(
        f"cannot write {directory}: {reason}: make room or choose another place with --out; "
        "the previous run there is untouched"
    )


def _holds_something_else(directory: Path) -> bool:
    try:
        names = {entry.name for entry in directory.iterdir()}
    except OSError as error:
        raise _refused(directory, error) from error
    return bool(names) and names.isdisjoint((*RUN_FILES, STUDY_FILE))


def _put_in_place(partial: Path, target: Path) -> None:
    """Make `partial` the `target`; the former target, less the user's own files, becomes `partial`."""
    if not target.exists():
        partial.rename(target)
        return
    shutil.copymode(target, partial)
    if not _exchange(partial, target):
        _exchange_in_two_steps(partial, target)
    for entry in partial.iterdir():
        if entry.name not in RUN_FILES:
            entry.rename(target / entry.name)


def _exchange(first: Path, second: Path) -> bool:
    """Exchange two directories in one step; False where the system has no such call."""
    if platform.system() != "Linux":
        return False
    import ctypes

    library = ctypes.CDLL(None, use_errno=True)
    call = getattr(library, "renameat2", None)
    if call is None:
        return False
    names = os.fsencode(first), os.fsencode(second)
    return bool(call(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _RENAME_EXCHANGE) == 0)


def _exchange_in_two_steps(partial: Path, target: Path) -> None:
    aside = partial.with_suffix(".old")
    try:
        target.rename(aside)
        partial.rename(target)
        aside.rename(partial)
    except BaseException:
        if not target.exists() and aside.exists():
            aside.rename(target)
        raise


def _flush(directory: Path) -> None:
    """Force the files to the disk: some file systems tell only now that they are full."""
    for path in directory.iterdir():
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _host_tag() -> str:
    return hashlib.sha256(platform.node().encode()).hexdigest()[:8]


def _sweep(target: Path) -> None:
    """Remove what killed processes of this computer left beside `target`."""
    for leftover in target.parent.glob(f".{target.name}.{_host_tag()}-*-*.partial"):
        process = leftover.name.split("-")[-2]
        if process.isdigit() and not _alive(int(process)):
            discard(leftover)


def discard(directory: Path) -> None:
    """Remove the files of a run, and the directory when nothing else is in it."""
    with suppress(OSError):
        for name in RUN_FILES:
            (directory / name).unlink(missing_ok=True)
        directory.rmdir()


def _alive(process: int) -> bool:
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
