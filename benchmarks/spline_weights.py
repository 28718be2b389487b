"""Orders of WEB-splines with spline R-functions as weights, down to h = 2^-8: the tables of docs/spline-r-functions.md.

The lens of two unit disks and their union, u = w g with the weight w of the run and a smooth g, load in the weak form;
and Example 4.1 of the paper on spline R-functions, one solution for all weights: the annulus of radii 0.1 and 0.4 about
(1/2, 1/2), u = sin((0.16 - rho)(0.01 - rho)), rho the squared distance from the centre.
Run it as ``python benchmarks/spline_weights.py [finest]``; the finest spacing is 2^-finest, 8 when absent.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np

from rfm.calculus import Value, derivatives, exp, sin
from rfm.geometry import disk
from rfm.geometry.shape import Shape
from rfm.geometry.weight import weight as weight_of
from solvers import ritz
from solvers.equations.energy import Energy
from solvers.equations.poisson import Poisson
from solvers.exact import required
from solvers.norms import error_norms
from solvers.problem import Dirichlet, Discretization, Problem

WEIGHTS = ("spline{k}", "r0", "auto")


def example(x: Value, y: Value) -> Value:
    """Exact solution of Example 4.1."""
    rho = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return sin((0.16 - rho) * (0.01 - rho))


def example_problem(domain: Shape, weight: str) -> Problem:
    """Example 4.1: Poisson's equation with the source of the exact solution."""
    return Problem(domain, Poisson(source=None), (Dirichlet(domain.part("all"), 0.0),), example)


def problem_of(domain: Shape, weight: str) -> Problem:
    """Poisson's equation with the exact solution w g, w the weight of a name."""
    w = weight_of(domain, domain.part("all"), weight)

    def exact(x: Value, y: Value) -> Value:
        return w(x, y) * exp(0.5 * x) * sin(2 * y + x + 1)

    last: dict[str, Value] = {"x": None}

    def density(x: Value, y: Value, u: Value) -> Value:
        if last["x"] is not x:  # the density is asked for several u at the same points
            last.update(x=x, slopes=derivatives(exact, (x, y), 1)[1:])
        along, across = last["slopes"]
        return 0.5 * (u.x * u.x + u.y * u.y) - along * u.x - across * u.y

    return Problem(domain, Energy(density), (Dirichlet(domain.part("all"), 0.0),), exact)


def main() -> None:
    """Print one table for each domain."""
    finest = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    one, other = disk((0, 0), 1.0), disk((0.8, 0), 1.0)
    annulus = disk((0.5, 0.5), 0.4) - disk((0.5, 0.5), 0.1)
    series("lens", one & other, problem_of, range(1, finest + 1))
    series("union", one | other, problem_of, range(1, finest + 1))
    series("annulus, Example 4.1", annulus, example_problem, range(3, finest + 1))


def series(name: str, domain: Shape, problem: Callable[[Shape, str], Problem], exponents: range) -> None:
    """Print the table of one domain."""
    print(f"\n| {name}, weight | k | " + " | ".join(f"2^-{n}" for n in exponents) + " | order |")
    print("|---" * (len(exponents) + 3) + "|", flush=True)
    for k in (1, 2, 3):
        for weight in WEIGHTS:
            chosen = weight.format(k=k)
            stated = problem(domain, chosen)
            errors = []
            for n in exponents:
                how = Discretization(degree=k, spacing=0.5**n, weight=chosen)
                solution = ritz.solve(stated, how)
                errors.append(error_norms(solution.trial, required(stated.exact), solution.background).l2)
            order = np.log2(errors[-2] / errors[-1])
            row = " | ".join(f"{e:.1e}" for e in errors)
            print(f"| `{chosen}` | {k} | {row} | {order:.2f} |", flush=True)


if __name__ == "__main__":
    main()
