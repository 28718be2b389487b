"""The command: what it prints where, its exit codes, its speed to answer."""

import json
import os
import socket
import subprocess
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from rfm.app.cli.application import app
from rfm.app.cli.output import table
from rfm.errors import NumericsError

CASE = """\
rfm: 1
title: Annulus
geometry:
  shapes:
    outer: {disk: {center: [0.5, 0.5], radius: 0.4}}
    inner: {disk: {center: [0.5, 0.5], radius: 0.1}}
  domain: outer - inner
equation: {poisson: {source: from exact}}
boundary_conditions:
  - {on: all, dirichlet: from exact}
exact: exp(x)*sin(y)
discretization: {degree: 2, grid: 10}
expect: {relative_l2_error: 1.0e-3, "integrals.area": {value: pi*0.15, tolerance: 1.0e-8}}
study: {grid: [8, 16], degree: [1, 2]}
probes: {A: [0.5, 0.75]}
integrals: {area: {on: domain, of: area}, flux: {on: all, of: flux}}
"""

RUN_FILES = {"summary.json", "solution.h5", "field.vtu", "picture.png", "report.html"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "annulus.yaml").write_text(CASE)
    return tmp_path


def invoke(*arguments: str):
    return CliRunner().invoke(app, list(arguments))


def test_run_writes_a_directory_and_prints_one_object(folder):
    result = invoke("run", "annulus.yaml", "--json", "--set", "discretization.degree=3")
    assert result.exit_code == 0, result.stderr
    summary = json.loads(result.stdout)
    assert summary["case"] == "annulus"
    assert (summary["status"], summary["dimension"], summary["degree"], summary["grid"]) == ("done", 2, 3, 10)
    for key in (
        "dofs",
        "relative_l2_error",
        "relative_h1_error",
        "boundary_error",
        "peak_memory_mb",
        "files",
    ):
        assert summary[key] is not None
    assert set(summary["seconds"]) == {"geometry", "quadrature", "assembly", "solve", "total"}
    assert summary["boundary_error"].keys() == {"all"}
    assert {path.name for path in (folder / "runs" / "annulus").iterdir()} == RUN_FILES
    assert "relative_l2_error" in result.stderr
    stored = json.loads((folder / "runs" / "annulus" / "summary.json").read_text())
    assert stored["dofs"] == summary["dofs"]

    shown = invoke("show", "runs/annulus", "--json")
    assert shown.exit_code == 0
    assert json.loads(shown.stdout)["relative_l2_error"] == summary["relative_l2_error"]
    refused = invoke("show", "runs/annulus", "--set", "a=1")
    assert refused.exit_code == 2


def test_missed_expectation(folder):
    result = invoke(
        "run", "annulus.yaml", "--out", "here", "--set", "expect.relative_l2_error=1e-12", "--json"
    )
    assert result.exit_code == 1
    assert json.loads(result.stdout)["status"] == "missed"
    assert "missed: relative_l2_error: expected at most 1e-12" in result.stderr
    assert {path.name for path in (folder / "here").iterdir()} == RUN_FILES


def test_check_solves_nothing(folder, monkeypatch):
    monkeypatch.setattr("solvers.pipeline.solve", lambda *_: pytest.fail("check must not solve"))
    result = invoke("check", "annulus.yaml", "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert found["status"] == "ok"
    assert found["cells"] == [10, 10]
    assert found["inner_cells"] + found["cut_cells"] + found["outer_cells"] == 100
    assert found["parts"] == ["outer", "inner"]
    assert [path.name for path in folder.iterdir()] == ["annulus.yaml"]


def test_study_measures_rates(folder):
    result = invoke("study", "annulus.yaml", "--json")
    assert result.exit_code == 0, result.stderr
    rows = json.loads(result.stdout)["rows"]
    assert [(row["degree"], row["grid"]) for row in rows] == [(1, 8), (1, 16), (2, 8), (2, 16)]
    assert rows[0]["rate_l2"] is None
    assert rows[1]["rate_l2"] > 1.5
    assert rows[3]["rate_l2"] > 2.4
    assert rows[3]["relative_l2_error"] < rows[1]["relative_l2_error"]
    assert "L2 error" in result.stderr
    assert [path.name for path in folder.iterdir()] == ["annulus.yaml"]


def test_study_goes_on_after_a_grid_that_is_too_coarse(folder):
    result = invoke(
        "study", "annulus.yaml", "--json", "--set", "study={grid: [2, 12], degree: [2]}", "--out", "st"
    )
    assert result.exit_code == 0, result.stderr
    first, second = json.loads(result.stdout)["rows"]
    assert "too coarse" in first["refused"]
    assert first["dofs"] is None
    assert second["rate_l2"] is None
    assert second["relative_l2_error"] > 0
    assert (folder / "st" / "report.html").exists()


def test_study_needs_a_study(folder):
    (folder / "plain.yaml").write_text(CASE.replace("study: {grid: [8, 16], degree: [1, 2]}\n", ""))
    result = invoke("study", "plain.yaml")
    assert result.exit_code == 2
    assert result.stderr.startswith("plain.yaml:1:1: the case has no study; add e.g.")


def test_show_states_the_problem_and_draws_the_shape(folder):
    result = invoke("show", "annulus.yaml")
    assert result.exit_code == 0, result.stderr
    for words in (
        "−Δu = f in outer - inner",
        "u = from exact on all",
        "outer: disk, center [0.5, 0.5], radius 0.4",
    ):
        assert words in result.stdout
    assert (folder / "annulus.png").read_bytes().startswith(b"\x89PNG")
    refused = invoke("show", "annulus.yaml", "--out", "no/such/folder/a.png")
    assert refused.exit_code == 2
    assert "--out" in refused.stderr


@pytest.mark.parametrize(
    "topic", ["shapes", "functions", "equations", "structures", "bases", "weights", "solvers", "cases"]
)
def test_lists(topic):
    result = invoke("list", topic, "--json")
    assert result.exit_code == 0
    rows = json.loads(result.stdout)[topic]
    assert rows
    assert all(all(value for value in list(row.values())[:1]) for row in rows)


def test_list_of_topics_and_unknown_topic():
    assert "shapes, functions, equations" in invoke("list").stdout
    result = invoke("list", "shape")
    assert result.exit_code == 2
    assert "did you mean 'shapes'?" in result.stderr


def test_schema(folder):
    assert json.loads(invoke("schema").stdout)["title"] == "Case"
    assert invoke("schema", "--out", "schema.json").exit_code == 0
    assert json.loads((folder / "schema.json").read_text())["additionalProperties"] is False
    assert invoke("schema", "--out", "no/folder/schema.json").exit_code == 2


def test_doctor():
    result = invoke("doctor", "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["status"] == "ok"
    assert found["self_test"]["passed"]
    assert found["versions"]["numpy"]
    assert any(device.startswith("cpu: ") for device in found["devices"])


@pytest.mark.parametrize(
    ("failure", "code", "words"),
    [
        (NumericsError("no convergence; try linear: dense"), 3, "try linear: dense"),
        (MemoryError(), 3, "not enough memory"),
        (KeyboardInterrupt(), 130, "interrupted"),
    ],
)
def test_failures_have_their_exit_code(folder, monkeypatch, failure, code, words):
    def fail(*_):
        raise failure

    monkeypatch.setattr("rfm.app.run.compute", fail)
    result = invoke("run", "annulus.yaml", "--json")
    assert result.exit_code == code
    assert words in result.stderr
    assert json.loads(result.stdout)["exit_code"] == code
    assert [path.name for path in folder.iterdir()] == ["annulus.yaml"]


def test_wrong_command_line():
    assert invoke("run").exit_code == 2
    assert invoke("solve", "annulus.yaml").exit_code == 2
    assert invoke("run", "annulus.yaml", "--fast").exit_code == 2


TOGETHER = [
    ("none", ("--process", "0"), "--processes and --process need --coordinator HOST:PORT"),
    (
        "none",
        ("--coordinator", "localhost:80"),
        "several processes solve together on devices only: choose cpu or gpu",
    ),
    ("cpu", ("--coordinator", "localhost:80"), "--coordinator localhost:80 needs --processes and --process"),
    (
        "cpu",
        ("--coordinator", "here", "--processes", "2", "--process", "1"),
        "must be HOST:PORT, the same for all",
    ),
]


@pytest.mark.parametrize(("device", "options", "words"), TOGETHER)
def test_processes_that_cannot_solve_together(folder, device, options, words):
    result = invoke("run", "annulus.yaml", "--set", f"solver.device={device}", *options)
    assert result.exit_code == 2
    assert words in result.stderr
    assert [path.name for path in folder.iterdir()] == ["annulus.yaml"]


def of_two_processes(*options):
    """Exit codes, standard output and standard error of two processes that run the case together."""
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{trial.getsockname()[1]}"
    command = [sys.executable, "-c", "from rfm.app.cli import main; main()", "run", "annulus.yaml", *options]
    command += ["--set", "solver.device=cpu", "--coordinator", address, "--processes", "2", "--process"]
    given = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": given}
    processes = [subprocess.Popen([*command, str(k)], **pipes) for k in range(2)]
    try:
        outputs = [process.communicate(timeout=240) for process in processes]
    finally:
        for process in processes:
            process.kill()
            process.wait()
    return [(process.returncode, *output) for process, output in zip(processes, outputs, strict=True)]


@pytest.mark.slow
def test_two_processes_run_a_case(folder):
    """Process 0 writes; standard output is its summary alone, although the collectives report there."""
    (code, output, _), second = of_two_processes("--json")
    assert (code, *second[:2]) == (0, 0, "")
    summary = json.loads(output)
    assert summary["status"] == "done"
    assert summary["linear"]["reason"].endswith("device: cpu, 1x2 boxes of cells")
    assert summary["integrals"]["area"] == pytest.approx(np.pi * 0.15, rel=1e-8)
    assert {path.name for path in (folder / "runs" / "annulus").iterdir()} == RUN_FILES


@pytest.mark.slow
def test_what_process_0_refuses_ends_the_other_one(folder):
    (folder / "taken").write_text("")
    first, second = of_two_processes("--out", "taken")
    assert (first[0], second[0]) == (2, 2)
    message = next(line for line in first[2].splitlines() if line.startswith("error: "))
    assert message.replace("error: ", "error: process 0 has failed: ") in second[2]


def test_version():
    assert invoke("--version").stdout.startswith("rfm 0.")


def test_interrupted_process_leaves_nothing(folder):
    """A signal in the middle of a run: exit code 130, no file."""
    code = (
        "import os, signal, time, rfm.app.run as run\n"
        # a process started in the background may have been told to ignore the signal
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        # the signal may reach another thread first, so the solve goes on until it is delivered
        "run.compute = lambda *a: (os.kill(os.getpid(), signal.SIGINT), time.sleep(60))\n"
        "from rfm.app.cli import main\nmain()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, "run", "annulus.yaml"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 130, done.stderr
    assert "interrupted" in done.stderr
    assert [path.name for path in folder.iterdir()] == ["annulus.yaml"]


HEAVY = (
    "numpy",
    "scipy",
    "jax",
    "pydantic",
    "rich",
    "matplotlib",
    "pyvista",
    "ruamel",
    "h5py",
    "solvers",
    "structures",
)


def test_help_imports_nothing_heavy():
    code = f"import sys\nfrom rfm.app.cli.application import app\nprint([m for m in {HEAVY!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


UNUSED = {
    "check": (
        "scipy",
        "matplotlib",
        "h5py",
        "jinja2",
        "rich",
        "solvers.pipeline",
        "solvers.linear",
        "structures.catalogue",
    ),
    "run": (
        "matplotlib.pyplot",
        "rich.table",
        "solvers.collocation",
        "solvers.bases.radial",
        "rfm.geometry.voxels",
    ),
}
"""Modules that a command can do without; besides, none needs those of the next line."""
NEVER = (
    "jax",
    "pyvista",
    "vtk",
    "pyamg",
    "meshio",
    "distributed",
    "rfm.geometry.transforms",
    "rfm.geometry.outlines",
)


@pytest.mark.parametrize("command", UNUSED)
def test_a_command_imports_what_it_needs(folder, command):
    code = (
        "import sys\nfrom rfm.app.cli import main\n"
        f"try:\n    main()\nfinally:\n    print([m for m in {UNUSED[command] + NEVER!r} if m in sys.modules])"
    )
    arguments = [sys.executable, "-c", code, command, "annulus.yaml"]
    done = subprocess.run(arguments, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_wide_tables_go_on_in_the_next_line(capsys):
    table(("name", "n", "text"), [("a", 1, "word " * 40), ("bc", 12.5, "x" * 150)], False, title="Title")
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].startswith("Title")
    assert lines[2].split() == ["name", "n", "text"]
    assert set(lines[3]) == {"─"}
    assert lines[4].split()[:3] == ["a", "1", "word"]
    assert len(lines) == 9  # two more lines of text, and an empty one
    assert max(map(len, lines)) <= 120


def test_help_answers_at_once():
    """The least of several runs, in processor time: other work on the computer does not count."""
    import resource

    times = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        code = "from rfm.app.cli import main; main()"
        done = subprocess.run(
            [sys.executable, "-c", code, "--help"], capture_output=True, text=True, check=True
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    assert "Usage: rfm" in done.stdout
    assert min(times) < 0.3
