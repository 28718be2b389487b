r"""Linear elasticity: :math:`-\operatorname{div}\sigma = f` for the displacement u of an isotropic body.

The stress is :math:`\sigma = \lambda \operatorname{tr}(\varepsilon) I + 2\mu\varepsilon`, the strain
:math:`\varepsilon_{ij} = \tfrac12(\partial_j u_i + \partial_i u_j)`, and the energy density is

.. math:: W = \tfrac12 \lambda (\operatorname{div} u)^2 + \mu\, \varepsilon : \varepsilon - f \cdot u .

The natural operator of the boundary is the traction :math:`t = \sigma n`.  The moduli follow from Young's modulus
E and Poisson's ratio :math:`\nu` (Sadd, *Elasticity*, 2009, tables 4.1 and 7.1):

===================  ===================================================  =================================
model                :math:`\lambda`                                      :math:`\mu`
===================  ===================================================  =================================
three_dimensional    :math:`E\nu / ((1 + \nu)(1 - 2\nu))`                 :math:`E / (2 (1 + \nu))`
plane_strain         the same                                             the same
plane_stress         :math:`E\nu / (1 - \nu^2)`                           the same
===================  ===================================================  =================================

The jet of u has the entry ``c * n_beta + beta`` for :math:`\partial^\beta u_c`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Field, Value
from rfm.errors import RfmError
from solvers.data import as_field, require_finite, values
from solvers.equations import vector_conditions
from solvers.equations.density import QuadraticDensity, squared
from solvers.equations.motions import Motion, constants, rotations
from solvers.equations.rows import Equality, Row, Scalar, apply
from solvers.exact import Exact, components_of, exact_jet, required
from solvers.problem import Condition


def _bulk(young: Value, ratio: Value) -> Value:
    return young * ratio / ((1 + ratio) * (1 - 2 * ratio))


def _plane_stress(young: Value, ratio: Value) -> Value:
    return young * ratio / (1 - ratio * ratio)


@dataclass(frozen=True)
class Model:
    """What a model assumes: its dimension, the modulus lambda(E, nu), and whether the third direction is held."""

    dimension: int
    first_modulus: Callable[[Value, Value], Value]
    held: bool = False


MODELS: Mapping[str, Model] = {
    "plane_stress": Model(2, _plane_stress),
    "plane_strain": Model(2, _bulk, held=True),
    "three_dimensional": Model(3, _bulk),
}
"""The models by name."""


@dataclass(frozen=True)
class Elasticity:
    """Small displacements of an isotropic elastic body.

    Attributes
    ----------
    model
        One of :data:`MODELS`.
    young_modulus, poisson_ratio
        E > 0 and nu, numbers or fields.
    body_force
        Force on a unit of volume, one number or field for each component; None takes it from the exact solution.

    Raises
    ------
    RfmError
        The model is unknown, or Poisson's ratio is a number outside (-1, 1/2).
    """

    model: str = "plane_stress"
    young_modulus: Field | float = 1.0
    poisson_ratio: Field | float = 0.3
    body_force: tuple[Field | float, ...] | None = (0.0, 0.0)

    name = "elasticity"
    order = 1
    """Highest derivative of u in the energy."""
    strong_order = 2
    """Highest derivative of u in the residual."""
    flux_order = 1
    """Highest derivative of u in a boundary condition."""
    conditions = vector_conditions.CONDITIONS
    """Kinds of condition that can be posed."""
    symmetric = True
    pictured = ("von_mises",)
    """Derived quantities worth a picture."""

    def __post_init__(self) -> None:
        """Check what can be checked without points."""
        if self.model not in MODELS:
            raise RfmError(f"unknown model {self.model!r} of elasticity: choose one of {', '.join(MODELS)}")
        ratio = self.poisson_ratio
        if not callable(ratio) and not -1 < ratio < 0.5:
            raise RfmError(f"poisson_ratio must be above -1 and below 0.5, got {ratio:g}")
        if not callable(self.young_modulus) and not self.young_modulus > 0:
            raise RfmError(f"young_modulus must be positive, got {self.young_modulus:g}")

    def components(self, dimension: int) -> int:
        """One displacement for each coordinate.

        Raises
        ------
        RfmError
            The model is one of the other dimension.
        """
        if dimension != MODELS[self.model].dimension:
            fitting = " or ".join(name for name, model in MODELS.items() if model.dimension == dimension)
            raise RfmError(f"the model {self.model} is not one of {dimension} dimensions: choose {fitting}")
        return dimension

    def moduli(self, coords: Sequence[Array], *, check: bool = True) -> tuple[Scalar, Scalar]:
        """Return lambda and mu at the points."""
        young = values("young_modulus", self.young_modulus, coords, check=check)
        ratio = values("poisson_ratio", self.poisson_ratio, coords, check=check)
        return self.first_modulus(young, ratio), young / (2 * (1 + ratio))

    def density(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Energy density at the points, in the jet of order 1.

        Raises
        ------
        DataError
            A datum is not finite and `check` is set.
        """
        first, shear = self.moduli(coords, check=check)
        dimension = len(coords)
        stretches, shears = strain_rows(dimension)
        dilatation = {position: 1.0 for row in stretches for position in row}
        elastic = squared(
            [
                (dilatation, 0.0, first),
                *((row, 0.0, 2 * shear) for row in stretches),
                *((row, 0.0, shear) for row in shears),
            ]
        )
        force = self.force(coords, exact, check=check)
        width = dimension + 1
        loads = {c * width: f for c, f in enumerate(force) if not (isinstance(f, float) and f == 0.0)}
        return QuadraticDensity(elastic.hessian, loads)

    weak_form = density

    def force(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> list[Scalar]:
        """Body force at the points: given, or ``-div sigma`` of the exact solution."""
        if self.body_force is not None:
            return [
                values(f"body_force[{c}]", datum, coords, check=check)
                for c, datum in enumerate(self.body_force)
            ]
        truth = required(exact)
        with np.errstate(all="ignore"):
            jet = exact_jet(truth, coords, 2)
            forces: list[Scalar] = [apply(row, jet) for row in self._divergence(coords, check=check)]
        if check:
            for component, force in zip(components_of(truth), forces, strict=True):
                require_finite("body force of the exact solution", component, coords, np.asarray(force))
        return forces

    def residual(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> list[Equality]:
        """Rows of ``-div sigma = f`` in the jet of order 2, one for each component."""
        rows = self._divergence(coords, check=check)
        return list(zip(rows, self.force(coords, exact, check=check), strict=True))

    def _divergence(self, coords: Sequence[Array], *, check: bool) -> list[Row]:
        """Rows of ``-div sigma`` in the jet of order 2, with the gradients of the moduli."""
        dimension = len(coords)
        position = {alpha: k for k, alpha in enumerate(multi_indices(dimension, 2))}
        width = len(position)
        first, shear = self.moduli(coords, check=check)
        slopes = self._slopes(coords)
        rows: list[Row] = []
        for i in range(dimension):
            row: dict[int, Scalar] = {}
            for j in range(dimension):
                mixed = j * width + position[unit_sum(dimension, i, j)]
                row[mixed] = row.get(mixed, 0.0) - (first + shear)
                straight = i * width + position[unit_sum(dimension, j, j)]
                row[straight] = row.get(straight, 0.0) - shear
                if slopes is not None:
                    for at, entry in (
                        (j * width + 1 + j, slopes[0][i]),
                        (i * width + 1 + j, slopes[1][j]),
                        (j * width + 1 + i, slopes[1][j]),
                    ):
                        row[at] = row.get(at, 0.0) - entry
            rows.append(row)
        return rows

    def _slopes(self, coords: Sequence[Array]) -> tuple[Array, Array] | None:
        """Gradients of lambda and mu, None when both are constant."""
        if not callable(self.young_modulus) and not callable(self.poisson_ratio):
            return None
        young, ratio = (as_field(datum) for datum in (self.young_modulus, self.poisson_ratio))

        def first(*x: object) -> object:
            return self.first_modulus(young(*x), ratio(*x))

        def shear(*x: object) -> object:
            return young(*x) / (2 * (1 + ratio(*x)))

        return partials(first, coords, 1)[1:], partials(shear, coords, 1)[1:]

    def first_modulus(self, young: Value, ratio: Value) -> Value:
        """Return lambda(E, nu) of the model, of values of any kind."""
        return MODELS[self.model].first_modulus(young, ratio)

    def flux(self, coords: Sequence[Array], normals: Array, *, check: bool = True) -> list[Row]:
        """Rows of the traction ``sigma n`` in the jet of order 1; normals (..., d) point outward."""
        first, shear = self.moduli(coords, check=check)
        dimension = len(coords)
        width = dimension + 1
        rows: list[Row] = []
        for i in range(dimension):
            row: dict[int, Scalar] = {}
            for j in range(dimension):
                for at, entry in (
                    (j * width + 1 + j, first * normals[..., i]),
                    (i * width + 1 + j, shear * normals[..., j]),
                    (j * width + 1 + i, shear * normals[..., j]),
                ):
                    row[at] = row[at] + entry if at in row else entry
            rows.append(row)
        return rows

    def derived(self, coords: Sequence[Array], jet: Array) -> dict[str, dict[str, Array]]:
        """Stress components at the points from the jet of order 1, and von Mises' equivalent stress."""
        dimension = len(coords)
        letters = "xyz"[:dimension]
        columns = [
            self.flux(coords, np.broadcast_to(np.eye(dimension)[j], (*jet.shape[1:], dimension)))
            for j in range(dimension)
        ]
        sigma = np.array([[apply(columns[j][i], jet) for j in range(dimension)] for i in range(dimension)])
        found = {
            f"{letters[i]}{letters[j]}": sigma[i, j] for i in range(dimension) for j in range(i, dimension)
        }
        ratio = values("poisson_ratio", self.poisson_ratio, coords)
        if MODELS[self.model].held:
            found["zz"] = ratio * (sigma[0, 0] + sigma[1, 1])
        return {"stress": {**found, "von_mises": von_mises(found)}}

    def natural_density(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> QuadraticDensity | None:
        """Work ``-t.u`` of a prescribed traction, in the values of u (the jet of order 0)."""
        return vector_conditions.natural_density(self.flux, condition, coords, normals, exact)

    def condition_rows(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> list[Equality]:
        """What a condition asks, as rows in the jet of order 1."""
        return vector_conditions.condition_rows(self.flux, condition, coords, normals, exact)

    def motions(self, dimension: int) -> list[Motion]:
        """Rigid motions, which the energy does not see."""
        return constants(dimension, dimension) + rotations(dimension)


def strain_rows(dimension: int) -> tuple[list[Row], list[Row]]:
    """Rows of the stretches and of the shears 2 epsilon_ij (i < j) in the jet of order 1."""
    width = dimension + 1
    stretches: list[Row] = [{i * width + 1 + i: 1.0} for i in range(dimension)]
    shears: list[Row] = [
        {i * width + 1 + j: 1.0, j * width + 1 + i: 1.0}
        for i in range(dimension)
        for j in range(i + 1, dimension)
    ]
    return stretches, shears


def unit_sum(dimension: int, i: int, j: int) -> tuple[int, ...]:
    """Multi-index of the second derivative d_i d_j."""
    return tuple((k == i) + (k == j) for k in range(dimension))


def von_mises(stress: Mapping[str, Array]) -> Array:
    """Equivalent stress sqrt(3/2 s : s), s the deviator, from stress components by name."""
    xx, yy, zz = (stress.get(name, np.zeros(())) for name in ("xx", "yy", "zz"))
    shear = sum(stress[name] ** 2 for name in ("xy", "xz", "yz") if name in stress)
    result: Array = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * shear)
    return result
