r"""Galerkin's method: the weak residual vanishes for every test field of the solution structure.

.. math:: a(B[\psi] + u_0, v) = (f, v) + \int_{\Gamma_N} g v\,ds \quad\text{for all } v = B[\phi], \qquad
          a(u, v) = \int_\Omega k \nabla u \cdot \nabla v + (b \cdot \nabla u + c u) v\,dx

for advection, diffusion and reaction.  Where there is an energy these are the equations of its minimum, so that the
method agrees with Ritz's; it is the one to choose where there is none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rfm.calculus.types import Array
from solvers.equations.density import Density
from solvers.equations.equation import Equation
from solvers.linear import choice, nonsymmetric
from solvers.pipeline import Assembly
from solvers.problem import Condition, Problem
from solvers.ritz import Ritz
from solvers.stopwatch import Stopwatch
from solvers.systems import EnergySystem, GeneralSystem, System


@dataclass(frozen=True)
class Galerkin:
    """Weak residual zero for all fields of the structure: also with advection, where there is no energy.

    See :class:`solvers.method.Method`.
    """

    name: str = "galerkin"

    def linear_solvers(self, equation: Equation) -> tuple[str, ...]:
        """Those for symmetric matrices where there is an energy, otherwise those for general ones."""
        return tuple(choice.METHODS if equation.symmetric else nonsymmetric.METHODS)

    def refusal(self, equation: Equation) -> str | None:
        """Every equation has a weak form."""
        return None

    def order(self, problem: Problem) -> int:
        """Highest derivative in the weak form."""
        return problem.equation.order

    def boundary_order(self, problem: Problem) -> int:
        """Fluxes meet the values of the test field."""
        return problem.equation.order - 1

    def symmetric(self, problem: Problem) -> bool:
        """Advection is not."""
        return problem.equation.symmetric

    def volume(self, problem: Problem, coords: Sequence[Array], *, check: bool = True) -> Density:
        """Weak form of the equation."""
        return problem.equation.weak_form(coords, problem.exact, check=check)

    def boundary(
        self,
        problem: Problem,
        condition: Condition,
        coords: Sequence[Array],
        normals: Array,
        spacing: float,
    ) -> Density | None:
        """Weak form of a natural condition, the same as that of its energy."""
        return Ritz().boundary(problem, condition, coords, normals, spacing)

    def system(self, assembly: Assembly, watch: Stopwatch) -> System:
        """Matrix and load of the weak form."""
        kind = EnergySystem if self.symmetric(assembly.problem) else GeneralSystem
        return kind(*assembly.run(watch))
