"""Text for humans: on standard output, or on standard error when standard output is for JSON."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TextIO


def stream(as_json: bool) -> TextIO:
    """Stream for human text."""
    return sys.stderr if as_json else sys.stdout


def say(text: str, as_json: bool) -> None:
    """Print a line for a human."""
    print(text, file=stream(as_json))


def table(columns: Sequence[str], rows: Iterable[Sequence[Any]], as_json: bool, title: str = "") -> None:
    """Print a table; numbers are right-aligned."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    drawn = Table(title=title or None, box=box.SIMPLE_HEAD, title_justify="left")
    content = [[shown(value) for value in row] for row in rows]
    numeric = [bool(content) and all(_is_number(row[i]) for row in content) for i in range(len(columns))]
    for name, right in zip(columns, numeric, strict=True):
        drawn.add_column(name, justify="right" if right else "left", overflow="fold")
    for row in content:
        drawn.add_row(*row)
    output = stream(as_json)
    width = None if output.isatty() else 120
    Console(file=output, width=width, markup=False, highlight=False, emoji=False).print(drawn)


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
