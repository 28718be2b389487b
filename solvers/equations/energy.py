r"""The equation of a quadratic energy density that somebody else wrote, as plain arithmetic.

The density W is a function of the point and of the derivatives of u; everything the solvers need follows from it.
It is quadratic in the jet v, :math:`W = \tfrac12 v^T H v - l^T v + c`, so that

.. math:: H_{ij} = W(e_i + e_j) - W(e_i) - W(e_j) + W(0), \qquad l_i = \tfrac12 (W(-e_i) - W(e_i)),

without any differentiation; the strong residual is that of Euler and Lagrange,

.. math:: \sum_\beta (-1)^{|\beta|} \partial^\beta \bigl( (H v)_\beta - l_\beta \bigr) = 0,

and the natural boundary operator of a density of first order is
:math:`\sum_i n_i\, \partial W / \partial(\partial_i u_c)`.
An example is in ``docs/equations.md``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from math import comb, prod
from types import SimpleNamespace

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Value
from rfm.errors import RfmError
from solvers.data import require_finite
from solvers.equations import plate_conditions, scalar_conditions, vector_conditions
from solvers.equations.density import QuadraticDensity
from solvers.equations.motions import Motion
from solvers.equations.rows import Equality, Row, Scalar, apply
from solvers.exact import Exact, components_of, exact_jet, required
from solvers.problem import (
    Clamped,
    Condition,
    Dirichlet,
    Free,
    Pressure,
    SimplySupported,
    Slip,
    Traction,
)

MultiIndex = tuple[int, ...]
WrittenDensity = Callable[..., Value]
"""``W(x, y, u)`` or ``W(x, y, z, u)``; u has the attributes ``value, x, y, xx, xy, yy, ...``, of a vector it is a tuple
of such components."""

QUADRATIC = 1e-9
"""Relative deviation from a quadratic function that counts as rounding."""

CONDITIONS: dict[tuple[bool, int], tuple[type, ...]] = {
    (False, 1): scalar_conditions.CONDITIONS,
    (True, 1): (Dirichlet, Traction, Pressure, Slip),
    (False, 2): (Clamped, SimplySupported, Free),
}
"""Kinds of condition, by whether u is a vector and the order."""


@dataclass(frozen=True)
class Energy:
    """An equation from its energy density.

    Attributes
    ----------
    written
        The density, see :data:`WrittenDensity`.
    order
        Highest derivative in it, 1 or 2.
    count
        Number of components of u, 1 or the number of coordinates.
    source_from_exact
        Add the linear term that makes the exact solution of the problem its solution.
    free
        Affine fields without energy, needed when the conditions do not hold them.
    name
        What it is called.

    Raises
    ------
    RfmError
        Order and count are not those of :data:`CONDITIONS`.
    """

    written: WrittenDensity
    order: int = 1
    count: int = 1
    source_from_exact: bool = False
    free: tuple[Motion, ...] = ()
    name: str = "energy"

    symmetric = True
    pictured = ()

    def __post_init__(self) -> None:
        """Check order and count."""
        if (self.count > 1, self.order) not in CONDITIONS:
            raise RfmError(
                f"a density of order {self.order} with {self.count} components is not supported: "
                "scalars have order 1 or 2, vectors order 1"
            )

    @property
    def strong_order(self) -> int:
        """Highest derivative of u in the residual."""
        return 2 * self.order

    @property
    def flux_order(self) -> int:
        """Highest derivative of u in a boundary condition."""
        return 1

    @property
    def conditions(self) -> tuple[type, ...]:
        """Kinds of condition that can be posed."""
        return CONDITIONS[self.count > 1, self.order]

    def components(self, dimension: int) -> int:
        """Return the number of components of u.

        Raises
        ------
        RfmError
            A vector does not have one for each coordinate.
        """
        if self.count not in (1, dimension):
            raise RfmError(
                f"the density is of a vector of {self.count} components, the domain has {dimension}"
            )
        return self.count

    def density(
        self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True
    ) -> QuadraticDensity:
        """Energy density at the points, in the jet of `order`.

        Raises
        ------
        RfmError
            The density is not quadratic in the jet.
        DataError
            It is not finite at some point and `check` is set.
        """
        found = self._form(coords)
        if check:
            self._check(coords, found)
        if not self.source_from_exact:
            return found
        width = len(multi_indices(len(coords), self.order))
        linear = dict(found.linear)
        for c, source in enumerate(self._sources(coords, exact, check=check)):
            linear[c * width] = linear.get(c * width, 0.0) + source
        return QuadraticDensity(found.hessian, linear)

    weak_form = density

    def residual(self, coords: Sequence[Array], exact: Exact | None, *, check: bool = True) -> list[Equality]:
        """Euler and Lagrange's equations, rows in the jet of twice the order."""
        equations = self._euler(coords)
        if not self.source_from_exact:
            return equations
        sources = self._sources(coords, exact, check=check)
        return [(row, right + source) for (row, right), source in zip(equations, sources, strict=True)]

    def flux(self, coords: Sequence[Array], normals: Array, *, check: bool = True) -> list[Row]:
        """Natural boundary operators of a density of first order, rows in the jet of order 1."""
        if self.order > 1:
            return []
        dimension, columns = len(coords), self._form(coords).columns()
        rows: list[Row] = []
        for c in range(self.count):
            row: dict[int, Scalar] = {}
            for i in range(dimension):
                for other, entry in columns.get(c * (dimension + 1) + 1 + i, ()):
                    row[other] = row.get(other, 0.0) + entry * normals[..., i]
            rows.append(row)
        return rows

    def natural_density(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> QuadraticDensity | None:
        """Boundary energy of a condition; natural conditions of a plate must be homogeneous."""
        if self.order > 1:
            return None
        if self.count == 1:
            return scalar_conditions.natural_density(self.flux, condition, coords, normals, exact)
        return vector_conditions.natural_density(self.flux, condition, coords, normals, exact)

    def condition_rows(
        self, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
    ) -> list[Equality]:
        """What a condition asks, as rows in the jet of order 1; of a plate the essential part."""
        if self.order > 1:
            return plate_conditions.essential_rows(condition, coords, normals, exact)
        if self.count == 1:
            return scalar_conditions.condition_rows(self.flux, condition, coords, normals, exact)
        return vector_conditions.condition_rows(self.flux, condition, coords, normals, exact)

    def derived(self, coords: Sequence[Array], jet: Array) -> dict[str, dict[str, Array]]:
        """Nothing beside the value and the gradient."""
        return {}

    def motions(self, dimension: int) -> list[Motion]:
        """Return the fields that were given as free."""
        return list(self.free)

    def _form(self, coords: Sequence[Value]) -> QuadraticDensity:
        """H and l as they are written."""
        size = self.count * len(multi_indices(len(coords), self.order))
        units = np.eye(size)
        base = self._at(coords, np.zeros(size))
        plus, minus = ([self._at(coords, sign * unit) for unit in units] for sign in (1.0, -1.0))
        linear = {i: 0.5 * (minus[i] - plus[i]) for i in range(size)}
        hessian = {(i, i): plus[i] + minus[i] - 2 * base for i in range(size)}
        for i in range(size):
            for j in range(i + 1, size):
                hessian[i, j] = self._at(coords, units[i] + units[j]) - plus[i] - plus[j] + base
        return QuadraticDensity(
            {key: entry for key, entry in hessian.items() if not _vanishes(entry)},
            {key: entry for key, entry in linear.items() if not _vanishes(entry)},
        )

    def _at(self, coords: Sequence[Value], jet: Array) -> Value:
        """W at the points for one constant jet."""
        alphas = multi_indices(len(coords), self.order)
        components = [
            SimpleNamespace(**{attribute(alpha): float(v) for alpha, v in zip(alphas, part, strict=True)})
            for part in jet.reshape(self.count, -1)
        ]
        return self.written(*coords, components[0] if self.count == 1 else tuple(components))

    def _check(self, coords: Sequence[Array], form: QuadraticDensity) -> None:
        """Compare W with its quadratic form at a generic jet."""
        size = self.count * len(multi_indices(len(coords), self.order))
        jet = np.cos(np.arange(1.0, size + 1))
        start = self._at(coords, np.zeros(size))
        shape = np.broadcast_shapes(*(np.shape(c) for c in coords))
        expected = start - sum(entry * jet[i] for i, entry in form.linear.items())
        for (i, j), entry in form.hessian.items():
            expected = expected + (0.5 if i == j else 1.0) * entry * jet[i] * jet[j]
        found = np.broadcast_to(self._at(coords, jet), shape)
        require_finite("energy density", self.written, coords, np.asarray(found))
        if np.any(np.abs(found - expected) > QUADRATIC * (np.abs(found) + np.abs(expected) + np.abs(start))):
            raise RfmError(
                "the energy density is not quadratic in u and its derivatives: write it as a sum of products of at "
                "most two of them"
            )

    def _sources(self, coords: Sequence[Array], exact: Exact | None, *, check: bool) -> list[Scalar]:
        """Source that makes the exact solution satisfy Euler and Lagrange's equations."""
        truth = required(exact)
        with np.errstate(all="ignore"):
            jet = exact_jet(truth, coords, self.strong_order)
            sources: list[Scalar] = [apply(row, jet) - right for row, right in self._euler(coords)]
        if check:
            for component, source in zip(components_of(truth), sources, strict=True):
                require_finite("source of the exact solution", component, coords, np.asarray(source))
        return sources

    def _euler(self, coords: Sequence[Array]) -> list[Equality]:
        """Rows and right-hand sides of Euler and Lagrange's equations, by Leibniz' rule."""
        dimension = len(coords)
        alphas = multi_indices(dimension, self.order)
        width = len(alphas)
        position = {alpha: k for k, alpha in enumerate(multi_indices(dimension, self.strong_order))}
        pattern = self._form(coords)
        columns = pattern.columns()
        equations: list[Equality] = []
        for c in range(self.count):
            row: dict[int, Scalar] = {}
            right: Scalar = 0.0
            for k, beta in enumerate(alphas):
                sign = (-1.0) ** sum(beta)
                if c * width + k in pattern.linear:
                    right = right + sign * self._derivative(coords, (c * width + k,), beta)
                for other, _ in columns.get(c * width + k, ()):
                    component, alpha = divmod(other, width)
                    for gamma in product(*(range(b + 1) for b in beta)):
                        raised = tuple(a + b - g for a, b, g in zip(alphas[alpha], beta, gamma, strict=True))
                        times = sign * prod(comb(b, g) for b, g in zip(beta, gamma, strict=True))
                        at = component * len(position) + position[raised]
                        entry = self._derivative(coords, (other, c * width + k), gamma)
                        row[at] = row.get(at, 0.0) + times * entry
            equations.append((row, right))
        return equations

    def _derivative(self, coords: Sequence[Array], key: tuple[int, ...], gamma: MultiIndex) -> Array:
        """``d^gamma`` of an entry of H or l."""
        key = tuple(sorted(key))

        def entry(*x: Value) -> Value:
            form = self._form(x)
            return form.hessian.get((key[0], key[1]), 0.0) if len(key) == 2 else form.linear.get(key[0], 0.0)

        order = sum(gamma)
        found: Array = partials(entry, coords, order)[multi_indices(len(coords), order).index(gamma)]
        return found


def attribute(alpha: MultiIndex) -> str:
    """Name of a derivative: ``value``, ``x``, ``xy``, ..."""
    return "".join("xyz"[axis] * times for axis, times in enumerate(alpha)) or "value"


def _vanishes(entry: Value) -> bool:
    return isinstance(entry, int | float | np.ndarray) and not np.any(entry)
