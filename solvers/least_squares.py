r"""Least squares: the spline psi makes the weighted squares of the strong residuals smallest.

.. math:: J(u) = \tfrac12 \sum_i \int_\Omega \omega_i\, (R_i u - f_i)^2 dx
          + \tfrac12 \sum_j \int_{\Gamma_j} \gamma\, h^{1 - 2(s - m_j)} (B_j u - g_j)^2 ds, \qquad u = u_0 + B[\psi],

s the order of the residual, :math:`m_j` that of the boundary operator.  Essential conditions hold for every psi and
have no square; with :math:`\|Ru\|_0` of the size of :math:`\|u\|_{s}` the powers of the spacing h give the
natural ones the weight at which the order of the splines is kept (Aziz, Kellogg and Stephens, Numer. Math. 45, 1985;
Bochev and Gunzburger, *Least-Squares Finite Element Methods*, Springer 2009, section 12).  Errors in L2 go down like
:math:`h^{\min(p + 1,\, 2(p + 1 - s))}`: choose p of at least 2 s - 1.

The normal equations are assembled like an energy.  Their condition number is the square of that of the rows, so
it is estimated, and where it would cost digits the rows themselves are solved by a QR factorisation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

from rfm.calculus.types import Array
from solvers.block_assembly import BlockAssembler
from solvers.linear import choice
from solvers.pipeline import Assembly
from solvers.problem import Problem
from solvers.ritz import Ritz
from solvers.row_assembly import assemble_rows
from solvers.stopwatch import Stopwatch
from solvers.strong_residuals import StrongResiduals
from solvers.systems import QR_WORK, RowsSystem, SquaresSystem, System


@dataclass(frozen=True)
class LeastSquares(StrongResiduals):
    """Least weighted squares of the strong residuals, see :class:`solvers.method.Method`."""

    name: str = "least-squares"

    def linear_solvers(self, problem: Problem) -> tuple[str, ...]:
        """QR for the rows, the others for the normal equations."""
        return ("qr", *choice.METHODS)

    def system(self, assembly: Assembly, watch: Stopwatch) -> System:
        """Normal equations, and the rows they stand for in case they are ill-conditioned.

        Where the functions of a basis depend on each other to rounding, normal equations would keep half of the
        digits only, so there are rows at once, if they are not too many.
        """
        spaces, rules = assembly.assembler.spaces, assembly.background.rules
        load = partial(energy_load, assembly, watch)
        unknowns = sum(space.n_dofs for space in spaces)
        equations = (rules.inner.size + rules.cut.size) * len(assembly.structure)
        if any(space.redundant for space in spaces) and 2.0 * equations * unknowns**2 <= QR_WORK:
            return RowsSystem(
                assemble_rows(assembly), load, "functions that depend on each other to rounding"
            )
        return SquaresSystem(*assembly.run(watch), partial(assemble_rows, assembly), load)


def energy_load(assembly: Assembly, watch: Stopwatch) -> Array:
    """Load of Ritz's method for the same problem."""
    assembler = BlockAssembler(assembly.assembler.spaces)
    load: Array = replace(assembly, method=Ritz(), assembler=assembler).run(watch)[1]
    return load
