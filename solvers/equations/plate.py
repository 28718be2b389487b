r"""Kirchhoff's plate: :math:`-\operatorname{div}\operatorname{div} m = q` for the deflection w under a load q.

With the stiffness D, Poisson's ratio :math:`\nu` and H the matrix of second derivatives of w, the moments are
:math:`m = -D (\nu \Delta w\, I + (1 - \nu) H)` and the energy density is

.. math:: W = \tfrac12 D \bigl[(\Delta w)^2 - 2 (1 - \nu) (w_{xx} w_{yy} - w_{xy}^2)\bigr] - q w .

On an edge with outward normal n, tangent t = (-n_y, n_x) and curvature :math:`\kappa` (that of a disk is positive)

.. math:: M = n \cdot m n, \qquad V = \operatorname{div} m \cdot n + \partial_t (n \cdot m t)
    = \operatorname{div} m \cdot n + t \cdot \nabla m : (n \otimes t) + \kappa (t \cdot m t - n \cdot m n)

are the bending moment and Kirchhoff's shear force (Timoshenko and Woinowsky-Krieger, *Theory of Plates and Shells*,
sections 21 and 22, whose signs these are).  Both are natural: prescribed values add
:math:`M\,\partial w/\partial n - V w` to the energy.  Two free edges that meet at a corner have no
concentrated force there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import comb

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field
from rfm.errors import RfmError
from rfm.geometry.part import Part
from solvers.data import require_finite, values
from solvers.equations import plate_conditions
from solvers.equations.density import QuadraticDensity
from solvers.equations.motions import Motion, constants, tilts
from solvers.equations.rows import Equality, Row, Scalar, added, apply, scaled
from solvers.exact import Exact, components_of, exact_jet, required
from solvers.problem import Clamped, Condition, Datum, Free, FromExact, SimplySupported

Index = tuple[int, int]
Coefficients = Mapping[Index, Scalar]
"""Partial derivatives of a coefficient, the zero ones left out."""

PLACES = ((0, 0), (0, 1), (1, 1))
"""The entries of a symmetric matrix."""


@dataclass(frozen=True)
class Plate:
    """A thin elastic plate.

    Attributes
    ----------
    stiffness
        D > 0, number or field.
    poisson_ratio
        nu.
    load
        Force q on a unit of area, number or field; None takes it from the exact solution.

    Raises
    ------
    RfmError
        Poisson's ratio is outside (-1, 1/2], or the stiffness is a number that is not positive.
    """

    stiffness: Field | float = 1.0
    poisson_ratio: float = 0.3
    load: Field | float | None = 0.0

    name = "plate"
    order = 2
    """Highest derivative of w in the energy."""
    strong_order = 4
    """Highest derivative of w in the residual."""
    flux_order = 3
    """Highest derivative of w in a boundary condition."""
    symmetric = True
    conditions = (Clamped, SimplySupported, Free)
    """Kinds of condition that can be posed."""
    pictured = ()
    """Derived quantities worth a picture."""

    def __post_init__(self) -> None:
        """Check what can be checked without points."""
        if not -1 < self.poisson_ratio <= 0.5:
            raise RfmError(f"poisson_ratio must be above -1 and at most 0.5, got {self.poisson_ratio:g}")
        if not callable(self.stiffness) and not self.stiffness > 0:
            raise RfmError(f"stiffness must be positive, got {self.stiffness:g}")

    def components(self, dimension: int) -> int:
        """One deflection.

        Raises
        ------
        RfmError
            The domain is not plane.
        """
        if dimension != 2:
            raise RfmError(f"a plate is plane, the domain has {dimension} dimensions: use elasticity")
        return 1

    def density(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Energy density at the points, in the jet of order 2.

        Raises
        ------
        DataError
            A datum is not finite and `check` is set.
        """
        stiffness = values("stiffness", self.stiffness, coords, check=check)
        xx, xy, yy = (multi_indices(2, 2).index(alpha) for alpha in ((2, 0), (1, 1), (0, 2)))
        hessian = {
            (xx, xx): stiffness,
            (yy, yy): stiffness,
            (xx, yy): stiffness * self.poisson_ratio,
            (xy, xy): stiffness * (2 * (1 - self.poisson_ratio)),
        }
        q = self.load_values(coords, exact, check=check)
        return QuadraticDensity(
            {(min(k), max(k)): entry for k, entry in hessian.items()},
            {} if isinstance(q, float) and q == 0.0 else {0: q},
        )

    weak_form = density

    def load_values(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> Scalar:
        """Load at the points: given, or the differential operator applied to the exact solution."""
        if self.load is not None:
            return values("load", self.load, coords, check=check)
        with np.errstate(all="ignore"):
            load = apply(self._strong_row(coords), exact_jet(required(exact), coords, 4))
        if check:
            require_finite("load of the exact solution", components_of(required(exact))[0], coords, load)
        return load

    def residual(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> list[Equality]:
        """Row of ``-div div m = q`` in the jet of order 4."""
        return [(self._strong_row(coords), self.load_values(coords, exact, check=check))]

    def flux(self, coords: Sequence[Array], normals: Array, *, check: bool = True) -> list[Row]:
        """Rows of M and of V, this without its curvature term, in the jet of order 3."""
        return self._edge_rows(coords, normals, 0.0)

    def condition_rows(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> list[Equality]:
        """What a condition asks, as rows in the jet of order 3."""
        asked = plate_conditions.essential(condition, normals)
        if not isinstance(condition, Clamped):
            bend = curvature(condition.part, coords, normals)
            moment, shear = self._edge_rows(coords, normals, bend)
        match condition:
            case Clamped():
                pass
            case SimplySupported(moment=bending):
                asked += [("moment", moment, bending)]
            case Free(moment=bending, shear=force):
                asked += [("moment", moment, bending), ("shear", shear, force)]
            case _:
                raise TypeError(f"a plate has no condition {type(condition).__name__}")
        return [plate_conditions.resolved(item, coords, exact, self.flux_order) for item in asked]

    def natural_density(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> QuadraticDensity | None:
        """Work of the moment and of the shear force, in the jet of order 1.

        Those of the exact solution act as ``m n . grad w - div m . n w``, which needs no curvature and has the
        concentrated forces at corners in it.
        """
        match condition:
            case SimplySupported(moment=moment):
                given: tuple[Datum | FromExact, Datum | FromExact] = (moment, 0.0)
            case Free(moment=moment, shear=shear):
                given = (moment, shear)
            case _:
                return None
        loads: dict[int, Scalar] = {}
        if any(isinstance(datum, FromExact) for datum in given):
            jet = exact_jet(required(exact), coords, 3)
            if isinstance(given[0], FromExact):
                for i in range(2):
                    traction = sum(apply(self._moment(coords, i, j), jet) * normals[..., j] for j in range(2))
                    loads[1 + i] = -traction
            if isinstance(given[1], FromExact):
                loads[0] = apply(self._shear_row(coords, normals), jet)
        moment, shear = given
        if not isinstance(moment, FromExact):
            bending = values("moment", moment, coords)
            loads.update({1 + i: -bending * normals[..., i] for i in range(2)})
        if not isinstance(shear, FromExact):
            loads[0] = values("shear", shear, coords)
        return QuadraticDensity({}, loads)

    def derived(self, coords: Sequence[Array], jet: Array) -> dict[str, dict[str, Array]]:
        """Moments at the points, from the jet of order 2."""
        rows = {f"{'xy'[i]}{'xy'[j]}": self._moment(coords, i, j) for i, j in PLACES}
        return {"moment": {name: apply(row, jet) for name, row in rows.items()}}

    def motions(self, dimension: int) -> list[Motion]:
        """Translation and tilts, which the energy does not see."""
        return constants(dimension, 1) + tilts(dimension)

    def _edge_rows(self, coords: Sequence[Array], normals: Array, bend: Scalar) -> list[Row]:
        """Rows of M and V in the jet of order 3, on an edge with the curvature `bend`."""
        n = [normals[..., 0], normals[..., 1]]
        t = [-n[1], n[0]]
        entries = {place: self._moment(coords, *place) for place in PLACES}
        moment: Row = {}
        shear = self._shear_row(coords, normals)
        for i, j in product(range(2), repeat=2):
            entry = entries[min(i, j), max(i, j)]
            moment = added(moment, scaled(n[i] * n[j], entry))
            for k in range(2):
                slope = self._moment(coords, i, j, (k == 0, k == 1))
                shear = added(shear, scaled(t[k] * n[i] * t[j], slope))
            shear = added(shear, scaled(bend * (t[i] * t[j] - n[i] * n[j]), entry))
        return [moment, shear]

    def _shear_row(self, coords: Sequence[Array], normals: Array) -> Row:
        """Row of ``div m . n`` in the jet of order 3."""
        row: Row = {}
        for i, j in product(range(2), repeat=2):
            row = added(row, scaled(normals[..., i], self._moment(coords, i, j, (j == 0, j == 1))))
        return row

    def _strong_row(self, coords: Sequence[Array]) -> Row:
        """Row of ``-div div m`` in the jet of order 4."""
        row: Row = {}
        for i, j in product(range(2), repeat=2):
            twice = ((i == 0) + (j == 0), (i == 1) + (j == 1))
            row = added(row, scaled(-1.0, self._moment(coords, i, j, twice)))
        return row

    def _moment(self, coords: Sequence[Array], i: int, j: int, alpha: Sequence[int] = (0, 0)) -> Row:
        """Row of the derivative ``d^alpha m_ij``."""
        d = self._stiffness(coords, sum(alpha))
        nu = self.poisson_ratio
        if i != j:
            return differentiated({(1, 1): {g: -(1 - nu) * v for g, v in d.items()}}, alpha)
        along, across = ((2, 0), (0, 2)) if i == 0 else ((0, 2), (2, 0))
        return differentiated(
            {along: {g: -v for g, v in d.items()}, across: {g: -nu * v for g, v in d.items()}}, alpha
        )

    def _stiffness(self, coords: Sequence[Array], order: int) -> Coefficients:
        if not callable(self.stiffness):
            return {(0, 0): float(self.stiffness)}
        jet = partials(self.stiffness, coords, order)
        return dict(zip(multi_indices(2, order), jet, strict=True))  # type: ignore[arg-type]


def differentiated(terms: Mapping[Index, Coefficients], alpha: Sequence[int]) -> Row:
    """Row of ``d^alpha sum_beta a_beta d^beta w`` by Leibniz' rule, for coefficients with their derivatives."""
    row: dict[int, Scalar] = {}
    for beta, derivatives in terms.items():
        for gamma in product(range(alpha[0] + 1), range(alpha[1] + 1)):
            if gamma not in derivatives:
                continue
            times = comb(alpha[0], gamma[0]) * comb(alpha[1], gamma[1])
            raised = (beta[0] + alpha[0] - gamma[0], beta[1] + alpha[1] - gamma[1])
            position = multi_indices(2, sum(raised)).index(raised)
            row[position] = row.get(position, 0.0) + times * derivatives[gamma]
    return row


def curvature(part: Part, coords: Sequence[Array], normals: Array) -> Array:
    """Curvature of the boundary at points of a part: div n, positive where the domain bulges."""
    bends, distances = [], []
    for surface in sorted(part.surfaces, key=lambda s: s.label):
        f = partials(surface.function, coords, 2)
        slope = np.hypot(f[1], f[2])
        level = (f[3] * f[2] ** 2 - 2 * f[4] * f[1] * f[2] + f[5] * f[1] ** 2) / slope**3
        # the surface function may have either sign in the domain: the normal tells
        sign = np.sign(f[1] * normals[..., 0] + f[2] * normals[..., 1])
        bends.append(sign * level)
        distances.append(np.abs(f[0]) / slope)
    nearest = np.argmin(distances, axis=0)
    result: Array = np.take_along_axis(np.array(bends), nearest[None], axis=0)[0]
    return result
