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
from solvers.equations.density import Density, QuadraticDensity
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

    def linear_solvers(self, problem: Problem) -> tuple[str, ...]:
        """Those for symmetric matrices where there is an energy, otherwise those for general ones."""
        return tuple(choice.METHODS if self.symmetric(problem) else nonsymmetric.METHODS)

    def refusal(self, problem: Problem) -> str | None:
        """Every problem has a weak form."""
        return None

    def order(self, problem: Problem) -> int:
        """Highest derivative in the weak form."""
        return problem.equation.order

    def boundary_order(self, problem: Problem) -> int:
        """Fluxes meet the values of the test field; an oblique derivative has one along the boundary."""
        return problem.equation.order - (0 if problem.oblique else 1)

    def symmetric(self, problem: Problem) -> bool:
        """Advection and oblique derivatives are not."""
        return problem.equation.symmetric and not problem.oblique

    def volume(self, problem: Problem, coords: Sequence[Array], *, check: bool = True) -> Density:
        """Weak form of the equation."""
        return self._form(problem, problem.equation.weak_form(coords, problem.exact, check=check))

    def boundary(
        self,
        problem: Problem,
        condition: Condition,
        coords: Sequence[Array],
        normals: Array,
        spacing: float,
    ) -> Density | None:
        """Weak form of a natural condition, the same as that of its energy where it has one."""
        found = Ritz().boundary(problem, condition, coords, normals, spacing)
        return None if found is None else self._form(problem, found)

    def _form(self, problem: Problem, form: QuadraticDensity) -> QuadraticDensity:
        """Return a form with both triangles where one of the forms of the problem is not symmetric."""
        return form if self.symmetric(problem) else form.general()

    def system(self, assembly: Assembly, watch: Stopwatch) -> System:
        """Matrix and load of the weak form."""
        kind = EnergySystem if self.symmetric(assembly.problem) else GeneralSystem
        return kind(*assembly.run(watch))
