"""What methods of strong residuals share: least squares and collocation differ in their points and their system.

The density is a sum of weighted squares, of the residuals in the domain and of the natural conditions
(:mod:`solvers.least_squares` has the functional and its weights).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.equations.rows import Row
from solvers.equations.squares import Square, SquaredDensity
from solvers.flux_conditions import has_flux
from solvers.problem import Condition, Problem


@dataclass(frozen=True)
class StrongResiduals:
    """Weighted squares of the strong residuals, in the domain and of the natural conditions.

    Attributes
    ----------
    weights
        Weight of the residual of each component; ones when absent.
    boundary_weight
        Factor of the weights of the natural conditions.
    """

    weights: tuple[float, ...] = ()
    boundary_weight: float = 1.0

    def refusal(self, problem: Problem) -> str | None:
        """Every equation has a residual."""
        return None

    def order(self, problem: Problem) -> int:
        """Highest derivative in the residual."""
        return problem.equation.strong_order

    def boundary_order(self, problem: Problem) -> int:
        """Highest derivative in a boundary condition."""
        return problem.equation.flux_order

    def symmetric(self, problem: Problem) -> bool:
        """Squares are."""
        return True

    def volume(self, problem: Problem, coords: Sequence[Array], *, check: bool = True) -> SquaredDensity:
        """Squares of the strong residuals."""
        found = problem.equation.residual(coords, problem.exact, check=check)
        weights = self.weights or (1.0,) * len(found)
        return SquaredDensity(
            tuple(Square(row, right, weight) for (row, right), weight in zip(found, weights, strict=True))
        )

    def boundary(
        self,
        problem: Problem,
        condition: Condition,
        coords: Sequence[Array],
        normals: Array,
        spacing: float,
    ) -> SquaredDensity | None:
        """Squares of a natural condition, scaled by the spacing."""
        if not has_flux(condition):
            return None
        equation, dimension = problem.equation, len(coords)
        found = equation.condition_rows(condition, coords, normals, problem.exact)
        gaps = [equation.strong_order - row_order(row, equation.flux_order, dimension) for row, _ in found]
        return SquaredDensity(
            tuple(
                Square(row, right, self.boundary_weight * spacing ** (1 - 2 * gap))
                for (row, right), gap in zip(found, gaps, strict=True)
            )
        )


def row_order(row: Row, order: int, dimension: int) -> int:
    """Highest derivative among the entries of a row in the jet of order `order`."""
    indices = multi_indices(dimension, order)
    return max(sum(indices[position % len(indices)]) for position in row)
