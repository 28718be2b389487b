r"""What devices exchange for one step of conjugate gradients: a model, and counts of the compiled program beside it.

The model knows the grid, the degree and the cuts, not the lists of :mod:`solvers.device.halo`:

- exchanges: one for each face, edge and corner of a box that has a box beyond it, before a product and after it;
- numbers in them: the p layers of indices beyond a face of n cells, about ``p n``, times the components;
- sums over all boxes: two, of two numbers and of one.

A domain that does not fill its grid exchanges less across a cut, and something more where outer splines follow from
arrays of inner ones on the other side.

Usage: python benchmarks/scaling.py [boxes] prints both for a ball, with virtual devices of a processor.
"""

from __future__ import annotations

import os
import re
import sys
from dataclasses import dataclass
from functools import partial
from itertools import pairwise, product
from math import prod
from typing import Any

import numpy as np

from rfm.geometry import ball, box
from rfm.geometry.shape import Shape
from solvers import pipeline
from solvers.device.backend import computing
from solvers.device.blocks import Blocks, whole
from solvers.device.conjugate_gradients import Loop, iterate
from solvers.device.mesh import mapped
from solvers.device.operator import Operator
from solvers.equations.poisson import Poisson
from solvers.problem import Dirichlet, Discretization, Problem, SolverOptions
from solvers.ritz import Ritz
from solvers.sharing import shared
from solvers.stopwatch import Stopwatch

NUMBER = 8
"""Bytes of a number."""
SHAPES = re.compile(r"= \(?((?:\w+\[[\d,]*\][^ ]* ?,? ?)+)\)? (collective-permute|all-reduce)(?:-start)?\(")


@dataclass(frozen=True)
class Traffic:
    """What is exchanged for one step.

    Attributes
    ----------
    messages
        Exchanges between boxes, in each of which a box sends one message at most.
    numbers
        Numbers in them for which a box has room.
    sums, summed
        Sums over all boxes, and the numbers in them.
    """

    messages: int
    numbers: int
    sums: int
    summed: int


def predicted(blocks: Blocks, degree: int, components: int = 1) -> Traffic:
    """Traffic where the domain fills the grid: then nothing is extended, and the program exchanges just this.

    A box needs the ``p`` layers of indices beyond its upper faces, edges and corner.  As all boxes run one program,
    each exchange has the room of the largest.
    """
    widths = [
        [high - low for low, high in pairwise(border[:-1])] + [border[-1] - border[-2] + degree]
        for border in blocks.borders
    ]
    steps = [s for s in product(*([0, 1][: len(w)] for w in widths)) if any(s)]
    room = 0
    for step in steps:
        # the box that has most: stepping needs a next box, so the last one of a direction does not count
        most = [degree if up else max(width) for up, width in zip(step, widths, strict=True)]
        room += prod(most)
    return Traffic(2 * len(steps), 2 * components * room, 2, 3)


def counted(program: str) -> Traffic:
    """Traffic in the text of a compiled program, each exchange with the room it reserves."""
    found: dict[str, list[int]] = {"collective-permute": [], "all-reduce": []}
    for shapes, name in SHAPES.findall(program):
        sizes = [
            prod(map(int, filter(None, size.split(",")))) for size in re.findall(r"f64\[([\d,]*)\]", shapes)
        ]
        found[name].append(max(sizes))
    moves, sums = found["collective-permute"], found["all-reduce"]
    return Traffic(len(moves), sum(moves), len(sums), sum(sums))


def text_of(operator: Operator, load: Any) -> str:
    """Compiled program of conjugate gradients."""
    import jax

    with computing(operator.kind):
        vectors = {
            "scale": operator.spread(load, 1.0),
            "null": operator.spread(np.zeros((len(load), 0))),
            "right": operator.spread(load),
        }
        given = (operator.mesh, Loop(operator.plan, 10), operator.arrays, vectors, operator.everywhere(1.0))
        program = jax.jit(mapped, static_argnums=(0, 1, 2)).lower(iterate, *given)
        return str(program.compile().as_text())


def row(shape: Shape, degree: int, grid: int, count: int) -> str:
    """Row of the table: boxes, unknowns, traffic of the model and of the program, and how even the work is."""
    problem = Problem(shape, Poisson(source=1.0), (Dirichlet(shape.part("all")),))
    options = SolverOptions(device="cpu", shards=count)
    discretization = Discretization(degree=degree, grid=grid)
    operator, load, blocks = system(problem, discretization, options)
    found, model = counted(text_of(operator, load)), predicted(blocks, degree)
    work, real = np.zeros(count), 0.0
    for group in operator.arrays["groups"]:
        coefficients = np.asarray(group["chunks"]["coefficients"])
        work += np.asarray(group["used"]) * np.prod(coefficients.shape[3:])
        real += coefficients.shape[3] * np.count_nonzero(np.any(coefficients != 0, axis=(2, 3)))
    pairs = ((model.messages, found.messages), (model.numbers * NUMBER, found.numbers * NUMBER))
    columns = [shape.parts[0], degree, grid, len(load), blocks.shown()]
    columns += [f"{one}, {other}" for one, other in (*pairs, (model.sums, found.sums))]
    return " | ".join(map(str, [*columns, f"{real / (count * np.max(work)):.2f}"]))


def system(
    problem: Problem, discretization: Discretization, options: SolverOptions
) -> tuple[Operator, Any, Blocks]:
    """Operator and load of an energy, and the boxes."""
    watch = Stopwatch(None)
    mode = pipeline.mode_of(discretization)
    background = pipeline.prepare(
        problem.domain,
        mode.quadrature(problem, discretization),
        watch,
        sharing=partial(shared, options=options),
    )
    setting = mode.setting(problem, discretization, background)
    assembler = pipeline.assembler_of(setting, True, options)
    operator, load = pipeline.Assembly(
        assembler, problem, Ritz(), setting.structure, background, setting.regions
    ).run(watch)
    return operator, load, background.sharing.blocks or whole(background.grid.shape)


def main(counts: list[int]) -> None:
    """Print a table for a box and for a ball."""
    print("shape | p | grid | unknowns | boxes | exchanges: model, program | bytes | sums | mean work / most")
    full = box(min=(0, 0, 0), max=(1, 1, 1)).named("box")
    for shape in (full, ball(center=(0, 0, 0), radius=1).named("ball")):
        for degree, grid in ((2, 24), (3, 32)):
            for count in counts:
                print(row(shape, degree, grid, count))


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]] or [2, 8, 27, 64]
    os.environ["XLA_FLAGS"] = f"--xla_force_host_platform_device_count={max(numbers)}"
    main(numbers)
