r"""Dirichlet, Neumann and Robin conditions of a scalar equation of second order with a flux.

A Neumann part adds :math:`-g u` to the energy, a Robin part :math:`\tfrac12 h u^2 - g u`; see
:mod:`solvers.problem` for the conditions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rfm.calculus.types import Array
from solvers.data import values
from solvers.equations.density import QuadraticDensity
from solvers.equations.rows import Equality, Row, Scalar, added, apply
from solvers.exact import Exact, exact_jet, required
from solvers.problem import Condition, Dirichlet, FromExact, Neumann, Robin

Flux = Callable[[Sequence[Array], Array], list[Row]]
"""Rows of the conormal flux in the jet of order 1, from points and outward normals."""

CONDITIONS = (Dirichlet, Neumann, Robin)


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
    """Boundary energy of a condition in the value of u; None of a Dirichlet condition."""
    if isinstance(condition, Dirichlet):
        return None
    ((_, right),) = condition_rows(flux, condition, coords, normals, exact)
    hessian: dict[tuple[int, int], Scalar] = {}
    if isinstance(condition, Robin):
        hessian[0, 0] = values("Robin coefficient", condition.coefficient, coords)
    return QuadraticDensity(hessian, {0: right})
