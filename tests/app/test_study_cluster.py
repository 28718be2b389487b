"""Studies on a real cluster: a scheduler and two workers, each a process of its own."""

import gc
import json

import pytest
from typer.testing import CliRunner

from rfm.app.cli.application import app
from rfm.app.study import cluster as cluster_module
from rfm.app.study.cluster import Cluster, ClusterError
from rfm.app.study.task import DONE, FAILED
from tests.app.dying import answer
from tests.app.studies import CASE, plan_of

distributed = pytest.importorskip("distributed")

# distributed leaves sockets and loops to the collector when a cluster closes
pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


@pytest.fixture(scope="module")
def address():
    with cluster_module._local(distributed, 2) as found:
        yield found.scheduler_address
    gc.collect()  # what distributed leaves is not to be found in the next test


def invoke(*arguments: str):
    return CliRunner().invoke(app, list(arguments))


def test_runs_go_to_the_workers(address):
    tasks = plan_of(parameters__r=[0.1], discretization__grid=[8, 9, 10, 11]).tasks
    outcomes = list(Cluster(address, work=answer).outcomes(tasks))
    assert {outcome.name for outcome in outcomes} == {task.name for task in tasks}
    processes = {outcome.where.split()[0] for outcome in outcomes}
    assert len(processes) == 2
    assert {outcome.where.split()[1] for outcome in outcomes} == {"1"}  # one thread each


def test_the_command_on_a_cluster(address, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.yaml").write_text(CASE)
    arguments = ["study", "case.yaml", "--vary", "parameters.r=0.1,0.5", "--vary", "discretization.grid=8"]
    result = invoke(*arguments, "--scheduler", address, "--out", "s", "--json")
    assert result.exit_code == 3, result.stderr
    rows = json.loads(result.stdout)["rows"]
    assert [row["state"] for row in rows] == [DONE, FAILED]
    assert rows[0]["relative_l2_error"] < 1e-3
    assert "outside the domain" in rows[1]["error"]["text"]
    assert (tmp_path / "s" / "runs" / "r=0.1,grid=8" / "solution.h5").exists()


def test_workers_with_another_version_are_refused(address, monkeypatch):
    monkeypatch.setattr(cluster_module, "__version__", "9.9")
    with pytest.raises(ClusterError, match=r"the worker .* has rfm .*, this is rfm 9\.9: install the same"):
        list(Cluster(address, work=answer).outcomes(plan_of().tasks))


@pytest.mark.parametrize(
    ("where", "words"),
    [
        ("tcp://127.0.0.1:1", "cannot reach a scheduler at tcp://127.0.0.1:1"),
        ("here", "at here: missing port"),
    ],
)
def test_a_scheduler_that_is_not_there(where, words):
    with pytest.raises(ClusterError) as caught:
        list(Cluster(where, timeout=0.5).outcomes(plan_of().tasks))
    assert words in str(caught.value)
    assert "start one with `dask scheduler`" in str(caught.value)


def test_without_the_package(monkeypatch):
    monkeypatch.setattr(
        cluster_module, "import_module", lambda _: (_ for _ in ()).throw(ImportError("no module"))
    )
    with pytest.raises(ClusterError, match=r"pip install 'rfm\[cluster\]'"):
        list(Cluster().outcomes(plan_of().tasks))
    assert list(Cluster().outcomes([])) == []


@pytest.mark.slow
def test_a_run_that_ends_its_workers_fails_and_the_others_go_on():
    tasks = plan_of(parameters__r=[0.1], discretization__grid=[8, 9, 10, 13]).tasks
    outcomes = {outcome.name: outcome for outcome in Cluster("local", 2, answer).outcomes(tasks)}
    assert [outcomes[task.name].state for task in tasks] == [DONE, DONE, DONE, FAILED]
    assert "its worker was lost each time it was begun" in outcomes[tasks[3].name].error["message"]
