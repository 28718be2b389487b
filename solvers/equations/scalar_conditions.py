r"""Dirichlet, Neumann, Robin and oblique conditions of a scalar equation of second order with a flux.

A Neumann part adds :math:`-g u` to the energy, a Robin part :math:`\tfrac12 h u^2 - g u`; see
:mod:`solvers.problem` for the conditions.

Of an oblique derivative :math:`b \cdot \nabla u + h u = g` the weak form takes the conormal flux.  With c its vector
(:math:`c = k n`),

.. math:: c \cdot \nabla u = a\,(g - h u) + t \cdot \nabla u, \qquad a = \frac{c \cdot n}{b \cdot n}, \quad
          t = c - a\, b,

t is tangential.  The form of the boundary has the derivative of u along t and is not symmetric: there is no energy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rfm.calculus.types import Array
from solvers.data import values
from solvers.equations.density import QuadraticDensity
from solvers.equations.rows import Equality, Row, Scalar, added, apply
from solvers.exact import Exact, exact_jet, required
from solvers.problem import Condition, Dirichlet, FromExact, Neumann, Oblique, Robin

Flux = Callable[[Sequence[Array], Array], list[Row]]
"""Rows of the conormal flux in the jet of order 1, from points and outward normals."""

CONDITIONS = (Dirichlet, Neumann, Robin, Oblique)


def condition_rows(
    flux: Flux, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
) -> list[Equality]:
    """The row of a condition and the value that it is to take, with `from exact` resolved."""
    row: Row
    match condition:
        case Dirichlet(value=value):
            name, row = "Dirichlet value", {0: 1.0}
        case Neumann(flux=value):
            name, row = "flux", flux(coords, normals)[0]
        case Robin(coefficient=coefficient, value=value):
            stiff = values("Robin coefficient", coefficient, coords)
            name, row = "Robin value", added(flux(coords, normals)[0], {0: stiff})
        case Oblique(direction=direction, coefficient=coefficient, value=value):
            name = "oblique value"
            row = {1 + i: values(f"direction[{i}]", b, coords) for i, b in enumerate(direction)}
            if callable(coefficient) or coefficient != 0:
                row = added(row, {0: values("oblique coefficient", coefficient, coords)})
        case _:
            raise TypeError(f"a scalar equation has no condition {type(condition).__name__}")
    right: Scalar
    if isinstance(value, FromExact):
        right = apply(row, exact_jet(required(exact), coords, 1))
    elif isinstance(value, tuple):
        raise TypeError("the Dirichlet value of a scalar is one datum, not a tuple")
    else:
        right = values(name, value, coords)
    return [(row, right)]


def natural_density(
    flux: Flux, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
) -> QuadraticDensity | None:
    """Boundary energy of a condition in the value of u, or weak form in its jet of order 1; None of Dirichlet's."""
    if isinstance(condition, Dirichlet):
        return None
    ((row, right),) = condition_rows(flux, condition, coords, normals, exact)
    if isinstance(condition, Oblique):
        return _oblique(flux(coords, normals)[0], row, right, normals)
    hessian: dict[tuple[int, int], Scalar] = {}
    if isinstance(condition, Robin):
        hessian[0, 0] = values("Robin coefficient", condition.coefficient, coords)
    return QuadraticDensity(hessian, {0: right})


def _oblique(conormal: Row, row: Row, right: Scalar, normals: Array) -> QuadraticDensity:
    """Weak form of minus the conormal flux: row 0 of the form is the value of the test field."""
    axes = range(normals.shape[-1])
    flux, along = (sum(r.get(1 + i, 0.0) * normals[..., i] for i in axes) for r in (conormal, row))
    ratio = flux / along
    form: dict[tuple[int, int], Scalar] = {
        (0, 1 + i): ratio * row.get(1 + i, 0.0) - conormal.get(1 + i, 0.0) for i in axes
    }
    if 0 in row:
        form[0, 0] = ratio * row[0]
    return QuadraticDensity(form, {0: ratio * right}, symmetric=False)
