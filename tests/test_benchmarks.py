"""The benchmark: exact formulas, right reading of rows, programs that run. Nothing depends on the clock."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
import sympy as sp

from benchmarks import report, run, worker
from benchmarks.problems import HOLE, LAMBDA, MU, PROBLEMS, Ball, Block, Bore, Polygon, Problem, kirsch_stress
from benchmarks.programs import MODULES, load, refined
from benchmarks.record import Answer, Configuration, Laps, Row, crossing, exponent, reached


class Symbols:
    sin, cos, exp, cosh, arctan2 = sp.sin, sp.cos, sp.exp, sp.cosh, sp.atan2


INSIDE = {2: [(-0.31, 0.62), (-0.7, 0.13), (-0.52, 0.81)], 3: [(-0.31, 0.62, 0.4), (0.5, 0.13, -0.2)]}


def by_name(one: Problem) -> str:
    return one.slug


def symbols(one: Problem) -> tuple[Any, ...]:
    return sp.symbols("x y z", real=True)[: one.dimension]


def laplacian(u: Any, coordinates: Sequence[Any]) -> Any:
    return sum(sp.diff(u, x, 2) for x in coordinates)


SCALAR = [one for one in PROBLEMS if one.equation != "elasticity"]


@pytest.mark.parametrize("one", SCALAR, ids=by_name)
def test_the_source_fits_the_solution(one: Problem) -> None:
    coordinates = symbols(one)
    exact = one.exact(Symbols, *coordinates)
    operator = -laplacian(exact, coordinates)
    if one.equation == "plate":
        operator = -laplacian(operator, coordinates)
    source = one.source(Symbols, *coordinates) if one.source else 0
    for point in INSIDE[one.dimension]:
        difference = (operator - source).subs(dict(zip(coordinates, point, strict=True)))
        assert abs(float(difference)) < 1e-12


def strains(x: Any, y: Any) -> tuple[Any, Any, Any]:
    kirsch = next(one for one in PROBLEMS if one.equation == "elasticity")
    u, v = kirsch.exact(Symbols, x, y)
    return sp.diff(u, x), sp.diff(v, y), (sp.diff(u, y) + sp.diff(v, x)) / 2


def test_the_stress_of_the_kirsch_plate_is_that_of_its_displacement_and_in_equilibrium() -> None:
    x, y = sp.symbols("x y", real=True)
    exx, eyy, exy = strains(x, y)
    trace = LAMBDA * (exx + eyy)
    xx, yy, xy = kirsch_stress(Symbols, x, y)
    residuals = [
        trace + 2 * MU * exx - xx,
        trace + 2 * MU * eyy - yy,
        2 * MU * exy - xy,
        sp.diff(xx, x) + sp.diff(xy, y),
        sp.diff(xy, x) + sp.diff(yy, y),
    ]
    for residual in residuals:
        assert abs(float(residual.subs({x: 0.7, y: 0.9}))) < 1e-12


def test_the_hole_of_the_kirsch_plate_is_free_and_its_symmetry_lines_are_rollers() -> None:
    angle = np.linspace(0.0, np.pi / 2, 7)
    n = np.cos(angle), np.sin(angle)
    xx, yy, xy = kirsch_stress(np, HOLE * n[0], HOLE * n[1])
    np.testing.assert_allclose([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]], 0.0, atol=1e-14)
    kirsch = next(one for one in PROBLEMS if one.equation == "elasticity")
    line = np.linspace(HOLE, 2.0, 5)
    np.testing.assert_allclose(kirsch.exact(np, 0 * line, line)[0], 0.0, atol=1e-14)
    np.testing.assert_allclose(kirsch.exact(np, line, 0 * line)[1], 0.0, atol=1e-14)


def boundary(solid: Any) -> np.ndarray[Any, Any]:
    """Points on the boundary of a solid, one column each."""
    t = np.linspace(0.1, 6.2, 9)
    if isinstance(solid, Ball) and len(solid.center) == 2:
        return np.array(solid.center)[:, None] + solid.radius * np.array([np.cos(t), np.sin(t)])
    if isinstance(solid, Ball):
        directions = [np.cos(t) * np.sin(2 * t), np.sin(t) * np.sin(2 * t), np.cos(2 * t)]
        return np.array(solid.center)[:, None] + solid.radius * np.array(directions)
    if isinstance(solid, Bore):
        return np.array([solid.radius * np.cos(t), solid.radius * np.sin(t), 0.1 * t])
    if isinstance(solid, Block):
        (x, y), (right, top) = solid.low, solid.high
        solid = Polygon(((x, y), (right, y), (right, top), (x, top)))
    start = np.array(solid.vertices, dtype=float)
    end = np.roll(start, -1, axis=0)
    return np.concatenate([start + s * (end - start) for s in (0.0, 0.3, 0.8)]).T


@pytest.mark.parametrize("one", SCALAR, ids=by_name)
def test_the_data_fit_the_solution(one: Problem) -> None:
    for solid in (one.outer, *one.holes):
        points = boundary(solid)
        data = one.data(np, *points) if one.data else 0.0
        np.testing.assert_allclose(one.exact(np, *points), data, atol=1e-14)


@pytest.mark.parametrize("one", [one for one in PROBLEMS if one.data and one.extended], ids=by_name)
def test_the_extension_of_the_data_is_not_the_solution(one: Problem) -> None:
    assert one.data is not None
    points = np.array(INSIDE[one.dimension]).T
    assert np.abs(one.exact(np, *points) - one.data(np, *points)).min() > 1e-3


def row(error: float, total: float, unknowns: int, series: str = "a", program: str = "rfm") -> Row:
    return Row(program, "annulus", series, {"cells": 4}, unknowns, error, {"solve": total}, memory_mb=30.0)


def test_a_tolerance_is_interpolated_between_logarithms() -> None:
    rows = [row(1e-3, 0.1, 100), row(1e-5, 0.4, 1600)]
    assert crossing(rows, 1e-4) == pytest.approx((0.2, 400))
    assert crossing(rows, 1e-2) == pytest.approx((0.1, 100))
    assert crossing(rows, 1e-6) is None


def test_the_fastest_series_and_the_one_of_fewest_unknowns_are_found() -> None:
    rows = [row(1e-3, 0.1, 100), row(1e-5, 0.4, 1600), row(1e-5, 0.3, 50, "b"), row(1e-2, 0.01, 9, "c")]
    best = reached(rows, 1e-4)
    assert best is not None
    assert (best.series, best.fewest_series, best.coarsest) == ("a", "b", False)
    assert (best.seconds, best.fewest_unknowns) == pytest.approx((0.2, 50))
    assert reached(rows, 1e-9) is None


def test_an_exponent_is_fitted() -> None:
    unknowns = [10.0, 100.0, 1000.0]
    assert exponent(unknowns, [3 * n**1.5 for n in unknowns]) == pytest.approx(1.5)
    with pytest.raises(ValueError, match="an exponent needs two different numbers of unknowns"):
        exponent([10.0, 10.0], [1.0, 2.0])


def test_configurations_get_finer() -> None:
    assert refined("size", 0.4, 2.0, 3, degree=2) == [{"degree": 2, "size": 0.4 / 2**i} for i in range(3)]


PACKAGES = (
    "gmsh",
    "netgen",
    "netgen.occ",
    "ngsolve",
    "ngsolve.meshes",
    "nutils",
    "nutils.expression_v2",
    "nutils.solver",
    "skfem",
    "skfem.helpers",
    "treelog",
    "xfem",
    "xfem.lsetcurv",
    "xfem.mlset",
)
"""What the other programs import; the environment of the tests has none of it."""


@pytest.mark.parametrize("name", MODULES)
def test_every_program_has_series_for_problems_it_solves(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The series need no solver: stand-ins take the places of the packages, so that none is left out."""
    for package in PACKAGES:
        monkeypatch.setitem(sys.modules, package, MagicMock())
    for module in [module for module in sys.modules if module.startswith("benchmarks.programs.")]:
        monkeypatch.delitem(sys.modules, module)
    program = load(name)
    listed = [configurations for one in PROBLEMS for configurations in program.series(one).values()]
    assert listed
    for configurations in listed:
        assert len(configurations) >= 5
        json.dumps([dict(one) for one in configurations])  # they travel as JSON


@pytest.mark.parametrize("name", ["rfm", "rfm, large"])
def test_a_program_names_its_versions(name: str) -> None:
    assert "rfm" in load(name).versions()


EXPECTED = {
    "annulus, sine": 1e-6,
    "annulus": 2e-5,
    "plate with three holes": 1e-3,
    "L-shape": 1e-2,
    "Kirsch plate": 2e-2,
    "clamped plate": 1e-3,
    "ball minus cylinder": 2e-2,
}


@pytest.mark.parametrize("one", PROBLEMS, ids=by_name)
def test_rfm_solves_every_problem(one: Problem) -> None:
    configuration = {"degree": 2, "cells": 7} if one.dimension == 3 else {"degree": 4, "cells": 6}
    laps = Laps()
    answer = load("rfm").solve(one, configuration, laps)
    assert 20 < answer.unknowns < 400
    assert answer.error() < EXPECTED[one.name]
    assert all(laps.seconds[phase] > 0 for phase in ("geometry", "quadrature", "assembly", "solve"))


class Stand:
    """A program whose error halves with the size, that fails where it is told to."""

    def solve(self, one: Problem, configuration: Configuration, laps: Laps) -> Answer:
        if configuration["size"] > 1:
            raise ValueError("too coarse")
        laps.lap("solve")
        return Answer(int(1 / configuration["size"]), lambda: configuration["size"] * configuration["scale"])


def swept(scale: float, whole: bool = False) -> list[Row | str]:
    configurations = refined("size", 2.0, 2.0, 6, scale=scale)
    return list(
        worker.sweep(Stand(), "stand", PROBLEMS[0], "s", configurations, 60.0, math.inf, whole)  # type: ignore[arg-type]
    )


def test_a_series_goes_on_after_a_grid_that_is_too_coarse() -> None:
    first, *rows = swept(1.0)
    assert first == "s, {'scale': 1.0, 'size': 2.0}: ValueError: too coarse"
    assert [one.error for one in rows if isinstance(one, Row)] == [1.0, 0.5, 0.25, 0.125, 0.0625]


def test_a_series_ends_at_the_last_tolerance_unless_it_is_wanted_whole() -> None:
    assert len(swept(1e-9)) == 2
    assert len(swept(1e-9, whole=True)) == 6


def test_a_series_ends_with_the_budget() -> None:
    found = worker.sweep(Stand(), "stand", PROBLEMS[0], "s", [{}], 1.0, -math.inf)  # type: ignore[arg-type]
    assert list(found) == ["s: ended by the budget"]


def test_a_worker_that_cannot_start_leaves_a_note() -> None:
    (line,) = run.lines(sys.executable, "abacus", "annulus", ["1", "1"])
    assert line == {"note": "KeyError: 'abacus'"}


def test_a_page_is_written_from_the_results(tmp_path: Path) -> None:
    peers = run.Record({"system": "S", "cores": 2, "threads": 2, "limit": 1.0, "remark": "Idle."})
    peers.versions = {"rfm": {"rfm": "1"}}
    peers.rows = [row(1e-3, 0.1, 100), row(1e-9, 0.4, 1600), row(1e-5, 0.8, 8000, "b", "NGSolve")]
    peers.notes = ["annulus|nutils|p=2: ended by the budget", "annulus|nutils|p=3, {}: not done after 3 s"]
    peers.write(tmp_path / "peers.json")
    large = run.Record(peers.settings, {})
    large.rows = [row(1e-3, float(n), n, "p=2", "rfm, large") for n in (10**4, 10**5)]
    for one in large.rows:
        one.seconds.update(geometry=1.0, quadrature=1.0, assembly=1.0)  # type: ignore[attr-defined]
    large.write(tmp_path / "large.json")
    report.write(tmp_path, tmp_path / "docs")
    text = (tmp_path / "docs" / "benchmarks.md").read_text()
    assert (
        "| annulus | rfm | 0.126 s / 159 (a) | 0.200 s / 400 (a) | 0.317 s / 1008 (a) | 1e-09 in 0.400 s |"
        in text
    )
    assert "| annulus | 0.16 of NGSolve; unknowns 1/50 | only rfm | only rfm |" in text
    assert "- annulus, nutils: p=2; p=3\n" in text
    assert "S, 2 cores, 2 threads, limit 1 s; rfm 1. Idle." in text
    for picture in ("benchmark_annulus.png", "benchmark_growth.png"):
        assert f"(pictures/{picture})" in text
        assert (tmp_path / "docs" / "pictures" / picture).stat().st_size < 150_000
