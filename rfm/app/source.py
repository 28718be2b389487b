"""A case as plain data that remembers where each value was written.

:class:`Document` holds the data of a case file (or of a mapping handed over in Python), applies
overrides, and turns "this path is wrong" into a :class:`~rfm.errors.CaseError` with
``file:line:column`` and the line with a caret.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

from rfm.app.yaml_reader import MAX_CHARACTERS, Entry, Mark, Path, YamlError, read
from rfm.errors import CaseError

MAX_REPORTED = 20
"""Errors printed at once."""


class CombinedCaseError(CaseError):
    """Several errors of one case, reported together."""

    def __init__(self, errors: Sequence[CaseError]) -> None:
        first = errors[0]
        super().__init__(first.message, path=first.path, place=first.place, excerpt=first.excerpt)
        self.errors = tuple(errors)

    def __str__(self) -> str:
        shown = [str(error) for error in self.errors[:MAX_REPORTED]]
        if len(self.errors) > MAX_REPORTED:
            shown.append(f"... and {len(self.errors) - MAX_REPORTED} more errors")
        return "\n".join(shown)


def raise_all(errors: Sequence[CaseError]) -> None:
    """Raise the errors in the order of their places, as one exception; nothing happens when there are none."""
    errors = sorted(errors, key=_order)
    if len(errors) == 1:
        raise errors[0]
    if errors:
        raise CombinedCaseError(errors)


def _order(error: CaseError) -> tuple[int, int]:
    line, column = error.place.split(":")[-2:] if error.place.count(":") >= 2 else ("0", "0")
    return (int(line), int(column)) if line.isdigit() and column.isdigit() else (0, 0)


def nearest(name: str, valid: Iterable[str], what: str = "valid keys") -> str:
    """Remedy for an unknown name: the nearest valid one, or the list of all."""
    names = list(valid)
    lower = {candidate.lower(): candidate for candidate in names}
    beginning = [candidate for candidate in names if candidate.lower().startswith(name.lower())]
    if name and len(beginning) == 1:
        return f"did you mean {beginning[0]!r}?"
    close = difflib.get_close_matches(name.lower(), list(lower), n=1, cutoff=0.6)
    if close:
        return f"did you mean {lower[close[0]]!r}?"
    return f"{what}: {', '.join(names)}" if names else f"there are no {what}"


def dotted(path: Path) -> str:
    """Path as the user writes it, e.g. ``boundary_conditions.0.on``."""
    return ".".join(str(part) for part in path)


def excerpt(line: str, column: int) -> str:
    """Return the line with a caret below its 1-based column; a very long line is cut around it."""
    line = "".join(c if c.isprintable() else " " for c in line.rstrip("\r\n"))
    first = max(0, column - 61)
    last = first + 120
    shown = ("..." if first else "") + line[first:last] + ("..." if last < len(line) else "")
    caret = column - 1 - first + (3 if first else 0)
    return f"    {shown}\n    {' ' * caret}^"


@dataclass(frozen=True)
class Override:
    """A value that replaced one of the file: its text, and the option of the command that gave it."""

    text: str
    option: str = "--set"


@dataclass
class Document:
    """Data of a case with the places where its values were written.

    Attributes
    ----------
    name
        File name as the user gave it; empty when the case is a mapping from Python.
    text
        Text of the file.
    data
        Plain data: mappings, lists, strings, numbers, booleans, None.
    entries
        Marks in `text`, by path.
    overrides
        Values that replaced those of the text, by path.
    """

    name: str
    text: str
    data: dict[str, Any]
    entries: dict[Path, Entry] = field(default_factory=dict)
    overrides: dict[Path, Override] = field(default_factory=dict)

    def error(self, path: Path, message: str, *, offset: int | None = None, key: bool = False) -> CaseError:
        """Error at a path.

        Parameters
        ----------
        path
            Keys and indices from the root; the nearest enclosing value that was written is shown.
        message
            What is wrong and the remedy.
        offset
            Character inside the text of the value (an expression) where the error is.
        key
            Point to the key instead of its value.
        """
        written, found = self._written(path)
        if found is None:
            return CaseError(message, path=dotted(path), place=self.name)
        if isinstance(found, Override):
            shown = excerpt(found.text, offset + 1) if offset is not None else ""
            place = f"{found.option} {dotted(written)}={found.text}"
            return CaseError(message, path=dotted(path), place=place, excerpt=shown)
        at_key = found.key is not None and (key or written != path)
        mark = found.key if at_key and found.key is not None else found.value
        line, column = mark.line, mark.column
        if offset is not None and not at_key:
            line, column = self._inside(mark, offset, str(self._value(path)))
        lines = self.text.splitlines()
        shown = excerpt(lines[line - 1], column) if line <= len(lines) else ""
        return CaseError(message, path=dotted(path), place=f"{self.name}:{line}:{column}", excerpt=shown)

    def _written(self, path: Path) -> tuple[Path, Entry | Override | None]:
        """Longest beginning of `path` that was written, with its marks or its override."""
        for length in range(len(path), -1, -1):
            start = path[:length]
            if start in self.overrides:
                return start, self.overrides[start]
            if start in self.entries:
                return start, self.entries[start]
        return (), None

    def _value(self, path: Path) -> Any:
        value: Any = self.data
        for part in path:
            value = value[part]
        return value

    def _inside(self, mark: Mark, offset: int, value: str) -> tuple[int, int]:
        """Line and column of character `offset` of a scalar whose YAML text may be folded or quoted.

        Folding changes white space only, so the characters that are not white space are matched in order.
        """
        position = mark.start
        if mark.style in ("|", ">"):
            position = self.text.find("\n", mark.start) + 1
        elif mark.style:
            position += 1
        for character in value[:offset]:
            if not character.isspace():
                position = self.text.find(character, position, mark.end) + 1
                if position == 0:  # an escape sequence: point to the beginning of the value
                    return mark.line, mark.column
        while (
            offset < len(value)
            and not value[offset].isspace()
            and self.text[position : position + 1].isspace()
        ):
            position += 1
        before = self.text[:position]
        return before.count("\n") + 1, position - before.rfind("\n")

    def override(self, key: str, value: Any, *, option: str = "--set", entry: Entry | None = None) -> None:
        """Replace the value at the dotted path `key`.

        Parameters
        ----------
        key, value
            Where, and the plain data that come there.
        option
            Option of the command that gave it.
        entry
            Where the value stands in the text, when it is from another place of the file.

        Raises
        ------
        CaseError
            The path leads through a value that is no mapping or beyond the end of a list.
        """
        place = self._marked(entry) or f"{option} {key}={value}"
        path = tuple(key.split("."))
        if not all(path):
            raise CaseError("expected key=value with a dotted key such as discretization.grid", place=place)
        parent: Any = self.data
        real: list[str | int] = []
        for i, part in enumerate(path):
            last = i == len(path) - 1
            if isinstance(parent, list):
                if not part.isdigit() or int(part) >= len(parent):
                    message = f"{part!r} is no index of the {len(parent)} entries (0 to {len(parent) - 1})"
                    raise CaseError(message, path=dotted(path[:i]), place=place)
                step: str | int = int(part)
            elif isinstance(parent, dict):
                step = part
                if not last and parent.get(step) is None:
                    parent[step] = {}
            else:
                raise CaseError("is a value, it has no keys", path=dotted(path[:i]), place=place)
            real.append(step)
            if last:
                parent[step] = value
            else:
                parent = parent[step]
        self._forget(tuple(real))
        if entry is None:
            self.overrides[tuple(real)] = Override(str(value), option)
        else:
            self.entries[tuple(real)] = entry

    def _marked(self, entry: Entry | None) -> str:
        mark = None if entry is None else entry.key or entry.value
        return "" if mark is None else f"{self.name}:{mark.line}:{mark.column}"

    def _forget(self, path: Path) -> None:
        self.entries = {known: entry for known, entry in self.entries.items() if known[: len(path)] != path}
        self.overrides = {known: one for known, one in self.overrides.items() if known[: len(path)] != path}


def parse_value(key: str, text: str, option: str = "--set") -> Any:
    """Value of an override given as text on the command line."""
    try:
        return read(text)[0]
    except YamlError as error:
        place = f"{option} {key}={text}"
        raise CaseError(error.message, place=place, excerpt=excerpt(text, error.column)) from error


def from_text(text: str, name: str) -> Document:
    """Document of a YAML text; `name` stands for the file in messages.

    Raises
    ------
    CaseError
        The text is not YAML, or not a mapping.
    """
    try:
        data, entries = read(text)
    except YamlError as error:
        lines = text.splitlines()
        shown = excerpt(lines[error.line - 1], error.column) if error.line <= len(lines) else ""
        raise CaseError(error.message, place=f"{name}:{error.line}:{error.column}", excerpt=shown) from error
    if not isinstance(data, dict):
        found = "nothing" if data is None else f"a {type(data).__name__}"
        message = f"a case file is a mapping that begins with 'rfm: 1', found {found}"
        raise CaseError(message, place=f"{name}:1:1")
    return Document(name, text, data, entries)


def from_file(path: str | FilePath) -> Document:
    """Document of a case file.

    Raises
    ------
    CaseError
        The file cannot be read, is no text, or is not a YAML mapping.
    """
    file, name = FilePath(path), str(path)
    try:
        if file.is_dir():
            raise CaseError("is a directory, expected a case file", place=name)
        if file.stat().st_size > 4 * MAX_CHARACTERS:
            raise CaseError(f"is too large for a case file (limit {MAX_CHARACTERS} characters)", place=name)
        text = file.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise CaseError(f"there is no such file{_similar_files(file)}", place=name) from None
    except UnicodeDecodeError as error:
        message = f"is not a text file in UTF-8 (byte {error.start}); a case file is YAML"
        raise CaseError(message, place=name) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise CaseError(f"cannot be read: {reason}", place=name) from error
    return from_text(text, name)


def from_mapping(data: Mapping[str, Any]) -> Document:
    """Document of a mapping handed over in Python."""
    return Document("", "", _plain(data))


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value


def _similar_files(file: FilePath) -> str:
    folder = file.parent
    if not folder.is_dir():
        return f" (nor a folder {folder})"
    names = [other.name for other in folder.glob("*.y*ml")]
    close = difflib.get_close_matches(file.name, names, n=1)
    return f"; did you mean {folder / close[0]}?" if close else ""
