"""One solve on several devices and in several processes is the solve on one."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import threading
from functools import partial

import numpy as np
import pytest

from rfm.errors import DiscretizationError, RfmError
from solvers import pipeline
from solvers.background import background_grid
from solvers.classify import Classification, classify
from solvers.device import backend
from solvers.device.blocks import Blocks, divided, whole
from solvers.device.processes import join
from solvers.device.rendezvous import address_of, meet
from solvers.device.team import Alone
from solvers.problem import Discretization, SolverOptions
from solvers.sharing import WHOLE, Sharing
from tests.solvers.methods_problems import ANNULUS, mixed
from tests.solvers.shards_program import RITZ, floating, solution_of

GRID = Discretization(degree=2, grid=13)
LIMIT = 240
"""Seconds after which a process of a test is ended, on however busy a machine."""


def started(folder, devices, *arguments):
    """A process with virtual devices, whose compiled programs are kept with the caches of the tests."""
    flags = f"--xla_force_host_platform_device_count={devices} --xla_backend_optimization_level=0"
    given = {"XLA_FLAGS": flags, backend.CACHE: str(folder), "OMP_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    command = [sys.executable, "-m", "tests.solvers.shards_program", *map(str, arguments)]
    return subprocess.Popen(
        command, env={**os.environ, **given}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def ended(processes):
    """What processes print in their last line; none is left behind."""
    try:
        found = [process.communicate(timeout=LIMIT) for process in processes]
    finally:
        for process in processes:
            process.kill()
            process.wait()
    for process, (_, errors) in zip(processes, found, strict=True):
        assert process.returncode == 0, errors[-2000:]
    return [json.loads(output.splitlines()[-1]) for output, _ in found]


def free_port():
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        return trial.getsockname()[1]


@pytest.fixture(scope="module")
def folder(request):
    return request.config.cache.mkdir("jax")


@pytest.fixture(scope="module")
def eight(folder):
    return ended([started(folder, 8, "eight")])[0]


@pytest.mark.parametrize(("name", "boxes"), [("annulus", 8), ("ball", 8), ("elasticity", 5)])
def test_products_on_boxes_are_those_of_the_assembled_matrix(eight, name, boxes):
    """The grids have 13, 7 and 13 cells, no multiple of the boxes; outer splines follow from other boxes."""
    found = eight[name]
    assert np.prod(found["boxes"]) == boxes
    assert found["product"] < 1e-13
    assert found["load"] < 1e-14


def assert_agrees(found, problem):
    """Solutions to the accuracy of conjugate gradients, measures to that of sums in another order."""
    alone = solution_of(problem, GRID)
    one, other = np.array(found["coefficients"]), np.array(alone["coefficients"])
    np.testing.assert_allclose(one, other, atol=1e-10 * np.abs(other).max())
    assert found["energy"] == pytest.approx(alone["energy"], rel=1e-10)
    assert found["l2"] == pytest.approx(alone["l2"], rel=1e-6)
    assert found["boundary"] == pytest.approx(alone["boundary"], rel=1e-6, abs=1e-12)


def test_a_solution_on_eight_devices(eight):
    assert_agrees(eight["solution"], mixed())
    assert eight["solution"]["reason"] == "144 unknowns; device: cpu, 2x4 boxes of cells"


def test_a_solution_that_is_known_up_to_a_constant(eight):
    assert_agrees(eight["floating"], floating())


def test_the_program_exchanges_what_the_model_says(eight):
    """On a square that fills its grid: slabs, and boxes with corners."""
    for found, model in eight["traffic"]:
        assert found == model
    assert [found["messages"] for found, _ in eight["traffic"]] == [2, 6]


def test_numbers_of_devices_that_do_not_suit(eight):
    found = eight["refusals"]
    assert found["all"] is None
    assert found["9"][0] == "shards"
    assert found["9"][1] == (
        "shards: 9 needs as many devices, but JAX finds 8 of kind cpu: choose shards: 8 or fewer, or set "
        "XLA_FLAGS=--xla_force_host_platform_device_count=9 before the start"
    )
    assert found["coarse"] == (
        "shards: 7 needs as many layers of cells, but the domain covers only 2x2 cells: refine the grid, or choose "
        "shards: 4 or fewer"
    )


def test_two_processes_share_a_solve(folder):
    address = f"127.0.0.1:{free_port()}"
    first, second = ended([started(folder, 2, "process", address, 2, k, "fail") for k in range(2)])
    for found in (first, second):
        assert_agrees(found, mixed())
        assert found["reason"] == "144 unknowns; device: cpu, 2x2 boxes of cells"
    cells = (classify(ANNULUS, background_grid(ANNULUS, GRID)).state >= 0).sum()
    assert first["rules"] + second["rules"] == cells
    assert 0.4 * cells < first["rules"] < 0.6 * cells
    # the other process is told about an error, and does not wait
    assert second["failed"][0] == "DataError"
    assert first["failed"] == ["RfmError", f"process 1 has failed: {second['failed'][1]}"]


def test_boxes_hold_each_cell_and_each_index_once():
    blocks = Blocks(((0, 3, 7, 8), (2, 5, 9)))
    assert (blocks.counts, blocks.count, blocks.thickness, blocks.shown()) == ((3, 2), 6, (4, 4), "3x2")
    index = np.stack([k.ravel() for k in np.meshgrid(np.arange(11), np.arange(2, 12), indexing="ij")])
    holders = blocks.holders(index).reshape(11, 10)
    for number in range(6):
        (low, high), (left, right) = blocks.box(number)
        inside = holders[low : high if high < 8 else 11, left - 2 : right - 2 if right < 9 else 10]
        assert (inside == number).all()
    assert len(np.unique(holders)) == 6


@pytest.mark.parametrize("count", [1, 2, 3, 7, 12])
def test_boxes_have_about_the_same_work(count):
    state = classify(ANNULUS, background_grid(ANNULUS, Discretization(grid=60))).state
    blocks = divided(state, 2, count)
    assert blocks.count == count
    work = np.where(state == 1, 9, np.where(state == 0, 25, 0))
    sums = [work[tuple(slice(*one) for one in blocks.box(k))].sum() for k in range(count)]
    assert sum(sums) == work.sum()
    assert max(sums) < 1.6 * work.sum() / count


def test_a_grid_is_not_cut_into_more_boxes_than_it_has_layers():
    state = np.ones((3, 2), dtype=np.int8)
    assert divided(state, 1, 6).counts == (3, 2)
    with pytest.raises(
        DiscretizationError, match="covers only 3x2 cells: refine the grid, or choose shards: 4"
    ):
        divided(state, 1, 5)


class Recorded(Alone):
    """One of two processes, the other of which has nothing."""

    index, count = 1, 2


def test_cells_of_other_processes_count_as_outer_ones():
    full = classify(ANNULUS, background_grid(ANNULUS, Discretization(grid=16)))
    sharing = Sharing(Recorded(), Blocks(((0, 7, 16), (0, 16))))
    own = sharing.own(full)
    assert isinstance(own, Classification)
    assert (own.state[:7] == -1).all()
    np.testing.assert_array_equal(own.state[7:], full.state[7:])
    cut, touching = np.split(full.signs, [len(full.cut_cells)])
    expected = [cut[full.cut_cells[:, 0] >= 7], touching[full.touching_cells[:, 0] >= 7]]
    np.testing.assert_array_equal(own.signs, np.concatenate(expected))
    assert sum(map(len, own.boxes)) < sum(map(len, full.boxes))
    assert WHOLE.own(full) is full
    assert whole((3, 4)).box(0) == ((0, 3), (0, 4))


def test_totals_of_one_process():
    np.testing.assert_array_equal(WHOLE.total([1.0, 2.0]), [1.0, 2.0])
    assert WHOLE.largest({"a": 1.0}) == {"a": 1.0}


# rendezvous: who is missing is said, and not waited for

BAD_ADDRESSES = ["localhost", "localhost:", ":80", "host:port", "host:0", "host:70000"]


@pytest.mark.parametrize("text", BAD_ADDRESSES)
def test_an_address_has_a_host_and_a_port(text):
    with pytest.raises(RfmError, match="--coordinator must be HOST:PORT"):
        address_of(text)
    assert address_of("[::1]:80") == ("::1", 80)


def test_processes_meet():
    address = f"127.0.0.1:{free_port()}"
    failures = []

    def one(index):
        try:
            meet(address, 3, index, 20.0)
        except RfmError as error:
            failures.append(str(error))

    threads = [threading.Thread(target=one, args=(k,)) for k in (2, 0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []


def both(*calls):
    """Messages of two processes that do not agree."""
    address, messages = f"127.0.0.1:{free_port()}", {}

    def one(position, count, index):
        with pytest.raises(RfmError) as caught:
            meet(address, count, index, 20.0)
        messages[position] = str(caught.value)

    threads = [threading.Thread(target=partial(one, k, *call)) for k, call in enumerate(calls)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return [messages[k] for k in range(len(calls))]


def test_processes_that_do_not_agree():
    why = "process 0 was started with --processes 2, process 1 with 3"
    assert both((2, 0), (3, 1)) == [
        f"{why}: all need the same number of processes and each a number of its own",
        why,
    ]
    messages = both((3, 0), (3, 1), (3, 1))
    assert all("two processes were started with --process 1" in message for message in messages)


def test_process_0_does_not_answer():
    address = f"127.0.0.1:{free_port()}"
    with pytest.raises(RfmError, match=f"process 0 does not answer at --coordinator {address} in 0.2 s"):
        join(address, 2, 1, patience=0.2)


def test_a_process_is_missing():
    address = f"127.0.0.1:{free_port()}"
    with pytest.raises(RfmError, match=f"no call from process 1, 2 at {address} in 0.2 s: start all 3"):
        join(address, 3, 0, patience=0.2)


def test_the_port_is_taken():
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(RfmError, match=f"process 0 cannot listen at --coordinator {address}"):
            join(address, 2, 0, patience=0.2)


def test_a_process_has_a_number():
    with pytest.raises(RfmError, match="--process must be from 0 to 1 with --processes 2, got 2"):
        join("localhost:4000", 2, 2)
    with pytest.raises(RfmError, match="--coordinator localhost:4000 needs --processes and --process"):
        join("localhost:4000")


def test_shards_of_one_device_change_nothing():
    options = SolverOptions(device="none", shards=1)
    assert pipeline.solve(mixed(), GRID, RITZ, options).linear.method == "dense"
