"""From a problem to its solution: background, structure, assembly, linear algebra."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.background import Background, prepare
from solvers.bases.basis import Space
from solvers.block_assembly import BlockAssembler
from solvers.boundary import boundary_batches, outward
from solvers.corners.rules import all_rules
from solvers.corners.setting import settled
from solvers.corners.space import CornerSpace
from solvers.data import require_finite
from solvers.device.backend import NONE
from solvers.device.processes import telling
from solvers.equations.density import Blocks, Density, Loads
from solvers.flux_conditions import has_flux
from solvers.kernel import excess, kernel_of
from solvers.linear.bordered import solve_bordered
from solvers.linear.system import Indefinite
from solvers.materials import materials_setting
from solvers.method import Method, require
from solvers.modes import mode_of
from solvers.node_order import by_cell, ordered_points, ordered_weights
from solvers.periodicity import fitted, periods_of, wraps_of
from solvers.posed import require_posed
from solvers.problem import Discretization, Problem, SolverOptions
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.setting import Region, Setting
from solvers.sharing import shared
from solvers.smoothness import rough_cells
from solvers.solution import Piece, Solution, Trial
from solvers.stopwatch import Listener, Stopwatch
from solvers.systems import EnergySystem
from solvers.threads import ahead, on_one_thread
from structures.jet_matrix import JetMatrix, stacked
from structures.operator import Operator

CHUNK = 150_000
"""Quadrature points evaluated at a time: keeps the working set of a chunk near 100 MB."""
TABLE = 1_000_000
"""Values of corner functions tabulated at a time."""

UNFITTED = (
    "moment fitting was turned off: with negative weights in cut cells the matrix was not positive definite; a finer "
    "grid or a lower degree is faster"
)
PIVOTED = 6000
"""Unknowns up to which fields of several materials, which nearly depend on each other, get a pivoted factorisation."""


@on_one_thread
def solve(
    problem: Problem,
    discretization: Discretization,
    method: Method,
    options: SolverOptions | None = None,
    listener: Listener | None = None,
) -> Solution:
    """Solve `problem` by `method`.

    Where moment-fitted weights, some of which are negative, spoil the matrix, all cut cells get their own positive
    rules.

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
    require_posed(problem)
    require(method, problem, discretization, options)
    discretization = settled(discretization, method.name, options, problem)
    watch = Stopwatch(listener)
    with telling(options.device):
        try:
            return _solved(problem, discretization, method, options, watch)
        except Indefinite:
            if not discretization.moment_fitting:
                raise
        unfitted = replace(discretization, moment_fitting=False)
        return replace(_solved(problem, unfitted, method, options, watch), notes=(UNFITTED,))


def _solved(
    problem: Problem, discretization: Discretization, method: Method, options: SolverOptions, watch: Stopwatch
) -> Solution:
    """One solve with the rules as they are asked for."""
    mode = mode_of(discretization)
    periods = periods_of(problem)
    prepared = mode.quadrature(problem, fitted(discretization, problem.domain, periods))
    background = prepare(
        problem.domain, prepared, watch, wraps_of(periods), sharing=partial(shared, options=options)
    )
    with watch.phase("assembly"):
        setting = (materials_setting if problem.inclusions else mode.setting)(
            problem, discretization, background
        )
        assembler = assembler_of(setting, method.symmetric(problem), options)
        assembly = Assembly(assembler, problem, method, setting.structure, background, setting.regions)
        system = method.system(assembly, watch)
    with watch.phase("solve"):
        kernel = kernel_of(problem, background, setting.spaces)
        options = assembler.options(options)
        if setting.sides and sum(space.n_dofs for space in setting.spaces) <= PIVOTED:
            options = replace(options, redundant=True)
        if setting.corners is not None and isinstance(system, EnergySystem):
            linear = solve_bordered(system.matrix, system.load, setting.corners.n_dofs, options)
        elif setting.overlapping and kernel is None and isinstance(system, EnergySystem):
            linear = system.solve_reporting(options, problem.domain.dimension)
        else:
            linear = system.solve(options, kernel)
        trial = Trial(setting.structure, assembler.functions(linear.x), setting.sides)
        if kernel is not None:
            pieces = pieces_of(problem, trial, background, setting)
            fixed = linear.x - kernel.vectors @ excess(pieces, kernel)
            trial = replace(trial, splines=assembler.functions(fixed))
    pieces = pieces_of(problem, trial, background, setting)
    found = () if setting.corners is None else setting.corners.intensities(trial.splines[-1].coefficients)
    return Solution(
        problem, discretization, background, trial, linear, watch.seconds, pieces, intensities=found
    )


def pieces_of(problem: Problem, trial: Trial, background: Background, setting: Setting) -> tuple[Piece, ...]:
    """The materials of a solution and their interfaces."""
    if not setting.sides:
        if setting.corners is not None:
            background = all_rules(*(region.background for region in setting.regions))
        return (Piece(problem, trial, background),)
    return tuple(
        Piece(r.problem or problem, trial.within(r.structure), r.background) for r in setting.regions
    )


def assembler_of(setting: Setting, symmetric: bool, options: SolverOptions) -> BlockAssembler:
    """What sums the functional: a matrix, or the cells of one that a device applies."""
    if options.device == NONE:
        return BlockAssembler(setting.spaces, symmetric)
    from solvers.device.assembler import MatrixFreeAssembler

    return MatrixFreeAssembler(setting.spaces, options.device, setting.regions[0].background.sharing)


@dataclass(frozen=True)
class Assembly:
    """Adds the functional of a method over the domain and its natural boundary to an assembler."""

    assembler: BlockAssembler
    problem: Problem
    method: Method
    structure: tuple[Operator, ...]
    background: Background
    regions: tuple[Region, ...] = ()
    """Parts of the domain with a structure and rules of their own; by default all is one."""

    def run(self, watch: Stopwatch) -> tuple[Any, Array]:
        """Add everything; return the matrix and the load."""
        for part in self.parts():
            part.add_region(watch)
        return self.assembler.finish()

    def parts(self) -> list[Assembly]:
        """Return the same for each region."""
        regions = self.regions or (Region(self.structure, self.background),)
        return [
            replace(
                self,
                problem=r.problem or self.problem,
                structure=r.structure,
                background=r.background,
                regions=(),
            )
            for r in regions
        ]

    def add_region(self, watch: Stopwatch) -> None:
        """Add the functional over the rules of the background."""
        rules, folded = self.background.rules, self.background.folded
        total = len(rules.inner.cells) + len(rules.cut.cells)
        done = 0
        size = chunk_of(self.assembler.spaces)
        for batch, found in ahead(self.volume, rules.inner.chunks(size)):
            self.assembler.add(batch, *found)
            done += len(batch.cells)
            watch.advance(done, total)
        rest: Iterable[PointBatch] = rules.cut.chunks(size)
        if folded is not None:
            left_out = [np.zeros(0, dtype=bool)]
            for fitted, (blocks, loads, rough_ones) in ahead(self.folded, folded.chunks(size)):
                self.assembler.add(fitted, blocks, loads)
                left_out.append(rough_ones)
                done += len(fitted.cells)
                watch.advance(done, total)
            rest = rules.cut.take(np.flatnonzero(np.concatenate(left_out))).chunks(size)
        for piece, found in ahead(self.volume, rest):
            self.assembler.add(piece, *found)
        self.add_boundary()

    def volume(self, batch: TensorBatch | PointBatch) -> tuple[Blocks, Loads]:
        """Blocks and loads of the functional at the points of `batch`, which all lie in the domain."""
        coords = ordered_points(batch, self.background.grid)
        density = self.method.volume(self.problem, coords)
        jet = stacked(self.structure, coords, self.method.order(self.problem))
        require_finite("solution structure", self.structure, coords, jet.offset)
        blocks, loads = density.pull_back(jet, ordered_weights(batch))
        return by_cell(batch, blocks), by_cell(batch, loads)

    def folded(self, batch: TensorBatch) -> tuple[Blocks, Loads, NDArray[np.bool_]]:
        """Blocks and loads over the cut cells of a moment-fitted `batch`, zero where they cannot be trusted.

        Its nodes fill the whole cell, so the formulas are also evaluated just outside the domain.  A cell is left
        out when they are not finite there or do not continue smoothly across the boundary, and where a spline has
        only a sliver of its support in the domain, so that negative weights could make its energy negative.

        Returns
        -------
        tuple
            Blocks, loads, and the cells left out, whose fine rule has to be used instead.
        """
        coords = ordered_points(batch, self.background.grid)
        with np.errstate(all="ignore"):
            density = self.method.volume(self.problem, coords, check=False)
            jet = stacked(self.structure, coords, self.method.order(self.problem))
            blocks, loads = density.pull_back(jet, 1.0)
        shape = (-1, len(batch))
        found = {id(array): array.reshape(shape) for array in (*blocks.values(), *loads.values())}
        rough = rough_cells(list(found.values()), batch.nodes, len(coords))
        rough |= delicate(self.assembler.spaces)[tuple(batch.cells.T)]
        weights = ordered_weights(batch).reshape(shape)
        weighted = {name: array * weights for name, array in found.items()}
        if rough.any():
            for array in weighted.values():
                array[:, rough] = 0.0
        return (
            {key: weighted[id(array)].T for key, array in blocks.items()},
            {key: weighted[id(array)].T for key, array in loads.items()},
            rough,
        )

    def add_boundary(self) -> None:
        """Add the natural conditions."""
        for batch, density, jet in self.boundary_densities():
            self.assembler.add(batch, *density.pull_back(jet, batch.weights))

    def boundary_densities(self) -> Iterator[tuple[PointBatch, Density, JetMatrix]]:
        """Rule, density and jet matrix of each natural condition on each surface."""
        grid = self.background.grid
        order = self.method.boundary_order(self.problem)
        spacing = float(np.max(grid.spacing))
        natural = replace(self.problem, conditions=tuple(filter(has_flux, self.problem.conditions)))
        for condition, batch in boundary_batches(natural, self.background.rules.boundary, grid):
            coords = batch.points(grid)
            density = self.method.boundary(self.problem, condition, coords, outward(batch), spacing)
            if density is not None:
                yield batch, density, stacked(self.structure, coords, order)


def delicate(spaces: Sequence[Space]) -> NDArray[np.bool_]:
    """Cells on which some space has a spline with only a sliver of its support in the domain."""
    distinct = {id(space): space for space in spaces}.values()
    return np.asarray(np.logical_or.reduce([space.delicate_cells for space in distinct]))


def chunk_of(spaces: Sequence[Space]) -> int:
    """Points to take at a time: fewer where functions that live on all cells are tabulated at each."""
    everywhere = sum(space.n_dofs for space in spaces if isinstance(space, CornerSpace))
    return min(CHUNK, TABLE // everywhere) if everywhere else CHUNK
