r"""Which unknowns a box of cells needs from others, and their exchange.

With :math:`R_s` taking from all unknowns those that the cells of box s see, the matrix is a sum over boxes,

.. math:: A = \sum_s R_s^T A_s R_s, \qquad A_s = E_s \Bigl(\sum_{G} \Pi_G^T T_G^T C_G T_G \Pi_G\Bigr) E_s^T

(:mod:`solvers.device.operator`).  A box holds the unknowns of its indices and needs those of the p layers of indices
beyond its cells, and of the arrays of inner indices that outer ones follow from.  What is needed is listed, so it may
lie any number of boxes away, or beyond the seam of a periodic grid.

A *link* of offset o joins each box s with the box s + o (modulo their number): unknowns go from s + o to s before a
product, sums go back after it.  Lists of one link have one length in all boxes, shorter ones are padded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.types import Array
from solvers.device.blocks import Blocks
from solvers.web import SplineSpace

AXIS = "boxes"
"""Name of the axis along which arrays are sharded."""
Numbers = NDArray[np.integer[Any]]
Arrays = dict[str, Any]
Requests = dict[int, dict[int, Numbers]]
"""For each box the unknowns it needs from another box, ascending."""


@dataclass(frozen=True)
class Link:
    """An exchange between boxes that are `offset` apart.

    Attributes
    ----------
    offset, length
        See the module.
    pairs
        Boxes (holder, user) that have anything to exchange.
    """

    offset: int
    length: int
    pairs: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Local:
    """The part of an extension that a box needs, before numbers are local.

    Attributes
    ----------
    size
        Number of coefficients of the box.
    free, unknowns
        Flat indices in the box of free coefficients, and the numbers of these unknowns.
    outer, sources, coefficients
        Flat indices in the box of dependent coefficients, the unknowns they follow from, and their weights.
    """

    size: int
    free: Numbers
    unknowns: Numbers
    outer: Numbers
    sources: Numbers
    coefficients: Array


class Halo:
    """Holders of unknowns, and what each box needs from others.

    Parameters
    ----------
    space
        The splines.
    blocks
        The boxes.
    """

    def __init__(self, space: SplineSpace, blocks: Blocks) -> None:
        self.space, self.blocks = space, blocks
        index = np.unravel_index(space.free.dofs, space.shape)
        self.holder = blocks.holders(np.stack(index))
        order = np.argsort(self.holder, kind="stable")
        starts = np.cumsum(np.bincount(self.holder, minlength=blocks.count))
        self.own = np.split(order, starts[:-1])
        """Unknowns of each box, ascending."""
        self.shape = tuple(n + space.degree for n in blocks.thickness)
        """Shape of the coefficients of a box."""
        self._number, self._row = (np.full(int(np.prod(space.shape)), -1, dtype=np.int32) for _ in range(2))
        self._number[space.free.dofs] = np.arange(len(space.free.dofs), dtype=np.int32)
        self._row[space.free.outer] = np.arange(len(space.free.outer), dtype=np.int32)

    def local(self, box: int) -> Local:
        """What a box needs of the extension."""
        degree, full = self.space.degree, self.space.shape
        window = tuple(slice(low, high + degree) for low, high in self.blocks.box(box))
        spare = [(0, n - (s.stop - s.start)) for n, s in zip(self.shape, window, strict=True)]
        number, row = (
            np.pad(array.reshape(full)[window], spare, constant_values=-1).ravel()
            for array in (self._number, self._row)
        )
        free, outer = np.flatnonzero(number >= 0), np.flatnonzero(row >= 0)
        rows = row[outer]
        coefficients = self.space.free.coefficients[rows]
        anyone = self.own[box][0] if len(self.own[box]) else 0
        sources = np.where(coefficients != 0, self.space.free.sources[rows], anyone)
        return Local(number.size, free, number[free], outer, sources, coefficients)

    def requests(self, box: int, local: Local) -> dict[int, Numbers]:
        """Unknowns that a box needs, by the box that holds them."""
        needed = np.unique(np.concatenate([local.unknowns, local.sources[local.coefficients != 0]]))
        holder = self.holder[needed]
        return {int(other): needed[holder == other] for other in np.unique(holder) if other != box}


def links_of(requests: Requests, count: int) -> tuple[Link, ...]:
    """Links that satisfy all requests."""
    pairs: dict[int, list[tuple[int, int]]] = {}
    for user, wanted in sorted(requests.items()):
        for holder in sorted(wanted):
            pairs.setdefault((holder - user) % count, []).append((holder, user))
    return tuple(
        Link(offset, max(len(requests[user][holder]) for holder, user in found), tuple(found))
        for offset, found in sorted(pairs.items())
    )


def places_of(
    halo: Halo, box: int, requests: Requests, links: Sequence[Link], held: int
) -> NDArray[np.int32]:
    """Place of each unknown in the list (held ones padded to `held`, those of each link), -1 where it is not."""
    place = np.full(len(halo.holder), -1, dtype=np.int32)
    place[halo.own[box]] = np.arange(len(halo.own[box]), dtype=np.int32)
    start = held
    for link in links:
        wanted = requests[box].get((box + link.offset) % halo.blocks.count)
        if wanted is not None:
            place[wanted] = start + np.arange(len(wanted), dtype=np.int32)
        start += link.length
    return place


def sent(halo: Halo, box: int, requests: Requests, link: Link) -> NDArray[np.int32]:
    """Places of the unknowns that a box sends along a link, without padding."""
    user = (box - link.offset) % halo.blocks.count
    wanted = requests[user].get(box, np.zeros(0, dtype=np.int64))
    return np.searchsorted(halo.own[box], wanted).astype(np.int32)


def received(links: Sequence[Link], arrays: Arrays, held: Any) -> Any:
    """The unknowns (M, n) of a box followed by those it needs from others."""
    import jax.numpy as jnp

    parts = [held]
    for link, which in zip(links, arrays["send"], strict=True):
        parts.append(moved(held[:, which], link.pairs))
    return jnp.concatenate(parts, axis=1)


def returned(links: Sequence[Link], arrays: Arrays, sums: Any) -> Any:
    """Sums (M, n) of the unknowns of a box, with what other boxes have for them: the transpose of :func:`received`."""
    import jax.numpy as jnp

    from solvers.device.extension import collected

    if not links:
        return sums
    ends = np.cumsum([link.length for link in links])
    held = sums.shape[1] - int(ends[-1])
    back = [
        moved(sums[:, held + end - link.length : held + end], [(user, holder) for holder, user in link.pairs])
        for link, end in zip(links, ends, strict=True)
    ]
    return sums[:, :held] + collected(arrays["back"], jnp.concatenate(back, axis=1))


def moved(numbers: Any, pairs: Sequence[tuple[int, int]]) -> Any:
    """Numbers of the box that sends to this one, zero when none does; inside a program."""
    import jax

    lax: Any = jax.lax
    return lax.ppermute(numbers, AXIS, pairs)
