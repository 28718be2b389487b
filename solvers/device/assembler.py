"""Collects the cells of an energy for :class:`solvers.device.operator.Operator`; the load is summed as ever."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.assembly import Assembler
from solvers.assembly_folding import parts
from solvers.assembly_reduction import reduce_load
from solvers.bases.basis import Space
from solvers.block_assembly import BlockAssembler
from solvers.device.blocks import whole
from solvers.device.cells import Groups, Key
from solvers.device.operator import Operator
from solvers.equations.density import Blocks, Loads
from solvers.quadrature.batch import PointBatch, TensorBatch
from solvers.quadrature.pieces import gauss
from solvers.sharing import Sharing
from solvers.smoothness import legendre_transform
from solvers.web import SplineSpace


class MatrixFreeAssembler(BlockAssembler):
    """Keeps the coefficients of a symmetric form at the nodes, instead of its matrix.

    Parameters
    ----------
    spaces
        The space of all splines, once for each of them.
    kind
        Where to compute: ``cpu`` or ``gpu``.
    sharing
        The boxes of cells, one for each device, and the processes that have them.

    Raises
    ------
    DiscretizationError
        The spaces are not one space of splines.
    """

    def __init__(self, spaces: Sequence[Space], kind: str, sharing: Sharing) -> None:
        super().__init__(spaces)
        space = spaces[0]
        if not isinstance(space, SplineSpace) or any(other is not space for other in spaces):
            raise DiscretizationError(f"device: {kind} needs one space of splines for all components")
        blocks = sharing.blocks or whole(space.grid.shape)
        self.kind, self.team, self.groups = kind, sharing.team, Groups(space, len(spaces), blocks)
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
                self.groups.add(where, *thinned(nodes, quadratic, 2 * space.degree + 1, space.grid.dimension))
            cells = np.asarray(where, dtype=np.int64)
            kind = TensorBatch if nodes.ndim == 1 else PointBatch
            for m, assembler in enumerate(self._loads):
                own = {alpha: values for (k, alpha), values in linear.items() if k == m}
                if own:
                    assembler.add(kind(cells, nodes, next(iter(own.values()))), {}, own)

    def finish(self) -> tuple[Operator, Array]:
        """Operator and load of all unknowns."""
        operator = Operator(self.groups, self.kind, self.team)
        load = np.concatenate(
            [reduce_load(assembler.load, assembler.space.free) for assembler in self._loads]
        )
        return operator, self.team.total(load)


def thinned(
    nodes: Array, blocks: Mapping[Key, Array], enough: int, dimension: int
) -> tuple[Array, dict[Key, Array]]:
    r"""Coefficients on `enough` Gauss nodes a direction, where there are more tensor nodes.

    Products of two splines are polynomials of degree ``enough - 1`` in each direction, hence equal to their
    interpolants there: :math:`C_k = \sum_j C_j L_k(t_j)` leaves every integral what it is
    (:mod:`solvers.assembly_folding`).
    """
    if nodes.ndim != 1 or len(nodes) <= enough:
        return nodes, dict(blocks)
    values = np.polynomial.legendre.legvander(2 * nodes - 1, enough - 1)
    lagrange = values * np.sqrt(2 * np.arange(enough) + 1) @ legendre_transform(enough)
    found = {}
    for key, block in blocks.items():
        moments = block.reshape(-1, *[len(nodes)] * dimension)
        for _ in range(dimension):
            moments = np.tensordot(moments, lagrange, axes=(1, 0))
        found[key] = moments.reshape(len(block), -1)
    return gauss(enough)[0], found
