"""Which runs a study has: every combination of the values that vary."""

from __future__ import annotations

import copy
import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

from rfm import __version__
from rfm.app.case import Case, case_from_document
from rfm.app.schema.discretization import DEFAULT_GRID
from rfm.app.source import Document, nearest, raise_all
from rfm.app.study.task import Task
from rfm.app.yaml_reader import Path
from rfm.errors import CaseError

DEGREE, GRID = "discretization.degree", "discretization.grid"

SIZES = {GRID: "discretization.spacing", "discretization.spacing": GRID}
"""Keys that exclude each other: where one varies, the other is taken away."""

MOST = 20_000
"""Runs of a study."""

LONGEST = 24
"""Characters of a value in the name of a run."""


@dataclass(frozen=True)
class Axis:
    """A key that varies.

    Attributes
    ----------
    key, values
        Dotted key and its values.
    path
        Where the values stand in the case file; None when they are from the command line.
    """

    key: str
    values: tuple[Any, ...]
    path: Path | None = None


@dataclass(frozen=True)
class Plan:
    """The runs of a study, in their order.

    Attributes
    ----------
    case
        The case without its variations, validated.
    axes
        What varies: keys of the case, then degrees, then grids.
    tasks
        The runs, those of the last axis next to each other.
    """

    case: Case
    axes: tuple[Axis, ...]
    tasks: tuple[Task, ...]

    def labels(self) -> dict[str, str]:
        """Short name of each key that varies."""
        return labels([axis.key for axis in self.axes])


def make_plan(document: Document, given: Mapping[str, Sequence[Any]] | None = None) -> Plan:
    """Plan the study of a case.

    Parameters
    ----------
    document
        The case; its section ``study`` says what varies.
    given
        Values by key from the command line; they replace those of the case.

    Raises
    ------
    CaseError
        The case is wrong, has nothing to vary, or is wrong for some of the values.
    """
    case = case_from_document(document, {})
    axes = _axes(case, {key: tuple(values) for key, values in (given or {}).items()})
    if not axes:
        message = (
            "the case has no study; add e.g. study: {grid: [8, 16, 32], degree: [2, 3]}, "
            "or vary a key: rfm study CASE --vary discretization.grid=8,16,32"
        )
        raise case.error((), message)
    count = math.prod(len(axis.values) for axis in axes)
    if count > MOST:
        raise case.error(("study",), f"has {count} runs, at most {MOST} are allowed: divide it", key=True)
    names = labels([axis.key for axis in axes])
    tasks: list[Task] = []
    errors: dict[str, CaseError] = {}
    for chosen in product(*(range(len(axis.values)) for axis in axes)):
        own = _varied(document, axes, chosen)
        settings = {axis.key: axis.values[i] for axis, i in zip(axes, chosen, strict=True)}
        try:
            run = case_from_document(own, {})
        except CaseError as error:
            errors |= {str(one): one for one in getattr(error, "errors", (error,))}
            continue
        size = run.discretization
        grid = size.grid or (DEFAULT_GRID if size.spacing is None else None)
        tasks.append(Task(_name(settings, names), settings, own, size.degree, grid, digest_of(run)))
    raise_all(list(errors.values()))
    return Plan(case, axes, _distinct(tasks))


def _axes(case: Case, given: Mapping[str, tuple[Any, ...]]) -> tuple[Axis, ...]:
    study = case.study
    found: dict[str, Axis] = {}
    for key, values in ((study and study.vary) or {}).items():
        found[key] = Axis(key, values, ("study", "vary", key))
    for key, values in given.items():
        found[key] = Axis(key, values)
    for key, name in ((DEGREE, "degree"), (GRID, "grid")):
        listed = getattr(study, name, None)
        if key in found:
            found[key] = found.pop(key)  # behind the others, so that grids lie next to each other
        elif listed:
            found[key] = Axis(key, listed, ("study", name))
    return tuple(found.values())


def _varied(document: Document, axes: Sequence[Axis], chosen: Sequence[int]) -> Document:
    """Return the case with one value of each axis, and without its study."""
    own = replace(
        document,
        data=copy.deepcopy({key: value for key, value in document.data.items() if key != "study"}),
        entries=dict(document.entries),
        overrides=dict(document.overrides),
    )
    for axis, i in zip(axes, chosen, strict=True):
        entry = None if axis.path is None else document.entries.get((*axis.path, i))
        if entry is not None and axis.path is not None:
            key = document.entries.get(axis.path)
            entry = replace(entry, key=key.key if key is not None else None)
        _require_place(document, own, axis)
        own.override(axis.key, copy.deepcopy(axis.values[i]), option="--vary", entry=entry)
        other = SIZES.get(axis.key, "").partition(".")[2]
        if other and own.data["discretization"].get(other) is not None:
            own.data["discretization"][other] = None
    return own


def _require_place(document: Document, own: Document, axis: Axis) -> None:
    """Refuse a key below one that the case does not have, such as that of a shape with a wrong name.

    A section may be absent: its keys then have their defaults.
    """
    value: Any = own.data
    parts = axis.key.split(".")
    for depth, part in enumerate(parts[:-1]):
        if not isinstance(value, dict) or (depth == 0 and part not in value):
            return
        if part not in value:
            message = (
                f"there is no {'.'.join(parts[: depth + 1])} in the case; {nearest(part, value, 'there are')}"
            )
            if axis.path is None:
                place = f"--vary {axis.key}={','.join(map(str, axis.values))}"
                raise CaseError(message, path=axis.key, place=place)
            raise document.error(axis.path, message, key=True)
        value = value[part]


def digest_of(case: Case) -> str:
    """Fingerprint of a resolved case and of the program that solves it."""
    text = json.dumps([__version__, case.to_dict()], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def labels(keys: Sequence[str]) -> dict[str, str]:
    """Shortest ending of each dotted key that tells it from the others."""
    found = {}
    for key in keys:
        parts = key.split(".")
        endings = [".".join(parts[-n:]) for n in range(1, len(parts) + 1)]
        others = [f".{other}" for other in keys if other != key]
        found[key] = next((e for e in endings if not any(o.endswith(f".{e}") for o in others)), key)
    return found


def _name(settings: Mapping[str, Any], names: Mapping[str, str]) -> str:
    return ",".join(f"{names[key]}={_text(value)}" for key, value in settings.items())


def _text(value: Any) -> str:
    """Value as a part of a name of a folder."""
    text = f"{value:g}" if isinstance(value, float) and float(f"{value:g}") == value else str(value)
    plain = re.sub(r"[^A-Za-z0-9._+-]+", "_", text)
    if len(plain) <= LONGEST and plain == text:
        return plain
    return f"{plain[: LONGEST - 7].strip('_')}-{hashlib.sha256(text.encode()).hexdigest()[:6]}"


def _distinct(tasks: Sequence[Task]) -> tuple[Task, ...]:
    """Tasks with names that are not too long for a folder, and different even where case is ignored."""
    short = [
        task if len(task.name) <= 120 else replace(task, name=f"{task.name[:100]}-{task.digest}")
        for task in tasks
    ]
    counts: dict[str, int] = {}
    for task in short:
        counts[task.name.lower()] = counts.get(task.name.lower(), 0) + 1
    return tuple(
        task if counts[task.name.lower()] == 1 else replace(task, name=f"{task.name}-{task.digest[:6]}")
        for task in short
    )


def changes(before: Any, now: Any, path: str = "") -> list[str]:
    """Dotted keys at which two resolved cases differ."""
    if isinstance(before, Mapping) and isinstance(now, Mapping):
        return [
            place
            for key in {**before, **now}
            for place in changes(before.get(key), now.get(key), f"{path}.{key}" if path else str(key))
        ]
    return [] if before == now else [path]
