"""One product with the matrix of a ball on a device: time, bytes and operations an unknown, beside a CSR matrix.

Poisson's equation on the unit ball, zero on its surface.  Usage: python benchmarks/device.py [cpu|gpu] [cells].
Times are CPU times of this process on a processor, wall times elsewhere.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from rfm.calculus.functions import cos, exp, sin
from rfm.geometry import ball
from solvers import pipeline
from solvers.device.backend import computing
from solvers.device.mesh import mapped
from solvers.device.operator import Operator
from solvers.device.product import applied
from solvers.equations.poisson import Poisson
from solvers.problem import Dirichlet, Discretization, Problem, SolverOptions
from solvers.ritz import Ritz
from solvers.stopwatch import Stopwatch

REPEATS = 20


def exact(x: Any, y: Any, z: Any) -> Any:
    """Zero on the unit sphere."""
    return (1 - x * x - y * y - z * z) * exp(x) * sin(y + 0.4) * cos(z)


def system(problem: Problem, discretization: Discretization, kind: str) -> tuple[Any, Any]:
    """Matrix, assembled or for a device, and load."""
    watch = Stopwatch(None)
    mode = pipeline.mode_of(discretization)
    background = pipeline.prepare(problem.domain, mode.quadrature(problem, discretization), watch)
    setting = mode.setting(problem, discretization, background)
    assembler = pipeline.assembler_of(setting, True, SolverOptions(device=kind))
    structure, regions = setting.structure, setting.regions
    return pipeline.Assembly(assembler, problem, Ritz(), structure, background, regions).run(watch)


def seconds(product: Callable[[], Any], clock: Callable[[], float]) -> float:
    """Shortest of some calls."""
    best = np.inf
    for _ in range(REPEATS):
        start = clock()
        product()
        best = min(best, clock() - start)
    return best


def moved(operator: Operator) -> float:
    """Bytes that one product has to read and write: coefficients, results of cells, places, vectors."""
    plan = operator.plan
    total = 0.0
    for group in operator.arrays["groups"]:
        chunks = group["chunks"]
        total += sum(float(array.nbytes) for array in chunks.values())
        total += 16.0 * chunks["base"].size * plan.components * (plan.degree + 1) ** len(plan.shape)
    total += sum(float(array.nbytes) for array in operator.arrays["places"].values())
    return total + 16.0 * operator.shape[0]


def operations(operator: Operator) -> float:
    """Multiplications and additions of one product on tensor nodes, in space, for one spline."""
    line = operator.plan.degree + 1
    total = 0.0
    for plan, group in zip(operator.plan.groups, operator.arrays["groups"], strict=True):
        q, cells = plan.count, group["chunks"]["base"].size
        stages = 2 * line**2 * q + 3 * line * q**2 + 4 * q**3
        total += cells * (4 * line * stages + 20 * q**3)
    return total


def main(kind: str, grid: int) -> None:
    """Print a row for each degree."""
    import jax

    clock = time.process_time if kind == "cpu" else time.perf_counter
    print(
        "p | unknowns | kB and kflop an unknown | ns an unknown: product, CSR | compile (s) | MB: data, temporary"
    )
    for degree in (2, 3, 4):
        shape = ball(center=(0, 0, 0), radius=1).named("ball")
        problem = Problem(shape, Poisson(source=None), (Dirichlet(shape.part("all")),), exact=exact)
        discretization = Discretization(degree=degree, grid=grid)
        operator, load = system(problem, discretization, kind)
        matrix = system(problem, discretization, "none")[0]
        n = len(load)
        with computing(kind):
            start = clock()
            vector = operator.spread(load)
            product = jax.jit(mapped, static_argnums=(0, 1, 2))
            program = product.lower(applied, operator.mesh, operator.plan, operator.arrays, vector).compile()
            compiling = clock() - start
            own = seconds(lambda p=program, o=operator, b=vector: p(o.arrays, b).block_until_ready(), clock)
        csr = seconds(lambda a=matrix, b=load: a @ b, time.process_time)
        data = sum(array.nbytes for array in jax.tree.leaves(operator.arrays))
        extra = program.memory_analysis().temp_size_in_bytes
        stored = "array" if isinstance(matrix, np.ndarray) else f"{matrix.nnz / n:.0f} a row"
        print(
            f"{degree} | {n} | {moved(operator) / n / 1e3:.1f}, {operations(operator) / n / 1e3:.1f} | "
            f"{own / n * 1e9:.0f}, {csr / n * 1e9:.0f} ({stored}) | {compiling:.1f} | "
            f"{data / 1e6:.0f}, {extra / 1e6:.0f}"
        )


if __name__ == "__main__":
    main(*(sys.argv[1:2] or ["cpu"]), *map(int, sys.argv[2:3] or ["16"]))
