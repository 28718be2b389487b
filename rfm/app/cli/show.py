"""`rfm show`: what a case states, with a picture of its shape; the summary of a run."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rfm.app.case import Case
from rfm.app.cli.outcome import DONE, print_json
from rfm.app.cli.output import say, table
from rfm.app.cli.settings import load
from rfm.app.report.statement import state_problem
from rfm.errors import CaseError, RfmError


def show_target(*, target: Path, settings: Sequence[str], out: Path | None, as_json: bool) -> int:
    """Show a case or a run; returns the exit code."""
    if target.is_dir() or target.suffix == ".h5":
        return _show_run(target, settings, out, as_json)
    return _show_case(load(target, settings), out, as_json)


def _show_run(target: Path, settings: Sequence[str], out: Path | None, as_json: bool) -> int:
    from rfm.app.cli.run import describe

    if settings or out is not None:
        raise CaseError("--set and --out are for cases, not for runs", place=str(target))
    file = (target if target.is_dir() else target.parent) / "summary.json"
    try:
        summary = json.loads(file.read_text())
    except FileNotFoundError:
        raise CaseError("is no run: it has no summary.json", place=str(target)) from None
    except (OSError, ValueError) as error:
        raise CaseError(f"cannot be read: {error}", place=str(file)) from error
    describe(summary, as_json)
    if as_json:
        print_json(summary)
    return DONE


def _show_case(case: Case, out: Path | None, as_json: bool) -> int:
    from rfm.app.cli.check import findings

    facts = findings(case)
    lines = statement(case)
    for line in lines:
        say(line, as_json)
    table(("shape", "found"), [(key, value) for key, value in facts.items() if key != "status"], as_json)
    picture = out or Path(f"{case.name}.png")
    _write(picture, _picture(case))
    say(f"picture        {picture}", as_json)
    if as_json:
        print_json({**facts, "statement": lines, "files": {"picture": str(picture)}})
    return DONE


def statement(case: Case) -> list[str]:
    """Statement of the problem, one line for each equation and condition."""
    stated = state_problem(case.to_dict())
    lines = [case.title or case.name, ""]
    lines.append(f"  {stated.equation.replace('in Ω', f'in {case.geometry.domain.text}')}")
    data = [(name, meaning) for name, meaning in stated.where if name not in case.parameters]
    lines.append("  " + ", ".join(f"{name} = {meaning}" for name, meaning in data))
    lines += [f"  {condition}" for condition in stated.conditions]
    if case.parameters:
        lines.append("  with " + ", ".join(f"{name} = {value:g}" for name, value in case.parameters.items()))
    lines.append("")
    for name, shape in case.geometry.shapes.items():
        arguments = shape.given.model_dump(exclude_none=True, exclude_unset=True)
        lines.append(f"  {name}: {shape.kind}, " + ", ".join(f"{k} {_text(v)}" for k, v in arguments.items()))
    return lines


def _text(value: Any) -> str:
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    return f"{value:g}" if isinstance(value, float) else str(getattr(value, "text", value))


def _picture(case: Case) -> bytes:
    """Picture of the shape on its grid."""
    from datetime import UTC, datetime

    from rfm.app.build import build_discretization, build_domain
    from rfm.app.pictures import Gallery
    from rfm.app.record import Provenance, RunRecord
    from rfm.app.samples import sample
    from solvers.background import background_grid
    from solvers.classify import classify

    domain = build_domain(case)
    discretization = build_discretization(case, domain)
    grid = background_grid(domain, discretization)
    record = RunRecord(
        name=case.name,
        title=case.title or case.name,
        case=case.to_dict(),
        summary={},
        domain=domain,
        grid=grid,
        classification=classify(domain, grid),
        degree=discretization.degree,
        basis=discretization.basis,
        coefficients=np.zeros(0),
        u=lambda points: np.zeros(len(points)),
        gradient=np.zeros_like,
        provenance=Provenance.collect(datetime.now(UTC)),
    )
    return Gallery(record, sample(record)).shape


def _write(file: Path, content: bytes) -> None:
    try:
        partial = file.with_name(f".{file.name}.partial")
        partial.write_bytes(content)
        partial.replace(file)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise RfmError(f"cannot write {file}: {error.strerror}; choose another place with --out") from error
