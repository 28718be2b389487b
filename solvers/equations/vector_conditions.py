r"""Dirichlet conditions, tractions, pressures and slip of a vector equation of second order.

A component without a Dirichlet value is free of traction.
A prescribed traction t adds :math:`-t \cdot u` to the energy on the boundary.  Where a body slips,
:math:`u \cdot n = 0` is essential, and a prescribed traction works through its tangential part only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rfm.calculus.types import Array, Field
from solvers.data import values
from solvers.equations.density import QuadraticDensity
from solvers.equations.rows import Equality, Row, Scalar, added, apply, scaled
from solvers.exact import Exact, components_of, exact_jet, required
from solvers.problem import Condition, Dirichlet, FromExact, Pressure, Slip, Traction, VectorDatum

Flux = Callable[[Sequence[Array], Array], list[Row]]
"""Rows of the traction in the jet of order 1, from points and outward normals."""

CONDITIONS = (Dirichlet, Traction, Pressure, Slip)


def natural_density(
    flux: Flux, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
) -> QuadraticDensity | None:
    """Work ``-t.u`` of a prescribed traction, in the values of u (the jet of order 0)."""
    if not isinstance(condition, Traction | Pressure | Slip):
        return None
    return QuadraticDensity({}, dict(enumerate(traction_of(flux, condition, coords, normals, exact))))


def condition_rows(
    flux: Flux, condition: Condition, coords: Sequence[Array], normals: Array, exact: Exact | None
) -> list[Equality]:
    """What a condition asks, as rows in the jet of order 1."""
    dimension = len(coords)
    width = dimension + 1
    if isinstance(condition, Dirichlet):
        wanted = prescribed(condition.value, dimension, exact)
        forces = flux(coords, normals) if None in wanted else []
        return [
            (forces[c], 0.0)
            if datum is None
            else ({c * width: 1.0}, values(f"dirichlet[{c}]", datum, coords))
            for c, datum in enumerate(wanted)
        ]
    if not isinstance(condition, Traction | Pressure | Slip):
        raise TypeError(f"a vector equation has no condition {type(condition).__name__}")
    rows = flux(coords, normals)
    asked = traction_of(flux, condition, coords, normals, exact)
    if not isinstance(condition, Slip):
        return list(zip(rows, asked, strict=True))
    n = [normals[..., c] for c in range(dimension)]
    across: Row = {}
    push: Scalar = 0.0
    for c in range(dimension):
        across = added(across, scaled(n[c], rows[c]))
        push = push + n[c] * asked[c]
    tangential = [
        (added(row, scaled(-n[c], across)), right - n[c] * push)
        for c, (row, right) in enumerate(zip(rows, asked, strict=True))
    ]
    return [({c * width: n[c] for c in range(dimension)}, 0.0), *tangential]


def traction_of(
    flux: Flux,
    condition: Traction | Pressure | Slip,
    coords: Sequence[Array],
    normals: Array,
    exact: Exact | None,
) -> list[Scalar]:
    """Prescribed traction by component; of slip, its tangential part counts."""
    if isinstance(condition, Pressure):
        p = values("pressure", condition.pressure, coords)
        return [-p * normals[..., c] for c in range(len(coords))]
    given = condition.traction
    if isinstance(given, FromExact):
        jet = exact_jet(required(exact), coords, 1)
        return [apply(row, jet) for row in flux(coords, normals)]
    if given is None:
        return [0.0] * len(coords)
    return [values(f"traction[{c}]", datum, coords) for c, datum in enumerate(given)]


def prescribed(value: VectorDatum, components: int, exact: Exact | None) -> tuple[Field | float | None, ...]:
    """Prescribed displacement by component, None where it is free."""
    given = value if isinstance(value, tuple) else (value,) * components
    found: list[Field | float | None] = []
    for c, item in enumerate(given):
        found.append(components_of(required(exact))[c] if isinstance(item, FromExact) else item)
    return tuple(found)
