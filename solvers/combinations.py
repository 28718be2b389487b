"""The table of what combines with what: equations, methods, bases and ways to carry conditions.

Every entry is asked from the code that would refuse it in a solve: :meth:`solvers.method.Method.refusal`, the
smoothness of a basis, the exact structures of flux conditions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rfm.errors import DiscretizationError, StructureError
from rfm.geometry.distance import distance
from rfm.geometry.part import Part
from rfm.geometry.primitives_2d import disk
from solvers.bases.registry import BASES
from solvers.equations.elasticity import Elasticity
from solvers.equations.equation import Equation
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.flux_conditions import derivatives, has_flux, site_of
from solvers.materials import require_materials
from solvers.method import Method, least_degree
from solvers.methods import METHODS
from solvers.problem import (
    Clamped,
    Condition,
    Dirichlet,
    Free,
    Inclusion,
    Neumann,
    Oblique,
    Periodic,
    Pressure,
    Problem,
    Robin,
    SimplySupported,
    Slip,
    Traction,
)
from structures.catalogue.registry import CATALOGUE
from structures.field_expression import field

EQUATIONS: dict[str, Equation] = {
    "poisson": Poisson(),
    "poisson with advection": Poisson(advection=(1.0, 0.0)),
    "elasticity": Elasticity(),
    "plate": Plate(),
}
"""What is tried, by the name in the table."""

DOMAIN = disk(center=(0, 0), radius=1).named("disk")


def markdown() -> str:
    """Return the page for the documentation."""
    return "\n".join(_page()) + "\n"


def _page() -> Iterator[str]:
    yield "# What combines with what"
    yield ""
    yield "Written by `python docs/render_combinations.py` from the registries of the code; a test keeps it current."
    yield "What is refused here is refused by name when a case asks for it, with the nearest that works."
    yield ""
    yield "## Equations and methods"
    yield ""
    yield "Least degree of the splines (`basis: web-spline` or `b-spline`), `conditions: natural`."
    yield ""
    yield from table(("equation", *METHODS), equation_rows())
    yield ""
    yield "With splines of degree p and an equation of order s the error in L2 goes down like `h^min(p+1, 2(p+1)-s)` by"
    yield "Ritz and Galerkin, like `h^min(p+1, 2(p+1)-2s)` by least squares and collocation: from degree 3 on for"
    yield "s = 2, from 7 on for s = 4 all are equally fast."
    yield ""
    yield "## Bases and methods"
    yield ""
    yield "Least degree, as the basis counts it, for a Dirichlet problem of the equation."
    yield ""
    yield from table(("basis", *BASIS_COLUMNS), basis_rows())
    yield ""
    yield "`conditions: exact` needs as many degrees more as stated with the conditions below, and a basis of splines"
    yield "where there is something else than values. Where the functions"
    yield "of a basis depend on each other to rounding, least squares and collocation solve their rows by a QR"
    yield "factorisation and keep all digits; an energy keeps half of them."
    yield ""
    yield "## Conditions"
    yield ""
    yield "How each condition is carried: by the structure for every psi, or through the functional of the method."
    yield ""
    yield from table(
        ("equation", "condition", "`conditions: natural`", "`conditions: exact`"), condition_rows()
    )
    yield ""
    yield "## Materials"
    yield ""
    yield "Inclusions of another material (`inclusions`), by equation; all methods, `conditions: natural`, splines."
    yield ""
    yield from table(("equation", "inclusions"), material_rows())
    yield ""
    yield "## Structures"
    yield ""
    yield "All structures of the catalogue are operators that any method and equation takes from Python; what a"
    yield "method asks is that the splines have the derivatives of the residual or energy and those in the structure."
    yield "Least degree of the splines, for an equation of second order (fourth order in parentheses):"
    yield ""
    yield from table(("structure", *METHODS), structure_rows())


def table(head: Sequence[str], rows: Iterator[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of a table."""
    yield "| " + " | ".join(head) + " |"
    yield "|" + "---|" * len(head)
    for row in rows:
        yield "| " + " | ".join(row) + " |"


def equation_rows() -> Iterator[Sequence[str]]:
    """Least degree for each equation and method, or what to choose instead."""
    for name, equation in EQUATIONS.items():
        yield (name, *(_suits(method, equation) for method in METHODS.values()))


def _suits(method: Method, equation: Equation) -> str:
    refusal = method.refusal(Problem(DOMAIN, equation, ()))
    return str(_order(method, equation)) if refusal is None else f"no: {refusal}"


BASIS_COLUMNS = tuple(
    f"{equation}: {' and '.join(methods)}"
    for equation in ("poisson", "plate")
    for methods in (("ritz", "galerkin"), ("least-squares", "collocation"))
)


def basis_rows() -> Iterator[Sequence[str]]:
    """Least degree of each basis."""
    for name, basis in BASES.items():
        cells = [
            least_degree(basis, _order(METHODS[method], EQUATIONS[equation]))
            for equation in ("poisson", "plate")
            for method in ("ritz", "least-squares")
        ]
        yield (name, *("no: basis: web-spline" if cell is None else str(cell) for cell in cells))


def condition_rows() -> Iterator[Sequence[str]]:
    """How each condition of each equation is carried in both modes."""
    for name, equation in EQUATIONS.items():
        vector = equation.components(DOMAIN.dimension) > 1
        for condition in samples(DOMAIN.part("all")):
            some = isinstance(condition, Dirichlet) and has_flux(condition)
            if (vector or not some) and isinstance(condition, (*equation.conditions, Periodic)):
                natural = "functional" if has_flux(condition) else "structure"
                kind = type(condition).__name__
                if some:
                    kind = "Dirichlet, some components"
                refusing = _refusing(equation, condition)
                yield name, kind, PARTLY.get(kind, natural) + refusing, _carried(equation, condition)


PARTLY = {
    "SimplySupported": "deflection by structure, moment by functional",
    "Dirichlet, some components": "structure, no traction in the others by functional",
    "Slip": "structure, tangential traction by functional",
    "Periodic": "structure, periodic splines",
}
"""Conditions of which the structure carries a part in natural mode."""


def samples(part: Part) -> tuple[Condition, ...]:
    """One condition of each kind."""
    return (
        Dirichlet(part),
        Dirichlet(part, (0.0, None)),
        Neumann(part),
        Robin(part),
        Oblique(part, (1.0, 1.0)),
        Traction(part, (0.0, 0.0)),
        Pressure(part),
        Slip(part),
        Clamped(part),
        SimplySupported(part),
        Free(part),
        Periodic(part, part),
    )


def _refusing(equation: Equation, condition: Condition) -> str:
    """Name the methods that refuse a problem because of a condition."""
    names = [
        name
        for name, method in METHODS.items()
        if method.refusal(Problem(DOMAIN, equation, (condition,)))
        and not method.refusal(Problem(DOMAIN, equation, ()))
    ]
    return f"; not by {', '.join(names)}" if names else ""


def _carried(equation: Equation, condition: Condition) -> str:
    """Whether there is an exact structure: it is made, on a disk."""
    if isinstance(condition, Periodic):
        return "structure, without flux conditions beside it"
    if not has_flux(condition):
        return "structure"
    problem = Problem(DOMAIN, equation, (condition,))
    try:
        site_of(problem, condition, field(distance(DOMAIN, condition.part)))
    except DiscretizationError:
        return "no: use `conditions: natural`"
    return f"structure, degree + {derivatives(problem)}"


def material_rows() -> Iterator[Sequence[str]]:
    """Whether an equation may differ from place to place by inclusions."""
    for name, equation in EQUATIONS.items():
        inner = Inclusion("inner", DOMAIN.scale(0.5), equation)
        try:
            require_materials(Problem(DOMAIN, equation, (), inclusions=(inner,)))
        except StructureError as error:
            yield name, f"no: {error}"
        else:
            yield name, "value by structure, flux by functional"


def structure_rows() -> Iterator[Sequence[str]]:
    """Least degree for each structure and method."""
    for name, entry in CATALOGUE.items():
        cells = [
            [_order(method, EQUATIONS[equation]) + entry.derivatives for equation in ("poisson", "plate")]
            for method in METHODS.values()
        ]
        yield (name, *(f"{second} ({_possible(fourth)})" for second, fourth in cells))


def _possible(degree: int) -> str:
    highest = BASES["web-spline"].degrees[1]
    return str(degree) if degree <= highest else f"above {highest}: none"


def _order(method: Method, equation: Equation) -> int:
    return method.order(Problem(DOMAIN, equation, ()))
