"""Overrides from the command line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rfm.app.case import Case, load_case
from rfm.app.source import parse_value
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


def load(file: Path, settings: Sequence[str]) -> Case:
    """Case of a file with the overrides of the command line."""
    return load_case(file, parse_settings(settings))
