"""Jet matrices: a structure at points, as numbers only.

Leibniz' rule applied to u = u0 + sum a_{m,alpha} d^alpha psi_m gives

    d^beta u = d^beta u0 + sum_m sum_alpha M_m[beta, alpha] d^alpha psi_m,
    M_m[beta, alpha + gamma] += binom(beta, gamma) d^{beta - gamma} a_{m,alpha}   for gamma <= beta,

so that equations and bases see small matrices and never a formula.  For u = u0 + w psi at
first order in the plane M has five entries that can differ from zero:

    [ w    0  0 ]
    [ w_x  w  0 ]
    [ w_y  0  w ]

Only such entries are stored; :attr:`JetMatrix.pattern` says which.

Notation: beta runs over ``multi_indices(d, order)``, alpha over ``multi_indices(d, order + operator order)``,
in the order of :func:`rfm.calculus.jets.multi_indices`; the shape of the points is ``pts``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import factorial, prod
from typing import TypeAlias

import numpy as np

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array, Value
from structures.expansion import coefficients, expand, is_zero, scaled
from structures.field_expression import MultiIndex
from structures.operator import Operator

Shared: TypeAlias = dict[int, tuple[Value, Array]]
"""Values, by identity, and the arrays over the points that they became."""


@dataclass(frozen=True, eq=False)
class JetMatrix:
    """The affine map from partial derivatives of the psi's to those of u, at points.

    Attributes
    ----------
    dimension, order, operator_order
        d, the order of the jet of u, and the highest derivative of psi in the structure.
    offset
        ``(n_beta, *pts)``: partial derivatives of u0.
    entries
        ``entries[m][beta, alpha]`` is the array ``(*pts)`` of M_m[beta, alpha]; missing entries are zero.
        Equal entries are one array and constants are broadcast views: do not write into them.
    offset_rows
        Positions beta at which u0 can differ from zero, as the formula tells.
    """

    dimension: int
    order: int
    operator_order: int
    offset: Array
    entries: Mapping[int, Mapping[tuple[int, int], Array]]
    offset_rows: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers (n_beta, n_alpha) of rows and columns."""
        total = self.order + self.operator_order
        return self.offset.shape[0], len(multi_indices(self.dimension, total))

    @property
    def known(self) -> list[tuple[int, Array]]:
        """The derivatives of u0 that can differ from zero, with their positions."""
        return [(row, self.offset[row]) for row in self.offset_rows]

    @cached_property
    def blocks(self) -> dict[int, Array]:
        """Dense matrices ``{m: (n_beta, n_alpha, *pts)}``, built on first use."""
        blocks = {}
        for psi, entries in self.entries.items():
            block = np.zeros(self.shape + self.offset.shape[1:])
            for (beta, alpha), value in entries.items():
                block[beta, alpha] = value
            blocks[psi] = block
        return blocks

    @property
    def pattern(self) -> dict[int, frozenset[tuple[int, int]]]:
        """The pairs (beta, alpha) of positions that can differ from zero, for each psi.

        The pattern follows from the formula alone and is the same at all points, so an assembler
        may skip the other entries: ``entries[m][beta, alpha]`` exists exactly for these.
        """
        return {psi: frozenset(entries) for psi, entries in self.entries.items()}

    def apply(self, psi: Mapping[int, Array] | Array) -> Array:
        """Return the partial derivatives of u.

        Parameters
        ----------
        psi
            Partial derivatives ``(n_alpha, *pts)`` of each psi; a bare array for a single unknown 0.

        Returns
        -------
        Array
            ``(n_beta, *pts)``.
        """
        jets = psi if isinstance(psi, Mapping) else {0: psi}
        result = self.offset.copy()
        for index, entries in self.entries.items():
            for (beta, alpha), value in entries.items():
                result[beta] += value * jets[index][alpha]
        return result


def evaluate(op: Operator, coords: Sequence[Array], order: int) -> JetMatrix:
    """Return the jet matrix of ``op`` at points.

    Parameters
    ----------
    op
        The structure.
    coords
        ``d`` coordinate arrays (broadcast against each other to the shape ``pts``).
    order
        Highest derivative of u that is wanted.
    """
    return evaluate_all([op], coords, order)[0]


def evaluate_all(ops: Sequence[Operator], coords: Sequence[Array], order: int) -> list[JetMatrix]:
    """Return the jet matrices of several structures (components of a vector), evaluating shared fields once."""
    arrays = [np.asarray(c, dtype=np.float64) for c in coords]
    points = np.broadcast_shapes(*(c.shape for c in arrays))
    requests = [(f, order) for op in ops for f in (op.offset, *(t.coefficient for t in op.terms))]
    values = iter(expand(requests, arrays))
    shared: Shared = {}
    return [_matrix(op, values, points, order, shared) for op in ops]


def _matrix(
    op: Operator, values: Iterator[Value], points: tuple[int, ...], order: int, shared: Shared
) -> JetMatrix:
    indices = multi_indices(op.dimension, order)
    offset = np.empty((len(indices), *points))
    rows = []
    for row, (index, c) in enumerate(zip(indices, coefficients(next(values), len(indices)), strict=True)):
        offset[row] = scaled(prod(map(factorial, index)), c)
        if not is_zero(c):
            rows.append(row)
    entries: dict[int, dict[tuple[int, int], Value]] = {psi: {} for psi in op.unknowns}
    for term in op.terms:
        found = entries[term.psi]
        taylor = coefficients(next(values), len(indices))
        for position, source, factor in _leibniz(op.dimension, order, op.order, term.alpha):
            if is_zero(taylor[source]):
                continue
            value = scaled(factor, taylor[source])
            found[position] = found[position] + value if position in found else value
    spread = {
        psi: {position: _spread(value, points, shared) for position, value in found.items()}
        for psi, found in entries.items()
    }
    return JetMatrix(op.dimension, order, op.order, offset, spread, tuple(rows))


def _spread(value: Value, points: tuple[int, ...], shared: Shared) -> Array:
    """Value at all points, the same array for the same value."""
    if id(value) not in shared:
        shared[id(value)] = value, np.broadcast_to(np.asarray(value, float), points)
    return shared[id(value)][1]


@lru_cache(maxsize=256)
def _leibniz(
    dimension: int, order: int, operator_order: int, alpha: MultiIndex
) -> tuple[tuple[tuple[int, int], int, int], ...]:
    """Return ((beta, alpha + gamma), beta - gamma, factor): positions, source coefficient and its factor.

    With normalised Taylor coefficients binom(beta, gamma) d^{beta-gamma} a = beta!/gamma! c_{beta-gamma}(a).
    """
    rows = {index: k for k, index in enumerate(multi_indices(dimension, order))}
    columns = {index: k for k, index in enumerate(multi_indices(dimension, order + operator_order))}
    table = []
    for beta, row in rows.items():
        for gamma in rows:
            rest = tuple(b - g for b, g in zip(beta, gamma, strict=True))
            if min(rest) < 0:
                continue
            column = columns[tuple(a + g for a, g in zip(alpha, gamma, strict=True))]
            factor = prod(map(factorial, beta)) // prod(map(factorial, gamma))
            table.append(((row, column), rows[rest], factor))
    return tuple(table)


def stacked(ops: Sequence[Operator], coords: Sequence[Array], order: int) -> JetMatrix:
    """Return the jet matrix of a vector field: the rows of its components one below the other.

    Row ``c * n_beta + beta`` is d^beta of component c; for a single component this is :func:`evaluate`.
    """
    matrices = evaluate_all(ops, coords, order)
    if len(matrices) == 1:
        return matrices[0]
    height = len(multi_indices(ops[0].dimension, order))
    entries: dict[int, dict[tuple[int, int], Array]] = {}
    for component, matrix in enumerate(matrices):
        for psi, found in matrix.entries.items():
            target = entries.setdefault(psi, {})
            target.update(
                {(component * height + beta, alpha): value for (beta, alpha), value in found.items()}
            )
    operator_order = max(matrix.operator_order for matrix in matrices)
    offset = np.concatenate([matrix.offset for matrix in matrices])
    rows = tuple(c * height + row for c, matrix in enumerate(matrices) for row in matrix.offset_rows)
    return JetMatrix(ops[0].dimension, order, operator_order, offset, entries, rows)
