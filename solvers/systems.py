"""Discrete systems: what a method of solution leaves to linear algebra."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.kernel import Kernel
from solvers.linear import LinearSolution
from solvers.linear import solve as solve_linear
from solvers.linear.condition import condition_number, factorise
from solvers.linear.direct import refine
from solvers.linear.lattice import Lattice
from solvers.linear.least_squares import Overdetermined, solve_by_qr, work_of_qr
from solvers.linear.nonsymmetric import solve as solve_nonsymmetric
from solvers.linear.overlapping import solve_reporting
from solvers.linear.system import ScaledSystem
from solvers.problem import SolverOptions

WELL_CONDITIONED = 1e6
"""Condition number of normal equations up to which they are solved as they are."""
QR_WORK = 1e11
"""Floating point operations that a QR factorisation may cost (half a minute on one core)."""


class System(Protocol):
    """Equations for the unknowns of all splines."""

    def solve(self, options: SolverOptions, kernel: Kernel | None) -> LinearSolution:
        """Solve them; adding fields of the `kernel`, where there is one, changes nothing."""
        ...


def chosen(options: SolverOptions) -> str:
    """Name of the linear solver: unknowns that may depend on each other need one that chooses among them."""
    return "pivoted" if options.linear == "auto" and options.redundant else options.linear


@dataclass(frozen=True, eq=False)
class EnergySystem:
    """Symmetric matrix and load of an energy that is to be as small as possible."""

    matrix: Any
    load: Array
    lattice: Lattice | None = None
    """Where the unknowns of each component sit, for splines that share one grid."""

    def solve(self, options: SolverOptions, kernel: Kernel | None) -> LinearSolution:
        """Solve for the minimum; where there is a kernel, on its complement.

        Raises
        ------
        NumericsError
            The system could not be solved, or the load does not vanish on the kernel.
        """
        load = self.load if kernel is None else kernel.balanced(self.load)
        return solve_linear(
            self.matrix,
            load,
            method=chosen(options),
            tolerance=options.tolerance,
            null_space=None if kernel is None else kernel.vectors,
            lattice=self.lattice,
        )

    def solve_reporting(self, options: SolverOptions, dimension: int) -> LinearSolution:
        """Solve for the minimum without a kernel, and report the condition number.

        Raises
        ------
        NumericsError
            The system could not be solved.
        """
        found = None
        if options.linear == "auto" and self.load.any():
            found = solve_reporting(self.matrix, self.load, options.tolerance, dimension)
        if found is not None:
            return found
        return replace(self.solve(options, None), condition=condition_number(self.matrix, self.load))


@dataclass(frozen=True, eq=False)
class GeneralSystem:
    """Matrix, not symmetric, and load of a weak form without an energy."""

    matrix: Any
    load: Array

    def solve(self, options: SolverOptions, kernel: Kernel | None) -> LinearSolution:
        """Solve.

        Raises
        ------
        NumericsError
            The system could not be solved, or constants are free.
        """
        if kernel is not None:
            raise NumericsError(
                "with advection and only flux conditions the solution is not unique: fix it somewhere with a "
                "Dirichlet or Robin condition, or choose method: least-squares"
            )
        return solve_nonsymmetric(self.matrix, self.load, chosen(options), options.tolerance)


@dataclass(frozen=True, eq=False)
class SquaresSystem:
    """Normal equations of least squares, and the rows they were made of on demand."""

    matrix: Any
    load: Array
    rows: Callable[[], Overdetermined]
    energy_load: Callable[[], Array]
    """Load of the energy of the same problem, which shows whether data with a kernel are compatible."""

    def solve(self, options: SolverOptions, kernel: Kernel | None) -> LinearSolution:
        """Solve the normal equations when they are well conditioned, otherwise the rows by a QR factorisation.

        Raises
        ------
        NumericsError
            The system could not be solved.
        """
        normal = EnergySystem(self.matrix, self.load)
        if kernel is not None:
            kernel.balanced(self.energy_load())
            return normal.solve(
                options if options.linear != "qr" else replace(options, linear="auto"), kernel
            )
        if options.linear == "qr":
            return solve_by_qr(self.rows(), "chosen by the user", options.redundant)
        if options.linear != "auto" or not self.load.any():
            return normal.solve(options, kernel)
        system = ScaledSystem.of(self.matrix, self.load)
        factors = factorise(system)
        if factors is None:
            return normal.solve(options, kernel)
        condition = f"normal equations of condition {factors.condition:.0e}"
        if factors.condition > WELL_CONDITIONED:
            rows = self.rows()
            if work_of_qr(rows) <= QR_WORK:
                return solve_by_qr(rows, f"{condition}: too much for their factorisation")
            return replace(normal.solve(options, kernel), reason=f"{condition}, but too large for QR")
        scaled, steps = refine(system, factors.apply, options.tolerance)
        x, residual = system.unscale(scaled)
        reason = f"{condition}: well conditioned"
        return LinearSolution(x, residual, steps, factors.method, reason, factors.condition)


@dataclass(frozen=True, eq=False)
class RowsSystem:
    """Rows only: an overdetermined system without normal equations."""

    rows: Overdetermined
    energy_load: Callable[[], Array]
    """Load of the energy of the same problem, which shows whether data with a kernel are compatible."""
    reason: str = "more equations than unknowns"

    def solve(self, options: SolverOptions, kernel: Kernel | None) -> LinearSolution:
        """Solve by a QR factorisation.

        Raises
        ------
        NumericsError
            The system could not be solved, or there is a kernel and the basis has no redundancy to hide it in.
        """
        if kernel is not None and options.redundant:
            kernel.balanced(self.energy_load())
        elif kernel is not None:
            raise NumericsError(
                "with only flux conditions the solution is not unique: fix it somewhere with a Dirichlet or Robin "
                "condition, or choose method: ritz"
            )
        return solve_by_qr(self.rows, self.reason, options.redundant)
