r"""Sums of squares of affine rows: the functional of least squares.

.. math:: W(v) = \tfrac12 \sum_i \omega_i (r_i \cdot v - f_i)^2

with rows :math:`r_i` in the jet v of u.  A structure :math:`v = v^0 + M z`, z the jets of the splines, makes of each
a row :math:`M^T r_i` with the right-hand side :math:`f_i - r_i \cdot v^0`; these are the rows of the overdetermined
system, and their products are the blocks of the normal equations.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rfm.calculus.types import Array
from solvers.equations.density import Blocks, Column, Loads
from solvers.equations.rows import Row, Scalar, apply
from structures.jet_matrix import JetMatrix


@dataclass(frozen=True, eq=False)
class Square:
    """One weighted row ``r.v = f``."""

    row: Row
    right: Scalar
    weight: Scalar = 1.0


@dataclass(frozen=True, eq=False)
class PulledRow:
    """A row in the jets of the splines: ``entries . z = right`` at each point.

    Attributes
    ----------
    entries
        Nonzero entries by column (m, alpha), arrays over the points.
    right, weight
        Right-hand side and weight at the points.
    """

    entries: Mapping[Column, Array]
    right: Array
    weight: Scalar


@dataclass(frozen=True, eq=False)
class SquaredDensity:
    """Half the weighted sum of squares of affine rows (:class:`solvers.equations.density.Density`)."""

    squares: tuple[Square, ...]

    def rows(self, jet: JetMatrix) -> list[PulledRow]:
        """Return the rows in the jets of the splines."""
        return [pulled(square, jet) for square in self.squares]

    def pull_back(self, jet: JetMatrix, weights: Scalar) -> tuple[Blocks, Loads]:
        """Blocks of the normal equations and loads, quadrature weights included."""
        blocks: Blocks = {}
        loads: Loads = {}
        for row in self.rows(jet):
            scaled = weights * row.weight
            for test, entry in row.entries.items():
                image = entry * scaled
                for trial, other in row.entries.items():
                    if test <= trial:
                        term = image * other
                        blocks[test, trial] = blocks[test, trial] + term if (test, trial) in blocks else term
                term = image * row.right
                loads[test] = loads[test] + term if test in loads else term
        return blocks, loads


def pulled(square: Square, jet: JetMatrix) -> PulledRow:
    """Row in the jets of the splines."""
    entries: dict[Column, Array] = {}
    for psi, matrix in jet.entries.items():
        for (beta, alpha), value in matrix.items():
            if beta in square.row:
                term = square.row[beta] * value
                key = (psi, alpha)
                entries[key] = entries[key] + term if key in entries else term
    return PulledRow(entries, square.right - apply(square.row, jet.offset), square.weight)
