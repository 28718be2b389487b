r"""Ritz's method: the spline psi minimises the energy over all fields of the solution structure.

.. math:: E(u) = \int_\Omega W(\text{jet of } u)\,dx
          - \int_{\Gamma_N} g u\,ds + \int_{\Gamma_R} \bigl(\tfrac12 h u^2 - g u\bigr) ds,
          \qquad u = u_0 + B[\psi].

Essential conditions hold for every psi; natural ones hold at the minimum (Shapiro, Acta Numerica 2007,
section 7; Hoellig, *Finite Element Methods with B-Splines*, SIAM 2003, chapter 2).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rfm.calculus.types import Array
from solvers.boundary import natural_density
from solvers.problem import Condition, Dirichlet, Discretization, Problem, SolverOptions

# `rfm check` asks a method whether it suits and solves nothing: the solvers are imported where they are used
if TYPE_CHECKING:
    from solvers.equations.density import QuadraticDensity
    from solvers.pipeline import Assembly
    from solvers.solution import Solution
    from solvers.stopwatch import Listener, Stopwatch
    from solvers.systems import EnergySystem


@dataclass(frozen=True)
class Ritz:
    """Least energy of all fields of the structure.

    See :class:`solvers.method.Method`.
    """

    name: str = "ritz"

    def linear_solvers(self, problem: Problem) -> tuple[str, ...]:
        """Those for symmetric matrices."""
        from solvers.linear.choice import METHODS

        return tuple(METHODS)

    def refusal(self, problem: Problem) -> str | None:
        """Only a problem with an energy will do."""
        if not problem.equation.symmetric:
            return "with advection there is no energy; choose method: galerkin"
        return (
            "with an oblique derivative there is no energy; choose method: galerkin"
            if problem.oblique
            else None
        )

    def order(self, problem: Problem) -> int:
        """Highest derivative in the energy."""
        return problem.equation.order

    def boundary_order(self, problem: Problem) -> int:
        """Fluxes do work on the values of u."""
        return problem.equation.order - 1

    def symmetric(self, problem: Problem) -> bool:
        """Second derivatives of an energy are."""
        return True

    def volume(self, problem: Problem, coords: Sequence[Array], *, check: bool = True) -> QuadraticDensity:
        """Energy density of the equation."""
        return problem.equation.density(coords, problem.exact, check=check)

    def boundary(
        self,
        problem: Problem,
        condition: Condition,
        coords: Sequence[Array],
        normals: Array,
        spacing: float,
    ) -> QuadraticDensity | None:
        """Energy density of a natural condition."""
        if isinstance(condition, Dirichlet):
            return None
        return natural_density(problem, condition, coords, normals)

    def system(self, assembly: Assembly, watch: Stopwatch) -> EnergySystem:
        """Matrix and load of the energy."""
        from solvers.linear.lattice import lattice_of
        from solvers.systems import EnergySystem

        matrix, load = assembly.run(watch)
        assembler = assembly.assembler
        return EnergySystem(matrix, load, lattice_of(assembler.spaces, assembler.stencils()))


def solve(
    problem: Problem,
    discretization: Discretization,
    options: SolverOptions | None = None,
    listener: Listener | None = None,
) -> Solution:
    """Solve `problem` by the Ritz method; see :func:`solvers.pipeline.solve`."""
    from solvers import pipeline

    return pipeline.solve(problem, discretization, Ritz(), options, listener)
