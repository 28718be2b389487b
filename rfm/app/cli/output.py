"""Text for humans: on standard output, or on standard error when standard output is for JSON."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from itertools import zip_longest
from typing import Any, TextIO

WIDTH, NARROWEST = 120, 12
"""Columns of a line that goes to no terminal, and of a cell that is not made narrower."""


def stream(as_json: bool) -> TextIO:
    """Stream for human text."""
    return sys.stderr if as_json else sys.stdout


def say(text: str, as_json: bool) -> None:
    """Print a line for a human."""
    print(text, file=stream(as_json))


def table(columns: Sequence[str], rows: Iterable[Sequence[Any]], as_json: bool, title: str = "") -> None:
    """Print a table; numbers are right-aligned, long texts go on in the next line."""
    content = [[shown(value) for value in row] for row in rows]
    right = [bool(content) and all(_is_number(row[i]) for row in content) for i in range(len(columns))]
    output = stream(as_json)
    width = shutil.get_terminal_size().columns if output.isatty() else WIDTH
    widths = _fitted([max(map(len, column)) for column in zip(columns, *content, strict=True)], width)
    rule = ("─" if "utf" in (output.encoding or "").lower() else "-") * (sum(widths) + 2 * len(widths))
    lines = [title] if title else []
    for number, row in enumerate((columns, *content)):
        cells = [textwrap.wrap(text, size) or [""] for text, size in zip(row, widths, strict=True)]
        for parts in zip_longest(*cells, fillvalue=""):
            line = "  ".join(
                part.rjust(size) if flush else part.ljust(size)
                for part, size, flush in zip(parts, widths, right, strict=True)
            )
            lines.append(f" {line}".rstrip())
        lines += [rule] if number == 0 else []
    print("\n".join(["", *lines, ""]), file=output)


def _fitted(widths: list[int], total: int) -> list[int]:
    """Widths of columns that fit into a line, the widest made narrower."""
    while sum(widths) + 2 * len(widths) > total and max(widths) > NARROWEST:
        widest = widths.index(max(widths))
        widths[widest] -= 1
    return widths


def shown(value: Any) -> str:
    """Return a value as a table shows it."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {shown(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(shown(item) for item in value)
    return str(value)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return text == "-"
    return True
