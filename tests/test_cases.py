"""Every case of `cases/` through the Python entry, its files included; and what the slivers must not change."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import rfm

CASES = sorted((Path(__file__).parents[1] / "cases").rglob("*.yaml"))
SLIVERS = [path for path in CASES if path.stem.startswith("sliver")]


def name(path: Path) -> str:
    return f"{path.parent.name}/{path.stem}"


@pytest.mark.parametrize("path", CASES, ids=name)
def test_a_case_keeps_its_limits(path: Path, tmp_path: Path) -> None:
    run = rfm.solve(path)
    run.save(tmp_path / "run")
    assert run.result is not None
    assert not run.result.misses, [str(miss) for miss in run.result.misses]
    assert run.summary["status"] == "done"
    written = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert written["dofs"] == run.summary["dofs"]


@pytest.mark.parametrize("path", SLIVERS, ids=name)
@pytest.mark.parametrize("degree", [2, 3, 4])
def test_slivers_change_neither_the_error_nor_the_work(path: Path, degree: int) -> None:
    errors, iterations = [], []
    for exponent in range(1, 13):
        overrides = {
            "parameters.eps": 10.0**-exponent,
            "discretization.degree": degree,
            "solver.linear": "cg",
        }
        run = rfm.solve(path, set=overrides)
        assert run.result is not None
        errors.append(run.summary["relative_l2_error"])
        iterations.append(run.result.solution.linear.iterations)
    assert max(errors) < 3 * min(errors)
    assert max(iterations) < 3 * min(iterations)
