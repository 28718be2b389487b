"""Singular functions in a case: the file that is written evaluates as the run did, the summary has the intensity."""

from pathlib import Path

import numpy as np
import pytest

import rfm

CASE = Path(__file__).parents[2] / "cases" / "corners" / "l_shape_source.yaml"
SMALL = {"discretization.grid": 6, "discretization.degree": 2, "expect": {}}
POINTS = np.array([[-0.5, 0.5], [-0.01, 0.01], [0.3, 0.0], [0.0, 0.0]])


def test_a_run_is_written_and_read(tmp_path):
    run = rfm.solve(CASE, set=SMALL)
    run.save(tmp_path / "ell")
    again = rfm.load(tmp_path / "ell")
    assert np.array_equal(run.u(POINTS), again.u(POINTS))
    assert np.array_equal(run.gradient(POINTS[:3]), again.gradient(POINTS[:3]))
    assert np.abs(run.u(POINTS[2:])).max() < 1e-15


def test_the_summary_has_the_intensity():
    run = rfm.solve(CASE, set=SMALL)
    (corner,) = run.summary["corners"]
    assert corner["point"] == [0.0, 0.0]
    assert corner["angle"] == pytest.approx(270.0)
    assert corner["exponent"] == pytest.approx(2 / 3)
    assert corner["intensity"] == pytest.approx(0.4019, abs=5e-3)
    assert rfm.solve(CASE, set={**SMALL, "discretization.singular": "none"}).summary["corners"] == []


def test_the_report_and_the_choices(tmp_path):
    from rfm.app.schema.discretization import SINGULAR
    from solvers.corners.enrichment import CHOICES

    assert SINGULAR == ("auto", "none", "corners")
    assert set(SINGULAR) == set(CHOICES)
    rfm.solve(CASE, set=SMALL).save(tmp_path / "ell")
    report = (tmp_path / "ell" / "report.html").read_text()
    assert "270.0 degrees, u has the singularity" in report
    assert "r<sup>0.6667</sup>" in report


def test_a_file_without_them_is_read_without_them(tmp_path):
    run = rfm.solve(CASE, set={**SMALL, "discretization.singular": "none"})
    run.save(tmp_path / "ell")
    assert len(rfm.load(tmp_path / "ell").trial.splines) == 1
