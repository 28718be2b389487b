r"""Collocation: the strong residual at points, more of them than unknowns, solved in the mean by a QR factorisation.

The points are :math:`\max(2, p - 1)` Gauss points a direction in the inner cells, where least squares takes p + 1; in
the cells that the boundary cuts and on parts with natural conditions they are the points of the positive rules.  On
smooth splines so few points keep the order of least squares, while as many Greville points as unknowns lose one or
two (Anitescu, Jia, Zhang, Rabczuk, CMAME 284, 2015; Montardini, Sangalli, Tamellini, CMAME 317, 2017).  Each equation
has the weight of its point.  In cut cells these weights matter: with plain Gauss points of the whole cell, those
outside left out, the error under natural conditions jumps by a factor of ten from grid to grid.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from solvers.background import Background
from solvers.least_squares import energy_load
from solvers.pipeline import Assembly
from solvers.problem import Problem
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.quadrature.tensor import inner_rule
from solvers.row_assembly import CHUNK, RowAssembler
from solvers.stopwatch import Stopwatch
from solvers.strong_residuals import StrongResiduals
from solvers.systems import RowsSystem
from structures.jet_matrix import stacked


@dataclass(frozen=True)
class Collocation(StrongResiduals):
    """Strong residuals at more points than unknowns, as small as possible, see :class:`solvers.method.Method`.

    Attributes
    ----------
    points
        Gauss points a direction in an inner cell outside of collars; chosen by the degree when None.
    """

    points: int | None = None
    name: str = "collocation"

    def linear_solvers(self, problem: Problem) -> tuple[str, ...]:
        """There are only rows."""
        return ("qr",)

    def system(self, assembly: Assembly, watch: Stopwatch) -> RowsSystem:
        """Rows at the points of the domain and of its boundary."""
        rows = RowAssembler(assembly.assembler.spaces)
        degree, full = assembly.assembler.spaces[0].degree, len(assembly.background.rules.inner.nodes)
        few = full if assembly.problem.inclusions else min(max(2, degree - 1), full)  # twice as many unknowns
        count = self.points or few
        for part in assembly.parts():
            problem = part.problem
            finer = len(part.background.rules.inner.nodes)  # of a collar, whose integrands are steep
            for batch in point_batches(part.background, count if finer == full else finer):
                coords = batch.points(part.background.grid)
                jet = stacked(part.structure, coords, self.order(problem))
                rows.add_density(batch, self.volume(problem, coords), jet)
            for piece, density, jet in part.boundary_densities():
                rows.add_density(piece, density, jet)
        return RowsSystem(rows.finish(), partial(energy_load, assembly, watch))


def point_batches(background: Background, count: int) -> Iterator[TensorBatch | PointBatch]:
    """Gauss points of the inner cells, `count` a direction, and the points of the rules of the cut cells."""
    rules = background.rules
    yield from inner_rule(background.grid, rules.inner.cells, count).chunks(CHUNK)
    yield from rules.cut.chunks(CHUNK)
