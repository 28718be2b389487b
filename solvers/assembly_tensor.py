r"""Element integrals on tensor nodes by sum factorisation.

On a cell with the nodes :math:`t_{k_1}, \dots, t_{k_d}` an element matrix (or load) is

.. math:: K_{e_1 \dots e_d} = \sum_{\text{terms}} \sum_{k_1 \dots k_d} C_{k_1 \dots k_d} \prod_\nu D^{\nu}_{e_\nu k_\nu}

with the coefficients C, weights included, and the constant tables D of :mod:`solvers.assembly_parity`. The directions
are summed one after the other. Terms that agree in the tables still to come are added on the way: their nodes are
stacked, so that one matrix product contracts and adds (for Poisson in 3D, seven terms need five products in the
second direction and three in the last, the most expensive one). The cells run fastest in memory: every
product is a small constant matrix times a long one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import prod

import numpy as np

from rfm.calculus.types import Array
from solvers.assembly_parity import Form, Key, Kind, Kinds, Sources


@dataclass(frozen=True)
class Leaf:
    """Coefficients at the nodes: a sum of the caller's arrays."""

    sources: Sources

    def fill(self, blocks: Mapping[Key, Array], out: Array, work: list[Array]) -> None:
        """Write the sum, nodes first and cells last, to `out`."""
        target = out.reshape(-1, next(iter(blocks.values())).shape[0])
        for number, (key, factor) in enumerate(self.sources):
            if number == 0:
                np.multiply(blocks[key].T, factor, out=target)
            else:
                target += factor * blocks[key].T


@dataclass(frozen=True)
class Contraction:
    """Sum over the nodes of one direction, and over the terms that agree in the directions to come.

    Attributes
    ----------
    level
        The direction.
    lead
        Entries of the directions already summed.
    stacked
        Tables of the terms side by side, shape (entries, terms * m).
    children
        What is to be contracted with each table.
    """

    level: int
    lead: int
    stacked: Array
    children: tuple[Leaf | Contraction, ...]

    def fill(self, blocks: Mapping[Key, Array], out: Array, work: list[Array]) -> None:
        """Write the contraction to `out`, shape (lead * entries, rest)."""
        rest = out.shape[-1]
        rows, depth = self.stacked.shape
        buffer = _view(work, self.level, (self.lead, len(self.children), depth // len(self.children) * rest))
        for number, child in enumerate(self.children):
            child.fill(blocks, buffer[:, number], work)
        np.matmul(
            self.stacked, buffer.reshape(self.lead, depth, rest), out=out.reshape(self.lead, rows, rest)
        )


@dataclass(frozen=True)
class TensorPlan:
    """All contractions of a form for given nodes."""

    root: Contraction
    rows: int

    def run(self, blocks: Mapping[Key, Array], cells: int, work: list[Array]) -> Array:
        """Elements of a chunk of cells, shape (entries, cells); overwritten by the next run with the same `work`."""
        out = _view(work, len(work) - 1, (self.rows, cells))
        self.root.fill(blocks, out, work)
        return out


def plan(form: Form, table: Callable[[Kind], Array]) -> TensorPlan:
    """Contractions of `form` with tables (m, entries) of its kinds at the m nodes of a direction."""
    kinds = form.terms[0][0]
    dimension = len(kinds)
    counts = [table(kind).shape[1] for kind in kinds]

    def node(suffix: Kinds, level: int) -> Leaf | Contraction:
        """Everything whose tables from direction `level` on are `suffix`."""
        matching = [term for term in form.terms if term[0][level:] == suffix]
        if level == 0:
            return Leaf(matching[0][1])
        heads = sorted({kinds[level - 1] for kinds, _ in matching})
        stacked = np.concatenate([table(head).T for head in heads], axis=1)
        children = tuple(node((head, *suffix), level - 1) for head in heads)
        return Contraction(level - 1, prod(counts[: level - 1]), np.ascontiguousarray(stacked), children)

    root = node((), dimension)
    if not isinstance(root, Contraction):
        raise ValueError("a form needs at least one direction")
    return TensorPlan(root, prod(counts))


def workspace(dimension: int) -> list[Array]:
    """Empty work arrays: one a direction and one for the result; they grow on demand and are used again."""
    return [np.empty(0) for _ in range(dimension + 1)]


def _view(work: list[Array], slot: int, shape: tuple[int, ...]) -> Array:
    """Array of the given shape in a work array."""
    size = prod(shape)
    if work[slot].size < size:
        work[slot] = np.empty(size)
    return work[slot][:size].reshape(shape)
