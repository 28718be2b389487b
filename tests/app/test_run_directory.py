"""A run directory is replaced as a whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from rfm.app import run_directory
from rfm.app.run_directory import OutputError, check_output, replacing


def write(directory: Path, content: str) -> None:
    with replacing(directory) as partial:
        (partial / "summary.json").write_text(content)


def names(directory: Path) -> list[str]:
    return sorted(entry.name for entry in directory.iterdir())


@pytest.mark.parametrize("exchange", [True, False], ids=["exchange", "two steps"])
def test_the_new_run_replaces_the_old(tmp_path, monkeypatch, exchange):
    if not exchange:
        monkeypatch.setattr(run_directory, "_exchange", lambda first, second: False)
    target = tmp_path / "deep" / "run"
    write(target, "first")
    (target / "report.html").write_text("stale")
    (target / "notes.txt").write_text("mine")
    write(target, "second")
    assert (target / "summary.json").read_text() == "second"
    assert (target / "notes.txt").read_text() == "mine"
    assert names(target) == ["notes.txt", "summary.json"]
    assert names(target.parent) == ["run"]


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, MemoryError, ValueError])
def test_an_interruption_leaves_the_previous_run(tmp_path, interruption):
    target = tmp_path / "run"
    write(target, "first")

    def broken():
        with replacing(target) as partial:
            (partial / "summary.json").write_text("half")
            raise interruption

    with pytest.raises(interruption):
        broken()
    assert (target / "summary.json").read_text() == "first"
    assert names(tmp_path) == ["run"]


def test_an_interruption_of_the_first_run_leaves_nothing(tmp_path):
    with pytest.raises(KeyboardInterrupt), replacing(tmp_path / "run"):
        raise KeyboardInterrupt
    assert names(tmp_path) == []


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EROFS])
def test_a_full_disk_is_told_and_leaves_the_previous_run(tmp_path, monkeypatch, code):
    target = tmp_path / "run"
    write(target, "first")

    def full(descriptor):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(run_directory.os, "fsync", full)
    with pytest.raises(OutputError, match=run_directory.REASONS[code]) as caught:
        write(target, "second")
    assert caught.value.exit_code == 2
    assert (target / "summary.json").read_text() == "first"
    assert names(tmp_path) == ["run"]


def test_an_interruption_between_the_two_renames_goes_back(tmp_path, monkeypatch):
    target = tmp_path / "run"
    write(target, "first")
    monkeypatch.setattr(run_directory, "_exchange", lambda first, second: False)
    rename = Path.rename

    def interrupted(self, other):
        if self.name.endswith(".partial"):
            raise KeyboardInterrupt
        return rename(self, other)

    monkeypatch.setattr(Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write(target, "second")
    assert (target / "summary.json").read_text() == "first"
    assert names(tmp_path) == ["run"]


def test_other_errors_are_not_disguised(tmp_path):
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "run"):
        (tmp_path / "absent").read_text()


def test_a_directory_of_somebody_else_is_refused(tmp_path):
    (tmp_path / "thesis.tex").write_text("precious")
    with pytest.raises(OutputError, match="not of a run"):
        check_output(tmp_path)
    with pytest.raises(OutputError), replacing(tmp_path):
        pass
    assert names(tmp_path) == ["thesis.tex"]


def test_a_file_is_refused(tmp_path):
    (tmp_path / "run").write_text("")
    with pytest.raises(OutputError, match="is a file"):
        check_output(tmp_path / "run")
    with pytest.raises(OutputError, match="is a file"):
        check_output(tmp_path / "run" / "below")


def test_a_place_that_is_not_writable_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(run_directory.os, "access", lambda path, mode: False)
    with pytest.raises(OutputError, match="no permission"):
        check_output(tmp_path / "run")


def test_a_link_to_a_run_stays_a_link(tmp_path):
    write(tmp_path / "real", "first")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    write(tmp_path / "link", "second")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real" / "summary.json").read_text() == "second"


def test_leftovers_of_killed_runs_are_swept(tmp_path, monkeypatch):
    dead = tmp_path / f".run.{run_directory._host_tag()}-99999999-abcdef01.partial"
    kept = tmp_path / f".run.{run_directory._host_tag()}-{os.getpid()}-abcdef01.partial"
    for directory in (dead, kept):
        directory.mkdir()
        (directory / "summary.json").write_text("half")
    write(tmp_path / "run", "first")
    assert names(tmp_path) == [kept.name, "run"]
