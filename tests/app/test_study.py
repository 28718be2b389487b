"""Studies: which runs there are, who makes them, what is kept, and how they go on."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import rfm
from rfm.app.cli.application import app
from rfm.app.run import record_of
from rfm.app.source import from_mapping
from rfm.app.storage import solution_bytes
from rfm.app.study import engines
from rfm.app.study.engines import Automatic, Here, Processes
from rfm.app.study.folder import StudyFolder
from rfm.app.study.runner import KEPT, Interrupted, run_study, run_study_in
from rfm.app.study.task import DONE, FAILED, REFUSED, Outcome, execute, lost
from tests.app.dying import answer
from tests.app.studies import CASE, plan_of

ROOT = Path(__file__).parents[2]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.yaml").write_text(CASE)
    return tmp_path


def invoke(*arguments: str):
    return CliRunner().invoke(app, list(arguments))


class Instant:
    """An engine that answers at once, from the last task to the first, and counts."""

    def __init__(self, fails=(), stop_after=None):
        self.fails, self.stop_after, self.made = fails, stop_after, []

    def outcomes(self, tasks):
        for task in reversed(tasks):
            if self.stop_after is not None and len(self.made) == self.stop_after:
                raise KeyboardInterrupt
            self.made.append(task.name)
            if task.name in self.fails:
                yield lost(task, "it failed")
                continue
            outcome = answer(replace(task, grid=task.grid + 100))
            summary = json.dumps(dict(outcome.summary)).encode()
            yield replace(outcome, files={"summary.json": summary, "solution.h5": b""} if task.files else {})


# What is refused ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--vary", "parameters.r"], "--vary parameters.r: expected key=value,value,..."),
        (["--vary", "parameters.r="], "--vary parameters.r=: expected key=value,value,..."),
        (
            ["--vary", "parameters.r=0.1,-1"],
            "case.yaml:7:48: geometry.shapes.inner.disk.radius: must be positive",
        ),
        (["--vary", "parameters.r=0.1,a"], "--vary parameters.r=a: parameters.r: unknown name 'a'"),
        (
            ["--vary", "discretization.gird=8"],
            "--vary discretization.gird=8: discretization.gird: unknown key 'gird'",
        ),
        (
            ["--vary", "geometry.shapes.iner.disk.radius=1,2"],
            "there is no geometry.shapes.iner in the case; did you",
        ),
        (["--vary", "parameters.r=[1"], "--vary parameters.r=[[1]: not valid YAML"),
        (["--vary", "parameters.r=1,1"], "holds 1 twice"),
        (["--vary", "rfm=1,2"], "a study cannot vary 'rfm'"),
        (["--restart"], "--restart needs --out DIR"),
        (["--pictures"], "--pictures needs --out DIR"),
        (["--jobs", "0"], "--jobs: must be at least 1, got 0"),
        (
            ["--vary", "parameters.r=" + ",".join(map(str, range(1, 10002)))],
            "study: has 20002 runs, at most 20000",
        ),
    ],
)
def test_a_wrong_command_is_refused(folder, arguments, words):
    result = invoke("study", "case.yaml", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert [path.name for path in folder.iterdir()] == ["case.yaml"]


# Who makes the runs --------------------------------------------------------------------------------


def test_a_run_never_raises():
    task = plan_of().tasks[0]
    fine = execute(replace(task, files=KEPT, folder="there"))
    assert (fine.state, set(fine.files)) == (DONE, set(KEPT))
    assert fine.summary["study"]["digest"] == task.digest
    coarse = execute(replace(task, document=replace(task.document, data=_with(task, grid=1))))
    assert coarse.state == REFUSED
    assert "too coarse" in coarse.error["message"]
    large = execute(replace(task, share=1e-9))
    assert large.state == REFUSED
    assert "of memory" in large.error["message"]
    broken = execute(replace(task, document=from_mapping({})))
    assert (broken.state, broken.error["exit_code"]) == (FAILED, 2)
    defect = execute(replace(task, document=None))
    assert (defect.state, defect.error["kind"]) == (FAILED, "AttributeError")
    assert "Traceback" in defect.error["traceback"]


def _with(task, **discretization):
    data = json.loads(json.dumps(task.document.data))
    data["discretization"].update(discretization)
    return data


def test_processes_survive_the_loss_of_one():
    tasks = plan_of(parameters__r=[0.1], discretization__grid=[8, 9, 10, 13]).tasks
    outcomes = list(Processes(2, answer).outcomes(tasks))
    by_grid = {task.grid: outcome for task in tasks for outcome in outcomes if outcome.name == task.name}
    assert {grid: outcome.state for grid, outcome in by_grid.items()} == {
        8: DONE,
        9: DONE,
        10: DONE,
        13: FAILED,
    }
    assert by_grid[13].error["message"] == "its process ended 2 times (exit code 7); out of memory?"
    assert by_grid[8].where.split()[1] == "1"  # one thread


def test_a_long_study_goes_on_in_processes(monkeypatch):
    monkeypatch.setattr(engines, "processors", lambda: 2)
    monkeypatch.setattr(engines, "execute", lambda task, listener: answer(task))
    monkeypatch.setattr(engines, "Processes", lambda jobs: pytest.fail(f"{jobs} processes"))
    tasks = plan_of().tasks
    assert [o.name for o in Automatic(patience=60.0).outcomes(tasks)] == [task.name for task in tasks]
    with pytest.raises(pytest.fail.Exception, match="2 processes"):
        list(Automatic(patience=-1.0).outcomes(tasks))


# What is kept --------------------------------------------------------------------------------------


def test_only_what_is_missing_or_failed_is_made(tmp_path, monkeypatch):
    monkeypatch.setattr("rfm.app.study.runner._report", lambda folder, rows: {})
    plan = plan_of()
    first = Instant(fails=["r=0.2,grid=8"])
    study = run_study_in(StudyFolder(tmp_path / "s", plan, KEPT), first)
    assert [row["state"] for row in study.rows] == [DONE, DONE, FAILED, DONE]
    assert [row["run"] for row in study.rows] == [task.name for task in plan.tasks]
    state = json.loads((tmp_path / "s" / "study.json").read_text())
    assert state["runs"] == {"done": 3, "failed": 1}
    assert state["rows"][2]["error"]["message"] == "it failed"

    (tmp_path / "s" / "runs" / "r=0.1,grid=8" / "summary.json").write_text('{"damaged')
    (tmp_path / "s" / "runs" / "r=0.1,grid=12" / "solution.h5").unlink()
    longer = plan_of(CASE.replace("[8, 12]", "[8, 12, 16]"))
    second = Instant()
    study = run_study_in(StudyFolder(tmp_path / "s", longer, KEPT), second)
    assert set(second.made) == {
        *("r=0.1,grid=8", "r=0.1,grid=12", "r=0.1,grid=16"),
        *("r=0.2,grid=8", "r=0.2,grid=16"),
    }
    assert study.reused == 1
    assert {row["state"] for row in study.rows} == {DONE}


def test_runs_of_another_case_are_not_mixed_in(tmp_path, monkeypatch):
    monkeypatch.setattr("rfm.app.study.runner._report", lambda folder, rows: {})
    run_study_in(StudyFolder(tmp_path / "s", plan_of(), KEPT), Instant())
    changed = plan_of(CASE.replace("radius: 0.4", "radius: 0.45"))
    with pytest.raises(
        rfm.RfmError, match=r"4 of these runs of another state .*radius\): choose .*--restart"
    ):
        StudyFolder(tmp_path / "s", changed, KEPT)
    engine = Instant(stop_after=1)
    with pytest.raises(Interrupted, match="1 of 4 runs are done and kept in"):
        run_study_in(StudyFolder(tmp_path / "s", changed, KEPT, restart=True), engine)
    engine = Instant()
    assert run_study_in(StudyFolder(tmp_path / "s", changed, KEPT), engine).reused == 1
    assert len(engine.made) == 3
    (tmp_path / "notes").mkdir()
    (tmp_path / "notes" / "mine.txt").write_text("x")
    with pytest.raises(rfm.RfmError, match="holds files that are not of a run"):
        StudyFolder(tmp_path / "notes", changed, KEPT)


def test_an_interruption_says_what_is_kept(tmp_path):
    with pytest.raises(Interrupted, match="after 2 of 4 runs; nothing is kept without --out DIR"):
        run_study(plan_of(), Instant(stop_after=2))
    with pytest.raises(Interrupted, match=r"2 of 4 runs are done and kept in .*: the same command goes on"):
        run_study_in(StudyFolder(tmp_path / "s", plan_of(), KEPT), Instant(stop_after=2))
    state = json.loads((tmp_path / "s" / "study.json").read_text())
    assert state["runs"] == {"done": 2, "pending": 2}


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("mixed/annulus_exact", {"discretization.grid": 12}),
        ("elasticity/kirsch_quarter", {"discretization.grid": 10}),
        ("materials/disk_in_square", {"discretization.grid": 16}),
    ],
)
def test_a_run_is_reported_from_its_file_without_solving_it(tmp_path, monkeypatch, name, settings):
    run = rfm.solve(ROOT / "cases" / f"{name}.yaml", settings)
    made = record_of(run.result)
    (tmp_path / "solution.h5").write_bytes(solution_bytes(made))
    monkeypatch.setattr("solvers.pipeline.solve", lambda *_: pytest.fail("it must not be solved again"))
    found = rfm.load(tmp_path)._record()
    points = np.random.default_rng(1).uniform(made.domain.box.lower, made.domain.box.upper, (20, 2))
    np.testing.assert_allclose(found.u(points), made.u(points), rtol=1e-9, atol=1e-12)
    assert found.derived.keys() == made.derived.keys()
    for key, function in made.derived.items():
        np.testing.assert_allclose(found.derived[key](points), function(points), rtol=1e-7, atol=1e-9)
    np.testing.assert_array_equal(found.classification.state, made.classification.state)
    assert (found.linear, found.residuals, found.title) == (made.linear, made.residuals, made.title)


# The command ---------------------------------------------------------------------------------------


def test_a_sweep_from_the_command_line(folder):
    arguments = [
        "study",
        "case.yaml",
        "--vary",
        "parameters.r=0.1,0.5",
        "--jobs",
        "1",
        "--out",
        "s",
        "--json",
    ]
    result = invoke(*arguments)
    assert result.exit_code == 3, result.stderr  # the inner disk grows over the probe
    printed = json.loads(result.stdout)
    assert printed["status"] == "failed"
    assert [row["state"] for row in printed["rows"]] == [DONE, DONE, FAILED, FAILED]
    assert printed["rows"][1]["rate_l2"] > 2.0
    assert printed["rows"][0]["results"].keys() == {"integrals.area", "probes.A.u"}
    assert "[4/4] r=0.5,grid=12: failed: the point lies outside the domain" in result.stderr
    assert "r 0.5, grid 8: the point lies outside" in result.stderr
    run = rfm.load(folder / "s" / "runs" / "r=0.1,grid=12")
    assert run.summary["relative_l2_error"] == printed["rows"][1]["relative_l2_error"]
    assert rfm.load(folder / "s").summary["study"]["run"] == "r=0.1,grid=12"
    assert "Convergence" in (folder / "s" / "report.html").read_text()

    again = invoke(*arguments)
    assert "2 of 4 runs were done before" in again.stderr
    assert "r=0.1" not in [line for line in again.stderr.splitlines() if line.startswith("[")]
    assert invoke("show", "s").exit_code == 0


def test_ctrl_c_in_a_study_of_processes(folder):
    """Finished runs stay, the processes end, the exit code says so."""
    code = (
        "import os, signal\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "import rfm.app.cli.study as study, rfm.app.study.engines as engines\n"
        "from tests.app.dying import answer\n"
        "study._engine = lambda *_: engines.Processes(2, answer)\n"
        "study._tell = lambda *_: os.kill(os.getpid(), signal.SIGINT)\n"
        "if __name__ == '__main__':\n"
        "    from rfm.app.cli import main\n    main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "study", "case.yaml"],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 130, done.stderr
    assert "interrupted after 1 of 4 runs; nothing is kept without --out DIR" in done.stderr


def test_nothing_came_out(folder):
    result = invoke(
        "study", "case.yaml", "--set", "parameters.r=0.5", "--set", "study={grid: [8, 9]}", "--jobs", "1"
    )
    assert result.exit_code == 2
    assert "case.yaml:15:13: probes.A: the point lies outside the domain" in result.stderr


def test_outcomes_without_listener():
    tasks = plan_of(parameters__r=[0.1], discretization__grid=[8]).tasks
    (outcome,) = Here().outcomes(tasks)
    assert isinstance(outcome, Outcome)
    assert outcome.where


def test_processes_make_real_runs(folder):
    result = invoke("study", "case.yaml", "--jobs", "2", "--vary", "parameters.r=0.1", "--json")
    assert result.exit_code == 0, result.stderr
    rows = json.loads(result.stdout)["rows"]
    assert [(row["grid"], row["state"]) for row in rows] == [(8, DONE), (12, DONE)]
    assert rows[1]["rate_l2"] > 2.0
