"""What a method of solution is: which quadratic functional the spline makes smallest.

Ritz takes the energy, least squares the squared residual; the rest (background, structure, assembly, linear
algebra) is common to all, in :mod:`solvers.pipeline`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from rfm.calculus.types import Array
from solvers.equations.density import QuadraticDensity
from solvers.problem import Condition, Problem


class Method(Protocol):
    """Densities of a functional in the domain and on its boundary."""

    @property
    def name(self) -> str:
        """Name in a case file."""
        ...

    def order(self, problem: Problem) -> int:
        """Highest derivative of u in the domain's density."""
        ...

    def boundary_order(self, problem: Problem) -> int:
        """Highest derivative of u in the boundary's density."""
        ...

    def volume(self, problem: Problem, coords: Sequence[Array], *, check: bool = True) -> QuadraticDensity:
        """Density at points of the domain; `check` refuses data that are not finite."""
        ...

    def boundary(
        self, problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array, spacing: float
    ) -> QuadraticDensity | None:
        """Density of a natural condition at points of the boundary, None when it has none."""
        ...
