"""What an equation is to the solvers: its energy, its strong residual and the conditions it can have.

The jet of the unknown u has the entry ``component * n_beta + beta`` for the partial derivative d^beta of a component,
beta over :func:`rfm.calculus.jets.multi_indices` of the order that each method states.  Methods of solution and
reports see rows and densities in this jet and nothing of the formula (:mod:`solvers.equations.rows`,
:mod:`solvers.equations.density`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from rfm.calculus.types import Array
from solvers.equations.density import QuadraticDensity
from solvers.equations.motions import Motion
from solvers.equations.rows import Equality, Row
from solvers.exact import Exact
from solvers.problem import Condition


class Equation(Protocol):
    """A linear equation with an energy."""

    @property
    def name(self) -> str:
        """Name in a case file."""
        ...

    @property
    def order(self) -> int:
        """Highest derivative of u in the energy."""
        ...

    @property
    def strong_order(self) -> int:
        """Highest derivative of u in the strong residual."""
        ...

    @property
    def flux_order(self) -> int:
        """Highest derivative of u in a boundary condition."""
        ...

    @property
    def symmetric(self) -> bool:
        """Whether there is an energy."""
        ...

    @property
    def conditions(self) -> tuple[type, ...]:
        """Kinds of condition that the equation can have."""
        ...

    @property
    def pictured(self) -> tuple[str, ...]:
        """Names of the derived quantities that are worth a picture."""
        ...

    def components(self, dimension: int) -> int:
        """Return the number of components of u."""
        ...

    def density(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Energy density at points, in the jet of `order`."""
        ...

    def weak_form(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Weak form at points, in the jet of `order`; the energy density where there is one."""
        ...

    def residual(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> list[Equality]:
        """Strong residual ``r.v - f`` at points, rows in the jet of `strong_order`."""
        ...

    def flux(self, coords: Sequence[Array], normals: Array, *, check: bool = True) -> list[Row]:
        """Natural boundary operators, rows in the jet of `flux_order`."""
        ...

    def natural_density(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> QuadraticDensity | None:
        """Boundary energy of a condition in the jet of `order` - 1; None of a purely essential one."""
        ...

    def condition_rows(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> list[Equality]:
        """What a condition asks at boundary points, rows in the jet of `flux_order`."""
        ...

    def derived(self, coords: Sequence[Array], jet: Array) -> dict[str, dict[str, Array]]:
        """Further quantities, such as the components of the stress, by kind and name; from the jet of `order`."""
        ...

    def motions(self, dimension: int) -> list[Motion]:
        """Affine fields that the energy in the domain does not see."""
        ...
