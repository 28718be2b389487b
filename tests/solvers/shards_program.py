"""Solves on the devices of this process, or of several, and prints what came out as one line of JSON.

Run as a process of its own by :mod:`tests.solvers.test_shards`, since the devices of JAX are fixed when it starts.
Usage: python -m tests.solvers.shards_program eight | process COORDINATOR COUNT INDEX
"""

from __future__ import annotations

import json
import resource
import sys

import numpy as np

from benchmarks.scaling import counted, predicted, system, text_of
from rfm.errors import RfmError
from rfm.geometry import rectangle
from solvers import pipeline
from solvers.device.processes import join
from solvers.equations.poisson import Poisson
from solvers.measures import measure
from solvers.method import refused
from solvers.methods import METHODS
from solvers.norms import all_boundary_errors
from solvers.problem import Dirichlet, Discretization, Problem, SolverOptions
from tests.solvers.methods_problems import mixed, on_the_ball
from tests.solvers.test_device import elastic, floating

RITZ = METHODS["ritz"]
PRODUCTS = {
    "annulus": (
        mixed(conductivity=lambda x, y: 1 + x * y, reaction=2.0),
        Discretization(degree=3, grid=13),
        8,
    ),
    "ball": (on_the_ball(), Discretization(degree=2, grid=7), 8),
    "elasticity": (elastic(), Discretization(degree=2, grid=13), 5),
}


def difference(one, other):
    """Largest difference relative to the largest number."""
    return float(np.abs(one - other).max() / np.abs(other).max())


def product_of(problem, discretization, shards):
    """How far a product on boxes and the load are from the assembled ones."""
    matrix, load, _ = system(problem, discretization, SolverOptions())
    operator, again, blocks = system(problem, discretization, SolverOptions(device="cpu", shards=shards))
    vector = np.random.default_rng(0).standard_normal(len(load))
    image = matrix @ vector
    return {
        "boxes": blocks.counts,
        "thickness": blocks.thickness,
        "product": difference(operator @ vector, image),
        "load": difference(again, load),
    }


def solution_of(problem, discretization, **options):
    """Coefficients and measures of a solution."""
    found = pipeline.solve(problem, discretization, RITZ, SolverOptions(**options))
    return {
        "coefficients": found.trial.splines[0].coefficients.ravel().tolist(),
        "iterations": found.linear.iterations,
        "reason": found.linear.reason,
        "energy": measure(found.pieces).energy,
        "l2": measure(found.pieces).norms.l2,
        "boundary": all_boundary_errors(found.pieces),
        "rules": len(found.background.rules.cut.cells) + len(found.background.rules.inner.cells),
    }


def traffic():
    """Exchanges of the compiled program beside the model, where the domain fills the grid."""
    shape = rectangle(min=(0, 0), max=(1, 1)).named("square")
    problem = Problem(shape, Poisson(source=1.0), (Dirichlet(shape.part("all")),))
    rows = []
    for shards in (3, 8):
        options = SolverOptions(device="cpu", shards=shards)
        operator, load, blocks = system(problem, Discretization(degree=2, grid=16), options)
        found, model = counted(text_of(operator, load)), predicted(blocks, 2)
        rows.append([vars(found), vars(model)])
    return rows


def refusals():
    """Messages of numbers of shards that do not suit eight devices or the grid."""
    found = {}
    for shards in (9, "all"):
        refusal = refused(RITZ, mixed(), Discretization(), SolverOptions(device="cpu", shards=shards))
        found[str(shards)] = None if refusal is None else [refusal.of, refusal.message]
    try:
        pipeline.solve(mixed(), Discretization(degree=1, grid=2), RITZ, SolverOptions(device="cpu", shards=7))
    except RfmError as error:
        found["coarse"] = str(error)
    return found


def eight():
    """Everything that needs one process only."""
    return {
        **{name: product_of(*given) for name, given in PRODUCTS.items()},
        "solution": solution_of(mixed(), Discretization(degree=2, grid=13), device="cpu", shards="all"),
        "floating": solution_of(floating(), Discretization(degree=2, grid=13), device="cpu", shards=6),
        "traffic": traffic(),
        "refusals": refusals(),
    }


def process(coordinator, count, index):
    """One of several processes."""
    join(coordinator, int(count), int(index))
    found = solution_of(mixed(), Discretization(degree=2, grid=13), device="cpu")
    failed = None
    if len(sys.argv) > 5:
        try:
            failing = mixed(conductivity=lambda x, y: 0 * x + (np.nan if int(index) else 1.0))
            pipeline.solve(failing, Discretization(degree=2, grid=13), RITZ, SolverOptions(device="cpu"))
        except RfmError as error:
            failed = [type(error).__name__, str(error)]
    return {**found, "failed": failed, "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss}


if __name__ == "__main__":
    parts = {"eight": eight, "process": process}
    print(json.dumps(parts[sys.argv[1]](*sys.argv[2:5])))
