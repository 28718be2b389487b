"""Overrides from the command line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rfm.app.case import Case, load_case
from rfm.app.source import Document, from_file, parse_value
from rfm.errors import CaseError


def parse_settings(settings: Sequence[str]) -> dict[str, Any]:
    """Values of ``key=value`` options, the values read as YAML.

    Raises
    ------
    CaseError
        An option has no ``=``, or its value is not YAML.
    """
    values: dict[str, Any] = {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals:
            raise CaseError("expected key=value, e.g. --set discretization.grid=64", place=f"--set {setting}")
        values[key.strip()] = parse_value(key.strip(), text)
    return values


def parse_variations(settings: Sequence[str]) -> dict[str, list[Any]]:
    """Values by key of ``key=value,value,...`` options, read as a YAML list.

    Raises
    ------
    CaseError
        An option has no ``=``, no value, or its values are not YAML.
    """
    found: dict[str, list[Any]] = {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        place = f"--vary {setting}"
        if not equals or not text.strip():
            raise CaseError("expected key=value,value,... e.g. --vary parameters.R=0.3,0.4", place=place)
        values = parse_value(key.strip(), f"[{text}]", "--vary")
        twice = next((value for value, count in Counter(map(repr, values)).items() if count > 1), None)
        if twice is not None:
            raise CaseError(f"holds {twice} twice", place=place)
        if key.partition(".")[0].strip() in ("rfm", "study"):
            raise CaseError(f"a study cannot vary {key.strip()!r}; vary a key of the problem", place=place)
        found[key.strip()] = values
    return found


def document(file: Path, settings: Sequence[str]) -> Document:
    """Case of a file as plain data, with the overrides of the command line."""
    found = from_file(file)
    for key, value in parse_settings(settings).items():
        found.override(key, value)
    return found


def load(file: Path, settings: Sequence[str]) -> Case:
    """Case of a file with the overrides of the command line."""
    return load_case(file, parse_settings(settings))
