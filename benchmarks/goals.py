"""The large solves that have goals: ``python benchmarks/goals.py``, each in a process of its own.

Prints seconds by phase, the goal for two idle cores, unknowns, the linear solver and the highest resident memory.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
GOALS = (
    ("ball", 2, 64, 5.0),
    ("ball minus cylinder", 2, 64, 5.0),
    ("ball", 3, 48, 20.0),
    ("annulus", 3, 512, 3.0),
)
"""Problem, degree, cells along the longest side, seconds."""


def measure(name: str, degree: int, cells: int, goal: float) -> str:
    """Solve once in this process; the line of the table."""
    from benchmarks.problems import problem
    from benchmarks.programs import rfm_program
    from rfm.geometry import ball
    from solvers import problem as posed
    from solvers import ritz
    from solvers.equations.poisson import Poisson

    if name == "ball":
        domain = ball(center=(0, 0, 0), radius=1)
        given = posed.Dirichlet(domain.part("all"), lambda x, y, z: x * z)
        stated = posed.Problem(domain, Poisson(source=lambda x, y, z: 1.0 + x * y), (given,))
    else:
        stated = rfm_program.pose(problem(name))
    start = time.perf_counter()
    solution = ritz.solve(stated, posed.Discretization(degree=degree, grid=cells))
    total = time.perf_counter() - start
    split = ", ".join(f"{phase} {seconds:.2f}" for phase, seconds in solution.seconds.items())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return (
        f"{name}, p = {degree}, {cells} cells: {total:.2f} s, goal {goal:g} s ({split}), {solution.dofs} unknowns, "
        f"{solution.linear.method} {solution.linear.iterations} steps, {peak:.2f} GB"
    )


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    if len(sys.argv) > 1:
        print(measure(*GOALS[int(sys.argv[1])]), flush=True)
    else:
        for number in range(len(GOALS)):
            subprocess.run([sys.executable, __file__, str(number)], check=True)
