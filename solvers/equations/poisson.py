r"""Advection, diffusion and reaction: :math:`-\operatorname{div}(k \nabla u) + b \cdot \nabla u + c u = f`.

Without advection b there is an energy, of density :math:`W = \tfrac12 k |\nabla u|^2 + \tfrac12 c u^2 - f u`.  The
natural boundary operator is the conormal flux :math:`k\,\partial u/\partial n`: a Neumann part adds :math:`-g u` on
the boundary, a Robin part :math:`\tfrac12 h u^2 - g u`.  The strong residual is

.. math:: -k \Delta u - \nabla k \cdot \nabla u + b \cdot \nabla u + c u - f .
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field
from solvers.data import require_finite, values
from solvers.equations import scalar_conditions
from solvers.equations.density import QuadraticDensity
from solvers.equations.motions import Motion, constants
from solvers.equations.rows import Equality, Row, Scalar, added, apply
from solvers.exact import Exact, exact_jet, required
from solvers.problem import Condition


@dataclass(frozen=True)
class Poisson:
    """The equation with source f, conductivity k, reaction c and advection b (numbers or fields).

    ``source=None`` takes the source from the exact solution of the problem.
    """

    source: Field | float | None = 0.0
    conductivity: Field | float = 1.0
    reaction: Field | float = 0.0
    advection: tuple[Field | float, ...] | None = None

    order = 1
    """Highest derivative of u in the energy and in the weak form."""
    strong_order = 2
    """Highest derivative of u in the strong residual."""
    flux_order = 1
    """Highest derivative of u in the natural boundary operator."""
    name = "poisson"
    conditions = scalar_conditions.CONDITIONS
    """Kinds of condition that the equation can have."""
    pictured = ()
    """Derived quantities worth a picture."""

    def components(self, dimension: int) -> int:
        """Return the number of components of u."""
        return 1

    @property
    def symmetric(self) -> bool:
        """Whether there is an energy."""
        return self.advection is None

    def density(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Energy density at the points `coords` (d arrays of one shape); advection has none and is left out.

        Raises
        ------
        DataError
            A datum is not finite and `check` is set.
        """
        k = values("conductivity", self.conductivity, coords, check=check)
        hessian: dict[tuple[int, int], Scalar] = {(i, i): k for i in range(1, len(coords) + 1)}
        if callable(self.reaction) or self.reaction != 0:
            hessian[0, 0] = values("reaction", self.reaction, coords, check=check)
        f = self.source_values(coords, exact, check=check)
        return QuadraticDensity(hessian, {} if isinstance(f, float) and f == 0.0 else {0: f})

    def weak_form(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Form ``k grad v . grad u + v (b . grad u + c u) - f v``: that of the energy, and advection."""
        energy = self.density(coords, exact, check=check)
        if self.advection is None:
            return energy
        form = dict(energy.hessian)  # only diagonal entries so far
        form.update({(0, i): b for i, b in self.advection_row(coords, check=check).items()})
        return QuadraticDensity(form, energy.linear, symmetric=False)

    def residual(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> list[Equality]:
        """Strong residual ``r.v - f`` as pairs (r, f), r a row in the jet of order `strong_order`.

        Raises
        ------
        DataError
            A datum is not finite and `check` is set.
        """
        row = self.strong_row(coords, check=check)
        return [(row, self.source_values(coords, exact, check=check))]

    def flux(self, coords: Sequence[Array], normals: Array, *, check: bool = True) -> list[Row]:
        """Conormal flux ``k grad u . n`` as a row in the jet of order `flux_order`.

        Parameters
        ----------
        coords
            d arrays of one shape, the points.
        normals
            Outward normals, shape (*points, d).
        check
            Refuse data that are not finite.
        """
        k = values("conductivity", self.conductivity, coords, check=check)
        return [{1 + i: k * normals[..., i] for i in range(len(coords))}]

    def strong_row(self, coords: Sequence[Array], *, check: bool = True) -> Row:
        """Row of the differential operator in the jet of order 2."""
        dim, k = len(coords), self.conductivity
        row: dict[int, Scalar] = {}
        diffusion: Scalar
        if callable(k):
            with np.errstate(all="ignore"):
                jet = partials(k, coords, 1)
            if check:
                require_finite("conductivity, or its gradient,", k, coords, jet.sum(axis=0))
            diffusion = jet[0]
            row = {1 + i: -jet[1 + i] for i in range(dim)}
        else:
            diffusion = float(k)
        row.update({i: -diffusion for i, alpha in enumerate(multi_indices(dim, 2)) if max(alpha) == 2})
        if callable(self.reaction) or self.reaction != 0:
            row[0] = values("reaction", self.reaction, coords, check=check)
        return added(row, self.advection_row(coords, check=check))

    def advection_row(self, coords: Sequence[Array], *, check: bool = True) -> Row:
        """Row ``b . grad u`` in a jet of order 1 or more; empty without advection."""
        data = self.advection or ()
        return {1 + i: values("advection", b, coords, check=check) for i, b in enumerate(data)}

    def source_values(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> Scalar:
        """Source f at the points: given, or the differential operator applied to the exact solution."""
        if self.source is not None:
            return values("source", self.source, coords, check=check)
        truth = required(exact)
        with np.errstate(all="ignore"):
            f = apply(self.strong_row(coords, check=check), exact_jet(truth, coords, 2))
        if check:
            require_finite("source of the exact solution", truth, coords, f)
        return f

    def natural_density(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> QuadraticDensity | None:
        """Boundary energy of a condition, in the value of u."""
        return scalar_conditions.natural_density(self.flux, condition, coords, normals, exact)

    def condition_rows(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> list[Equality]:
        """What a condition asks, as a row in the jet of order 1."""
        return scalar_conditions.condition_rows(self.flux, condition, coords, normals, exact)

    def derived(self, coords: Sequence[Array], jet: Array) -> dict[str, dict[str, Array]]:
        """Nothing beside the value and the gradient."""
        return {}

    def motions(self, dimension: int) -> list[Motion]:
        """Return the constant, unless there is a reaction."""
        return [] if callable(self.reaction) or self.reaction != 0 else constants(dimension, 1)
