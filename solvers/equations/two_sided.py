r"""An interface between two materials: what each of the two fields says about the condition between them.

The jet of :math:`u = (u_1, u_2)` is that of the inclusion's field above that of the matrix' field.  With n out of the
inclusion the flux jumps by q,

.. math:: F_1 u_1 \cdot n - F_2 u_2 \cdot n = q, \qquad F_i u = k_i \nabla u \text{ or } \sigma_i(u),

and in the energy, where the value jumps by a given amount only, the interface does the work :math:`-\int q \cdot u_1`.
There is no domain, hence no density inside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.data import values
from solvers.equations.density import QuadraticDensity
from solvers.equations.equation import Equation
from solvers.equations.motions import Motion
from solvers.equations.rows import Equality, Row, Scalar, apply
from solvers.exact import Exact, exact_jet, required
from solvers.problem import Condition, FluxJump, FromExact


@dataclass(frozen=True)
class TwoSided:
    """The pair of the equations on both sides.

    See :class:`solvers.equations.equation.Equation`.

    Attributes
    ----------
    inner, outer
        Equation of the inclusion and of the matrix.
    """

    inner: Equation
    outer: Equation

    pictured = ()
    conditions = (FluxJump,)

    @property
    def name(self) -> str:
        """That of both."""
        return self.inner.name

    @property
    def order(self) -> int:
        """Highest derivative in the energies."""
        return self.inner.order

    @property
    def strong_order(self) -> int:
        """Highest derivative in the residuals."""
        return self.inner.strong_order

    @property
    def flux_order(self) -> int:
        """Highest derivative in the fluxes."""
        return self.inner.flux_order

    @property
    def symmetric(self) -> bool:
        """Whether both have an energy."""
        return self.inner.symmetric and self.outer.symmetric

    def components(self, dimension: int) -> int:
        """Return the number of components of both fields."""
        return 2 * self.inner.components(dimension)

    def density(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """No density: an interface has no inside."""
        return QuadraticDensity({}, {})

    def weak_form(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """No form: an interface has no inside."""
        return QuadraticDensity({}, {})

    def residual(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> list[Equality]:
        """No residual: an interface has no inside."""
        return []

    def flux(self, coords: Sequence[Array], normals: Array, *, check: bool = True) -> list[Row]:
        """Flux of the inclusion minus that of the matrix."""
        dimension = len(coords)
        half = self.inner.components(dimension) * len(multi_indices(dimension, self.flux_order))
        rows: list[Row] = []
        for own, other in zip(
            self.inner.flux(coords, normals, check=check),
            self.outer.flux(coords, normals, check=check),
            strict=True,
        ):
            row: dict[int, Scalar] = dict(own)
            row.update({half + position: -entry for position, entry in other.items()})
            rows.append(row)
        return rows

    def condition_rows(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> list[Equality]:
        """The rows of the flux jump and their values."""
        if not isinstance(condition, FluxJump):
            raise TypeError(f"an interface has no condition {type(condition).__name__}")
        rows = self.flux(coords, normals)
        data = condition.value if isinstance(condition.value, tuple) else (condition.value,) * len(rows)
        found: list[Equality] = []
        for row, q in zip(rows, data, strict=True):
            if isinstance(q, FromExact):
                found.append((row, apply(row, exact_jet(required(exact), coords, self.flux_order))))
            else:
                found.append((row, 0.0 if q is None else values("flux jump", q, coords)))
        return found

    def natural_density(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> QuadraticDensity | None:
        """Work of the flux jump on the values of the inclusion's field."""
        width = len(multi_indices(len(coords), self.order - 1))
        rows = self.condition_rows(condition, coords, normals, exact)
        return QuadraticDensity({}, {c * width: right for c, (_, right) in enumerate(rows)})

    def derived(self, coords: Sequence[Array], jet: Array) -> dict[str, dict[str, Array]]:
        """Nothing."""
        return {}

    def motions(self, dimension: int) -> list[Motion]:
        """Nothing."""
        return []
