r"""Ritz's method: the spline psi minimises the energy over all fields of the solution structure.

.. math:: E(u) = \int_\Omega W(\text{jet of } u)\,dx
          - \int_{\Gamma_N} g u\,ds + \int_{\Gamma_R} \bigl(\tfrac12 h u^2 - g u\bigr) ds,
          \qquad u = u_0 + B[\psi].

Essential conditions hold for every psi; natural ones hold at the minimum (Shapiro, Acta Numerica 2007,
section 7; Hoellig, *Finite Element Methods with B-Splines*, SIAM 2003, chapter 2).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.assembly import Assembler
from solvers.background import Background, prepare
from solvers.boundary import boundary_batches, natural_density, outward
from solvers.data import require_finite
from solvers.equations.density import pull_back
from solvers.grid import Grid
from solvers.linear import LinearSolution
from solvers.linear import solve as solve_linear
from solvers.norms import with_mean
from solvers.problem import Datum, Dirichlet, Discretization, Problem, Robin, SolverOptions
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.smoothness import rough_cells
from solvers.solution import Solution, Trial
from solvers.stopwatch import Listener, Stopwatch
from solvers.trial import trial_structure
from structures.jet_matrix import evaluate
from structures.operator import Operator

CHUNK = 150_000
"""Quadrature points evaluated at a time: keeps the working set of a chunk near 100 MB."""


def solve(
    problem: Problem,
    discretization: Discretization,
    options: SolverOptions | None = None,
    listener: Listener | None = None,
) -> Solution:
    """Solve `problem` by the Ritz method.

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
        structure = trial_structure(problem, discretization.weight)
        matrix, load = assemble(problem, structure, background, watch)
    with watch.phase("solve"):
        singular = constants_are_free(problem)
        linear = minimise(matrix, load, options, singular)
        full = background.space.full_coefficients(linear.x)
    trial = Trial(structure, background.grid, discretization.degree, full)
    solution = Solution(problem, discretization, background, trial, linear, watch.seconds)
    return with_mean(solution) if singular else solution


def has_essential(problem: Problem) -> bool:
    """Whether a Dirichlet condition is among the conditions."""
    return any(isinstance(condition, Dirichlet) for condition in problem.conditions)


def assemble(
    problem: Problem, structure: Operator, background: Background, watch: Stopwatch
) -> tuple[csr_array, Array]:
    """Matrix and load of the energy over the domain and its natural boundary."""
    assembler = Assembler(background.space)
    rules, folded, grid = background.rules, background.folded, background.grid
    total = len(rules.inner.cells) + len(rules.cut.cells)
    done = 0
    for batch in rules.inner.chunks(CHUNK):
        add_volume(assembler, problem, structure, grid, batch)
        done += len(batch.cells)
        watch.advance(done, total)
    if folded is None:
        for piece in rules.cut.chunks(CHUNK):
            add_volume(assembler, problem, structure, grid, piece)
    else:
        for batch, where in cut_chunks(folded):
            rough = add_folded(assembler, problem, structure, grid, batch)
            for piece in rules.cut.take(where.start + np.flatnonzero(rough)).chunks(CHUNK):
                add_volume(assembler, problem, structure, grid, piece)
            watch.advance(done + where.stop, total)
    for condition, face in boundary_batches(problem, rules.boundary, grid):
        if not isinstance(condition, Dirichlet):
            coords = face.points(grid)
            density = natural_density(problem, condition, coords, outward(face))
            assembler.add(face, *pull_back(density, evaluate(structure, coords, 0), face.weights))
    return assembler.finish()


def cut_chunks(folded: TensorBatch) -> Iterator[tuple[TensorBatch, slice]]:
    """Pieces of the folded rule together with the rows they come from."""
    step = max(1, CHUNK // folded.weights.shape[1])
    for start in range(0, len(folded.cells), step):
        where = slice(start, min(start + step, len(folded.cells)))
        yield folded.take(where), where


def add_volume(
    assembler: Assembler, problem: Problem, structure: Operator, grid: Grid, batch: TensorBatch | PointBatch
) -> None:
    """Add the energy over `batch`, whose nodes all lie in the domain."""
    coords = batch.points(grid)
    density = problem.equation.density(coords, problem.exact)
    jet = evaluate(structure, coords, problem.equation.order)
    require_finite("solution structure", structure, coords, jet.offset)
    assembler.add(batch, *pull_back(density, jet, batch.weights))


def add_folded(
    assembler: Assembler, problem: Problem, structure: Operator, grid: Grid, batch: TensorBatch
) -> NDArray[np.bool_]:
    """Add the energy over the cut cells of a moment-fitted `batch`, except where that cannot be trusted.

    Its nodes fill the whole cell, so the formulas are also evaluated just outside the domain.  A cell is left out
    when they are not finite there or do not continue smoothly across the boundary.

    Returns
    -------
    ndarray of bool
        The cells left out, whose fine rule has to be used instead.
    """
    coords = batch.points(grid)
    with np.errstate(all="ignore"):
        density = problem.equation.density(coords, problem.exact, check=False)
        jet = evaluate(structure, coords, problem.equation.order)
        blocks, loads = pull_back(density, jet, np.ones_like(batch.weights))
        rough = rough_cells([*blocks.values(), *loads.values()], batch.nodes, len(coords))
    # where a spline has only a sliver of its support in the domain, negative weights could make its energy negative
    rough |= assembler.space.delicate_cells[tuple(batch.cells.T)]
    for array in (*blocks.values(), *loads.values()):
        array *= batch.weights
        array[rough] = 0.0
    assembler.add(batch, blocks, loads)
    return rough


def constants_are_free(problem: Problem) -> bool:
    """Whether adding a constant to u leaves the energy form unchanged (pure Neumann, no reaction)."""
    fixed = has_essential(problem) or not is_zero(problem.equation.reaction)
    return not fixed and all(
        is_zero(condition.coefficient) for condition in problem.conditions if isinstance(condition, Robin)
    )


def is_zero(datum: Datum) -> bool:
    """Whether `datum` is the number zero; a field counts as not zero."""
    return not callable(datum) and float(datum) == 0.0


def minimise(matrix: csr_array, load: Array, options: SolverOptions, singular: bool) -> LinearSolution:
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
            "the problem has only flux conditions, and its data are incompatible: the integrals of the source and "
            f"of the boundary flux must add up to zero, but their sum is {imbalance:.6g}; correct them, or fix the "
            "solution somewhere with a Dirichlet or Robin condition"
        )
    one = np.ones(len(load))
    balanced = load - imbalance / len(load)
    return solve_linear(matrix, balanced, method=options.linear, tolerance=options.tolerance, null_space=one)
