"""From a problem to its solution: background, structure, assembly, linear algebra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.background import Background, prepare
from solvers.block_assembly import BlockAssembler
from solvers.boundary import boundary_batches, outward
from solvers.data import require_finite
from solvers.equations.density import pull_back
from solvers.linear import LinearSolution
from solvers.linear import solve as solve_linear
from solvers.method import Method
from solvers.norms import with_mean
from solvers.problem import Datum, Dirichlet, Discretization, Problem, Robin, SolverOptions
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.smoothness import rough_cells
from solvers.solution import Solution, Spline, Trial
from solvers.stopwatch import Listener, Stopwatch
from solvers.trial import trial_structure
from solvers.web import SplineSpace
from structures.jet_matrix import stacked
from structures.operator import Operator

CHUNK = 150_000
"""Quadrature points evaluated at a time: keeps the working set of a chunk near 100 MB."""


def solve(
    problem: Problem,
    discretization: Discretization,
    method: Method,
    options: SolverOptions | None = None,
    listener: Listener | None = None,
) -> Solution:
    """Solve `problem` by `method`.

    Raises
    ------
    DataError
        A datum is not finite inside the domain.
    DiscretizationError
        The grid does not suit the shape.
    NumericsError
        The linear system could not be solved, or the data of a pure Neumann problem are incompatible.
    """
    options = options or SolverOptions()
    watch = Stopwatch(listener)
    background = prepare(problem.domain, discretization, watch)
    with watch.phase("assembly"):
        structure = (trial_structure(problem, discretization.weight),)
        spaces = (background.space,)
        assembler = BlockAssembler(spaces)
        Assembly(assembler, problem, method, structure, background).run(watch)
        matrix, load = assembler.finish()
    with watch.phase("solve"):
        singular = constants_are_free(problem)
        linear = minimise(matrix, load, options, singular)
        splines = tuple(
            Spline(background.grid, space.degree, full)
            for space, full in zip(spaces, assembler.split(linear.x), strict=True)
        )
    solution = Solution(problem, discretization, background, Trial(structure, splines), linear, watch.seconds)
    return with_mean(solution) if singular else solution


@dataclass(frozen=True)
class Assembly:
    """Adds the functional of a method over the domain and its natural boundary to an assembler."""

    assembler: BlockAssembler
    problem: Problem
    method: Method
    structure: tuple[Operator, ...]
    background: Background

    def run(self, watch: Stopwatch) -> None:
        """Add everything."""
        rules, folded = self.background.rules, self.background.folded
        total = len(rules.inner.cells) + len(rules.cut.cells)
        done = 0
        for batch in rules.inner.chunks(CHUNK):
            self.add_volume(batch)
            done += len(batch.cells)
            watch.advance(done, total)
        if folded is None:
            for piece in rules.cut.chunks(CHUNK):
                self.add_volume(piece)
        else:
            for fitted, where in cut_chunks(folded):
                rough = self.add_folded(fitted)
                for piece in rules.cut.take(where.start + np.flatnonzero(rough)).chunks(CHUNK):
                    self.add_volume(piece)
                watch.advance(done + where.stop, total)
        self.add_boundary()

    def add_volume(self, batch: TensorBatch | PointBatch) -> None:
        """Add the functional over `batch`, whose nodes all lie in the domain."""
        coords = batch.points(self.background.grid)
        density = self.method.volume(self.problem, coords)
        jet = stacked(self.structure, coords, self.method.order(self.problem))
        require_finite("solution structure", self.structure, coords, jet.offset)
        self.assembler.add(batch, *pull_back(density, jet, batch.weights))

    def add_folded(self, batch: TensorBatch) -> NDArray[np.bool_]:
        """Add the functional over the cut cells of a moment-fitted `batch`, except where it cannot be trusted.

        Its nodes fill the whole cell, so the formulas are also evaluated just outside the domain.  A cell is left
        out when they are not finite there or do not continue smoothly across the boundary, and where a spline has
        only a sliver of its support in the domain, so that negative weights could make its energy negative.

        Returns
        -------
        ndarray of bool
            The cells left out, whose fine rule has to be used instead.
        """
        coords = batch.points(self.background.grid)
        with np.errstate(all="ignore"):
            density = self.method.volume(self.problem, coords, check=False)
            jet = stacked(self.structure, coords, self.method.order(self.problem))
            blocks, loads = pull_back(density, jet, np.ones_like(batch.weights))
            rough = rough_cells([*blocks.values(), *loads.values()], batch.nodes, len(coords))
        rough |= delicate(self.assembler.spaces)[tuple(batch.cells.T)]
        for array in (*blocks.values(), *loads.values()):
            array *= batch.weights
            array[rough] = 0.0
        self.assembler.add(batch, blocks, loads)
        return rough

    def add_boundary(self) -> None:
        """Add the natural conditions."""
        grid = self.background.grid
        order = self.method.boundary_order(self.problem)
        for condition, batch in boundary_batches(self.problem, self.background.rules.boundary, grid):
            coords = batch.points(grid)
            spacing = float(np.max(grid.spacing))
            density = self.method.boundary(self.problem, condition, coords, outward(batch), spacing)
            if density is not None:
                jet = stacked(self.structure, coords, order)
                self.assembler.add(batch, *pull_back(density, jet, batch.weights))


def delicate(spaces: Sequence[SplineSpace]) -> NDArray[np.bool_]:
    """Cells on which some space has a spline with only a sliver of its support in the domain."""
    distinct = {id(space): space for space in spaces}.values()
    return np.asarray(np.logical_or.reduce([space.delicate_cells for space in distinct]))


def cut_chunks(folded: TensorBatch) -> Iterator[tuple[TensorBatch, slice]]:
    """Pieces of the folded rule together with the rows they come from."""
    step = max(1, CHUNK // folded.weights.shape[1])
    for start in range(0, len(folded.cells), step):
        where = slice(start, min(start + step, len(folded.cells)))
        yield folded.take(where), where


def has_essential(problem: Problem) -> bool:
    """Whether a Dirichlet condition is among the conditions."""
    return any(isinstance(condition, Dirichlet) for condition in problem.conditions)


def constants_are_free(problem: Problem) -> bool:
    """Whether adding a constant to u leaves the energy form unchanged (pure Neumann, no reaction)."""
    fixed = has_essential(problem) or not is_zero(problem.equation.reaction)
    return not fixed and all(
        is_zero(condition.coefficient) for condition in problem.conditions if isinstance(condition, Robin)
    )


def is_zero(datum: Datum) -> bool:
    """Whether `datum` is the number zero; a field counts as not zero."""
    return not callable(datum) and float(datum) == 0.0


def minimise(matrix: Any, load: Array, options: SolverOptions, singular: bool) -> LinearSolution:
    """Solve for the minimum; when constants are free, on their complement.

    Raises
    ------
    NumericsError
        Constants are free but the load does not vanish on them.
    """
    if not singular:
        return solve_linear(matrix, load, method=options.linear, tolerance=options.tolerance)
    imbalance = float(load.sum())
    if abs(imbalance) > 1e-6 * float(abs(load).sum()):
        raise NumericsError(
            "the problem has only flux conditions, and its data are incompatible: the integrals of the source "
            f"and of the boundary flux must add up to zero, but their sum is {imbalance:.6g}; correct them, or fix "
            "the solution somewhere with a Dirichlet or Robin condition"
        )
    one = np.ones(len(load))
    balanced = load - imbalance / len(load)
    return solve_linear(matrix, balanced, method=options.linear, tolerance=options.tolerance, null_space=one)
