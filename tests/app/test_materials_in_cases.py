"""Cases with several materials: the run, its files, and what is loaded again."""

from pathlib import Path

import numpy as np
import pytest

import rfm

CASES = Path(__file__).parents[2] / "cases"


@pytest.mark.parametrize("name", ["materials/two_rings", "periodic/channel"])
def test_a_stored_run_evaluates_as_it_did(tmp_path, name):
    run = rfm.solve(
        CASES / f"{name}.yaml", set={"discretization.grid": 16, "discretization.degree": 3, "expect": {}}
    )
    files = run.save(tmp_path / "run")
    assert {"summary", "solution", "field", "picture", "report"} <= set(files)
    loaded = rfm.load(tmp_path / "run")
    points = np.random.default_rng(0).uniform(0, 0.6, (200, 2))
    assert np.array_equal(loaded.u(points), run.u(points))
    assert np.array_equal(loaded.gradient(points), run.gradient(points))


def test_probes_and_integrals_know_the_material():
    run = rfm.solve(
        CASES / "materials/two_rings.yaml",
        set={
            "probes": {"inside": [0.45, 0], "outside": [0.8, 0]},
            "integrals": {"outflow": {"on": "outer", "of": "flux"}, "inflow": {"on": "hole", "of": "flux"}},
        },
    )
    found = run.summary
    exact = (1 / 0.6 + 0.4) * 0.6 / 5  # slope A/r inside
    assert found["probes"]["inside"]["gradient"][0] == pytest.approx(exact / 0.45, abs=1e-4)
    assert found["probes"]["outside"]["gradient"][0] == pytest.approx(1 / 0.8, abs=1e-4)
    assert found["integrals"]["outflow"] == pytest.approx(2 * np.pi, abs=1e-3)
    assert found["integrals"]["inflow"] == pytest.approx(-2 * np.pi * exact * 5, abs=1e-3)


def test_stresses_are_those_of_the_material():
    run = rfm.solve(
        CASES / "materials/elastic_layers.yaml", set={"probes": {"core": [0.5, 0.45]}, "expect": {}}
    )
    stress = run.summary["probes"]["core"]["stress"]
    young, ratio = 20.0, 0.2
    ux, vy = 0.3 * 0.45, np.exp(0.25)
    first = young * ratio / ((1 + ratio) * (1 - 2 * ratio))
    expected = first * (ux + vy) + young / (1 + ratio) * ux
    assert stress["xx"] == pytest.approx(expected, rel=1e-3)
