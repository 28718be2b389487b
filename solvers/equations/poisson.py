r"""Diffusion with reaction: :math:`-\operatorname{div}(k \nabla u) + c u = f`.

Energy density :math:`W = \tfrac12 k |\nabla u|^2 + \tfrac12 c u^2 - f u`; the conormal flux is
:math:`k\,\partial u/\partial n`.  A Neumann part adds :math:`-g u` on the boundary, a Robin part
:math:`\tfrac12 h u^2 - g u`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field
from solvers.data import require_finite, values
from solvers.equations.density import QuadraticDensity


@dataclass(frozen=True)
class Poisson:
    """The equation with source f, conductivity k and reaction c (numbers or fields).

    ``source=None`` takes the source from the exact solution of the problem.
    """

    source: Field | float | None = 0.0
    conductivity: Field | float = 1.0
    reaction: Field | float = 0.0

    order = 1
    """Highest derivative of u in the energy."""

    def density(
        self, coords: Sequence[Array], exact: Field | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Energy density at the points `coords` (d arrays of one shape).

        Raises
        ------
        DataError
            A datum is not finite and `check` is set.
        """
        k = values("conductivity", self.conductivity, coords, check=check)
        hessian: dict[tuple[int, int], Array | float] = {(i, i): k for i in range(1, len(coords) + 1)}
        if callable(self.reaction) or self.reaction != 0:
            hessian[0, 0] = values("reaction", self.reaction, coords, check=check)
        f = self.source_values(coords, exact, check=check)
        return QuadraticDensity(hessian, {} if isinstance(f, float) and f == 0.0 else {0: f})

    def source_values(
        self, coords: Sequence[Array], exact: Field | None, *, check: bool = True
    ) -> Array | float:
        """Source f at the points: given, or -div(k grad u) + c u of the exact solution u."""
        if self.source is not None:
            return values("source", self.source, coords, check=check)
        if exact is None:
            raise ValueError("a source taken from the exact solution needs an exact solution")
        with np.errstate(all="ignore"):
            u = partials(exact, coords, 2)
            dim = len(coords)
            second = [i for i, alpha in enumerate(multi_indices(dim, 2)) if max(alpha) == 2]
            laplacian = u[second].sum(axis=0)
            if callable(self.conductivity):
                k = partials(self.conductivity, coords, 1)
                flux_divergence = k[0] * laplacian + (k[1:] * u[1 : dim + 1]).sum(axis=0)
            else:
                flux_divergence = self.conductivity * laplacian
        c = values("reaction", self.reaction, coords, check=check)
        f: Array = c * u[0] - flux_divergence
        if check:
            require_finite("source of the exact solution", exact, coords, f)
        return f

    def conormal_flux(self, coords: Sequence[Array], gradient: Array, normals: Array) -> Array:
        """``k grad u . n`` from the gradient (d, ...) and the normals (..., d) at the points."""
        k = values("conductivity", self.conductivity, coords)
        flux: Array = k * np.einsum("i...,...i->...", gradient, normals)
        return flux
