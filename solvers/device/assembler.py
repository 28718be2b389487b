"""Collects the cells of an energy for :class:`solvers.device.operator.Operator`; the load is summed as ever."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.assembly import Assembler
from solvers.assembly_folding import parts
from solvers.assembly_reduction import reduce_load
from solvers.bases.basis import Space
from solvers.block_assembly import BlockAssembler
from solvers.device.cells import Groups
from solvers.device.operator import Operator
from solvers.equations.density import Blocks, Loads
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.web import SplineSpace


class MatrixFreeAssembler(BlockAssembler):
    """Keeps the coefficients of a symmetric form at the nodes, instead of its matrix.

    Parameters
    ----------
    spaces
        The space of all splines, once for each of them.
    kind
        Where to compute: ``cpu`` or ``gpu``.

    Raises
    ------
    DiscretizationError
        The spaces are not one space of splines.
    """

    def __init__(self, spaces: Sequence[Space], kind: str) -> None:
        super().__init__(spaces)
        space = spaces[0]
        if not isinstance(space, SplineSpace) or any(other is not space for other in spaces):
            raise DiscretizationError(f"device: {kind} needs one space of splines for all components")
        self.kind, self.groups = kind, Groups(space, len(spaces))
        self._loads = [Assembler(space) for _ in spaces]

    def add(self, batch: TensorBatch | PointBatch, blocks: Blocks, loads: Loads) -> None:
        """Add the integrals over `batch`; see :func:`solvers.equations.density.pull_back` for the keys."""
        if not len(batch.cells):
            return
        space = self.groups.space
        for where, nodes, quadratic, linear in parts(
            batch, blocks, loads, space.delicate_cells, 2 * space.degree
        ):
            if quadratic:
                self.groups.add(where, nodes, quadratic)
            cells = np.asarray(where, dtype=np.int64)
            kind = TensorBatch if nodes.ndim == 1 else PointBatch
            for m, assembler in enumerate(self._loads):
                own = {alpha: values for (k, alpha), values in linear.items() if k == m}
                if own:
                    assembler.add(kind(cells, nodes, next(iter(own.values()))), {}, own)

    def finish(self) -> tuple[Operator, Array]:
        """Operator and load of all unknowns."""
        load = np.concatenate(
            [reduce_load(assembler.load, assembler.space.free) for assembler in self._loads]
        )
        return Operator(self.groups, self.kind), load
