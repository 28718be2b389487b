"""A YAML text as plain data together with the position of every key and value.

The text is read as a stream of events and never turned into anything but mappings, lists, strings,
numbers, booleans and null (the core schema of YAML 1.2), so no tag can construct an object.  Size,
depth and the number of values after the expansion of aliases are bounded; recursion, repeated keys,
tags and merge keys are refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

MAX_CHARACTERS = 400_000
MAX_DEPTH = 40
MAX_VALUES = 100_000
"""Values after aliases are expanded: an alias bomb is refused when it passes this count."""

Path: TypeAlias = tuple[str | int, ...]
"""Keys and list indices from the root to a value."""

_NULL = frozenset({"", "~", "null", "Null", "NULL"})
_BOOLEAN = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INTEGER = re.compile(r"[-+]?[0-9]{1,300}")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_SPECIAL = {".inf": "inf", "+.inf": "inf", "-.inf": "-inf", ".nan": "nan"}


@dataclass(frozen=True)
class Mark:
    """Where a value stands: 1-based line and column, offsets in the text, and whether it is quoted."""

    line: int
    column: int
    start: int
    end: int
    style: str = ""


@dataclass(frozen=True)
class Entry:
    """Marks of the value at a path, and of its key where it has one."""

    value: Mark
    key: Mark | None = None


class YamlError(Exception):
    """The text is not YAML, or uses what a case file may not."""

    def __init__(self, message: str, line: int, column: int) -> None:
        super().__init__(message)
        self.message, self.line, self.column = message, line, column


@dataclass(frozen=True)
class _Node:
    """A scalar (content: a plain value), a list of nodes or a mapping (list of key mark, key, node)."""

    kind: str
    content: Any
    mark: Mark


def read(text: str) -> tuple[Any, dict[Path, Entry]]:
    """Plain data of a YAML text and the marks of every path in it.

    Raises
    ------
    YamlError
        With the position, when the text is not one acceptable YAML document.
    """
    if len(text) > MAX_CHARACTERS:
        raise YamlError(f"longer than {MAX_CHARACTERS} characters", 1, 1)
    root = _compose(text)
    if root is None:
        return None, {}
    entries: dict[Path, Entry] = {}
    return _expand(root, (), None, entries), entries


def _compose(text: str) -> _Node | None:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    events = YAML(typ="safe", pure=True).parse(text)
    try:
        return _Composer(events).document()
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        context = f" ({error.context})" if error.context else ""
        raise YamlError(f"not valid YAML: {error.problem}{context}", line, column) from error
    except YAMLError as error:  # e.g. a control character: the reader gives an offset only
        offset = int(getattr(error, "position", 0))
        line, column = _position(text, offset)
        reason = getattr(error, "reason", "unreadable text")
        raise YamlError(f"not valid YAML: {reason}", line, column) from error


def _position(text: str, offset: int) -> tuple[int, int]:
    before = text[:offset]
    return before.count("\n") + 1, offset - (before.rfind("\n") + 1) + 1


class _Composer:
    """Builds nodes from parser events; an alias refers to the node of its anchor."""

    def __init__(self, events: Iterator[Any]) -> None:
        self._events = events
        self._anchors: dict[str, _Node | None] = {}

    def document(self) -> _Node | None:
        """Node of the only document, None when there is none."""
        root, documents = None, 0
        for event in self._events:
            name = type(event).__name__
            if name == "DocumentStartEvent":
                documents += 1
                if documents > 1:
                    raise _refuse(event, "a case file holds one document, a second one begins here")
            elif name not in ("StreamStartEvent", "StreamEndEvent", "DocumentEndEvent"):
                root = self._node(event, 1)
        return root

    def _node(self, event: Any, depth: int) -> _Node:
        name = type(event).__name__
        if name == "AliasEvent":
            return self._alias(event)
        if depth > MAX_DEPTH:
            raise _refuse(event, f"nested deeper than {MAX_DEPTH} levels")
        if getattr(event, "tag", None) not in (None, "!"):
            raise _refuse(event, f"tags are not allowed in a case file (found {event.tag})")
        anchor = getattr(event, "anchor", None)
        if anchor is not None:
            self._anchors[anchor] = None  # open: an alias to it from within is a recursion
        if name == "ScalarEvent":
            node = _Node("scalar", _scalar(event), _mark(event))
        elif name == "SequenceStartEvent":
            node = self._sequence(event, depth)
        else:
            node = self._mapping(event, depth)
        if anchor is not None:
            self._anchors[anchor] = node
        return node

    def _alias(self, event: Any) -> _Node:
        if event.anchor not in self._anchors:
            raise _refuse(event, f"alias *{event.anchor} has no anchor &{event.anchor} before it")
        node = self._anchors[event.anchor]
        if node is None:
            raise _refuse(event, f"alias *{event.anchor} refers to a value that contains it")
        return node

    def _sequence(self, start: Any, depth: int) -> _Node:
        items = []
        for event in self._events:
            if type(event).__name__ == "SequenceEndEvent":
                break
            items.append(self._node(event, depth + 1))
        return _Node("sequence", items, _mark(start))

    def _mapping(self, start: Any, depth: int) -> _Node:
        items: list[tuple[Mark, str, _Node]] = []
        seen: dict[str, int] = {}
        for event in self._events:
            if type(event).__name__ == "MappingEndEvent":
                break
            if type(event).__name__ != "ScalarEvent":
                raise _refuse(event, "a key must be a plain name")
            key, mark = event.value, _mark(event)
            if key == "<<":
                raise _refuse(event, "merge keys (<<) are not supported: repeat the keys")
            if key in seen:
                raise _refuse(event, f"key {key!r} is given twice (first on line {seen[key]})")
            seen[key] = mark.line
            items.append((mark, key, self._node(next(self._events), depth + 1)))
        return _Node("mapping", items, _mark(start))


def _mark(event: Any) -> Mark:
    start, end = event.start_mark, event.end_mark
    style = getattr(event, "style", None) or ""
    return Mark(start.line + 1, start.column + 1, start.index, end.index, style)


def _refuse(event: Any, message: str) -> YamlError:
    return YamlError(message, event.start_mark.line + 1, event.start_mark.column + 1)


def _scalar(event: Any) -> str | int | float | bool | None:
    """Value of a scalar by the core schema: only plain scalars can be anything but a string."""
    text = str(event.value)
    if event.style:
        return text
    if text in _NULL:
        return None
    if text in _BOOLEAN:
        return _BOOLEAN[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _FLOAT.fullmatch(text):
        return float(text)
    return float(_SPECIAL[text.lower()]) if text.lower() in _SPECIAL else text


def _expand(node: _Node, path: Path, key: Mark | None, entries: dict[Path, Entry]) -> Any:
    """Plain data of a node; aliases are expanded, so the number of entries bounds the size."""
    if len(entries) >= MAX_VALUES:
        message = f"more than {MAX_VALUES} values once aliases are expanded"
        raise YamlError(message, node.mark.line, node.mark.column)
    if len(path) > MAX_DEPTH:
        raise YamlError(f"nested deeper than {MAX_DEPTH} levels", node.mark.line, node.mark.column)
    entries[path] = Entry(node.mark, key)
    if node.kind == "scalar":
        return node.content
    if node.kind == "sequence":
        return [_expand(item, (*path, i), None, entries) for i, item in enumerate(node.content)]
    return {name: _expand(item, (*path, name), mark, entries) for mark, name, item in node.content}
