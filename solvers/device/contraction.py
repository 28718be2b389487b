r"""Derivatives of splines at the nodes of cells and the transposed map, one direction at a time, on JAX.

Notation: a chunk of n cells, ``M`` components, degree p, q nodes a direction. Local coefficients have the shape
``(M, p+1, ..., p+1, n)``, values at nodes ``(M, nodes, n)`` with the nodes of a cell as ``(q, ..., q)`` or as a
list ``(q,)``: the cells run fastest. A *kind* ``r`` counts the tables of one direction (the r-th derivative), and a
tuple of kinds, one for each direction, names what is evaluated:

.. math:: v^\alpha_{k} = \sum_{a_1} \varphi^{(\alpha_1)}_{a_1}(t_{k_1}) \cdots
          \sum_{a_d} \varphi^{(\alpha_d)}_{a_d}(t_{k_d})\, c_{a_1 \dots a_d}.

The last direction is contracted first, and kinds that agree in it share the work.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any, Protocol

Kinds = tuple[int, ...]
Fields = dict[Kinds, Any]
LOCAL = "abc"


class Tables(Protocol):
    """Tables of the splines of a cell at its nodes."""

    def values(self, local: Any, kinds: Iterable[Kinds]) -> Fields:
        """Derivatives of the given kinds at the nodes."""
        ...

    def adjoint(self, fields: Mapping[Kinds, Any]) -> Any:
        """Local coefficients of the transposed map, summed over the kinds."""
        ...


@dataclass(frozen=True)
class TensorTables:
    """The same tensor nodes in all cells: ``lines[axis]`` has the shape (R, q, p+1)."""

    lines: tuple[Any, ...]

    def values(self, local: Any, kinds: Iterable[Kinds]) -> Fields:
        """See :class:`Tables`."""
        wanted = set(kinds)
        level: Fields = {(): local}
        for axis in reversed(range(len(self.lines))):
            suffixes = sorted({kind[axis:] for kind in wanted})
            level = {s: self._contract(level[s[1:]], axis, self.lines[axis][s[0]]) for s in suffixes}
        return level

    def adjoint(self, fields: Mapping[Kinds, Any]) -> Any:
        """See :class:`Tables`."""
        level = dict(fields)
        for axis in range(len(self.lines)):
            level = summed(
                (s[1:], self._contract(f, axis, self.lines[axis][s[0]].T)) for s, f in level.items()
            )
        return level[()]

    def _contract(self, array: Any, axis: int, table: Any) -> Any:
        """Apply a table (out, in) along one direction of an array (M, ..., n).

        The table is repeated for the directions before, which are the batch of a product of matrices: no transposition,
        two to five times as fast as one contraction on a processor.
        """
        import jax.numpy as jnp
        from jax import lax

        shape, at = array.shape, axis + 1
        before, after = prod(shape[:at]), prod(shape[at + 1 :])
        batch = jnp.broadcast_to(table, (before, *table.shape))
        product = lax.batch_matmul(batch, array.reshape(before, shape[at], after))
        return product.reshape(*shape[:at], table.shape[0], *shape[at + 1 :])


@dataclass(frozen=True)
class PointTables:
    """Points of each cell's own: ``lines[axis]`` has the shape (R, q, p+1, n)."""

    lines: tuple[Any, ...]

    def values(self, local: Any, kinds: Iterable[Kinds]) -> Fields:
        """See :class:`Tables`."""
        import jax.numpy as jnp

        wanted, dimension = set(kinds), len(self.lines)
        level: Fields = {(): local}
        for axis in reversed(range(dimension)):
            rest = LOCAL[:axis]
            nodes = "" if axis == dimension - 1 else "q"
            spell = f"qzn,M{rest}z{nodes}n->M{rest}qn"
            level = {
                s: jnp.einsum(spell, self.lines[axis][s[0]], level[s[1:]])
                for s in sorted({kind[axis:] for kind in wanted})
            }
        return level

    def adjoint(self, fields: Mapping[Kinds, Any]) -> Any:
        """See :class:`Tables`."""
        import jax.numpy as jnp

        level, dimension = dict(fields), len(self.lines)
        for axis in range(dimension):
            rest = LOCAL[:axis]
            nodes = "" if axis == dimension - 1 else "q"
            spell = f"qzn,M{rest}qn->M{rest}z{nodes}n"
            level = summed((s[1:], jnp.einsum(spell, self.lines[axis][s[0]], f)) for s, f in level.items())
        return level[()]


def summed(terms: Iterable[tuple[Kinds, Any]]) -> Fields:
    """Sums of the terms of each kind."""
    found: Fields = {}
    for kind, term in terms:
        found[kind] = found[kind] + term if kind in found else term
    return found
