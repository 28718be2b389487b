"""Equations and conditions of a case as the values that the solvers take."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from rfm.app.case import MATRIX, Case
from rfm.app.expressions import Expression
from rfm.app.schema.scalars import FROM_EXACT
from rfm.app.yaml_reader import Path
from rfm.calculus.types import Field
from rfm.errors import RfmError

if TYPE_CHECKING:
    from rfm.geometry.part import Part
    from rfm.geometry.shape import Shape
    from solvers.equations.equation import Equation
    from solvers.exact import Exact
    from solvers.problem import Condition, FromExact, Inclusion


def build_equation(case: Case) -> Equation:
    """Equation of a case.

    Raises
    ------
    CaseError
        A number is out of its range.
    """
    return _equation(case, case.equation.data, ("equation", case.equation.name))


def build_inclusion(case: Case, index: int, region: Shape) -> Inclusion:
    """Inclusion of a case in its region.

    Raises
    ------
    CaseError
        A number is out of its range.
    """
    from solvers.problem import Inclusion

    given: Any = case.equation.inclusions[index]
    path: Path = ("equation", case.equation.name, "inclusions", index)
    data = case.equation.data.model_copy(update=given.overrides())
    jumps = {
        key: 0.0 if getattr(given, key) is None else value(case, getattr(given, key), (*path, key))
        for key in ("jump", "flux_jump")
    }
    exact = build_exact(case, given.called)
    return Inclusion(given.called, region, _equation(case, data, path), **jumps, exact=exact)


def _equation(case: Case, data: Any, path: Path) -> Equation:
    try:
        return EQUATIONS[case.equation.name](case, data, path)
    except RfmError as error:
        key, _, message = str(error).partition(" ")
        if key in type(data).model_fields:
            raise case.error((*path, key), message) from error
        raise


def build_condition(case: Case, index: int, part: Part) -> Condition:
    """Condition of a case on its part."""
    given = case.boundary_conditions[index]
    path: Path = ("boundary_conditions", index, given.kind)
    return CONDITIONS[given.kind](case, getattr(given, given.kind), path, part)


def build_exact(case: Case, material: str = MATRIX) -> Exact | None:
    """Exact solution of a case in a material, a tuple of fields for a vector."""
    given: Any = case.exact
    path: Path = ("exact",)
    if isinstance(given, dict):
        given, path = given[material], ("exact", material)
    if isinstance(given, tuple):
        return tuple(item.field(case.dimension, (*path, i)) for i, item in enumerate(given))
    found: Field | None = given.field(case.dimension, path) if given is not None else None
    return found


def datum(case: Case, expression: Expression | str, path: Path) -> Field | float:
    """Number where the expression is constant, else its field."""
    if isinstance(expression, str):
        raise TypeError(f"{expression!r} is no expression")
    constant = expression.constant
    return float(constant) if constant is not None else expression.field(case.dimension, path)


def value(case: Case, given: Any, path: Path) -> Any:
    """Datum, 'from exact', nothing, or a tuple of such."""
    from solvers.problem import FROM_EXACT as TAKEN_FROM_EXACT

    if isinstance(given, tuple):
        return tuple(value(case, item, (*path, i)) for i, item in enumerate(given))
    if given is None:
        return None
    taken: FromExact = TAKEN_FROM_EXACT
    return taken if given == FROM_EXACT else datum(case, given, path)


def _poisson(case: Case, data: Any, path: Path) -> Equation:
    from solvers.equations.poisson import Poisson

    return Poisson(
        source=None if data.source == FROM_EXACT else datum(case, data.source, (*path, "source")),
        conductivity=datum(case, data.conductivity, (*path, "conductivity")),
        reaction=datum(case, data.reaction, (*path, "reaction")),
        advection=value(case, data.advection, (*path, "advection")),
    )


def _elasticity(case: Case, data: Any, path: Path) -> Equation:
    from solvers.equations.elasticity import Elasticity

    force = data.body_force if data.body_force is not None else (Expression("0"),) * case.dimension
    return Elasticity(
        model=str(data.model),
        young_modulus=datum(case, data.young_modulus, (*path, "young_modulus")),
        poisson_ratio=datum(case, data.poisson_ratio, (*path, "poisson_ratio")),
        body_force=None if force == FROM_EXACT else value(case, force, (*path, "body_force")),
    )


def _plate(case: Case, data: Any, path: Path) -> Equation:
    from solvers.equations.plate import Plate

    return Plate(
        stiffness=datum(case, data.stiffness, (*path, "stiffness")),
        poisson_ratio=data.poisson_ratio,
        load=None if data.load == FROM_EXACT else datum(case, data.load, (*path, "load")),
    )


EQUATIONS: dict[str, Callable[[Case, Any, Path], Equation]] = {
    "poisson": _poisson,
    "elasticity": _elasticity,
    "plate": _plate,
}
"""What builds each equation."""


def _plain(name: str) -> Callable[[Case, Any, Path, Part], Condition]:
    """Builder of a condition with one datum."""

    def build(case: Case, given: Any, path: Path, part: Part) -> Condition:
        from solvers import problem

        condition: Condition = getattr(problem, name)(part, value(case, given, path))
        return condition

    return build


def _with_keys(name: str) -> Callable[[Case, Any, Path, Part], Condition]:
    """Builder of a condition with data by name."""

    def build(case: Case, given: Any, path: Path, part: Part) -> Condition:
        from solvers import problem

        data = {key: value(case, item, (*path, key)) for key, item in given}
        condition: Condition = getattr(problem, name)(part, **data)
        return condition

    return build


def _slip(case: Case, given: Any, path: Path, part: Part) -> Condition:
    from solvers.problem import Slip

    return Slip(part)


def _periodic(case: Case, given: Any, path: Path, part: Part) -> Condition:
    """Sort the surfaces of both parts, all of which the condition claims, by their names."""
    from rfm.geometry.part import Part
    from solvers.problem import Periodic

    second = frozenset(
        surface for surface in part.surfaces if any(_is_called(surface.name, name) for name in given.partners)
    )
    names = (" | ".join(case.boundary_conditions[int(path[1])].on), " | ".join(given.partners))
    return Periodic(Part(names[0], part.surfaces - second), Part(names[1], second), given.factor, given.shift)


def _is_called(surface: str, name: str) -> bool:
    return surface == name or surface.startswith(f"{name}.")


CONDITIONS: dict[str, Callable[[Case, Any, Path, Part], Condition]] = {
    "dirichlet": _plain("Dirichlet"),
    "neumann": _plain("Neumann"),
    "robin": _with_keys("Robin"),
    "oblique": _with_keys("Oblique"),
    "traction": _plain("Traction"),
    "pressure": _plain("Pressure"),
    "slip": _slip,
    "clamped": _with_keys("Clamped"),
    "simply_supported": _with_keys("SimplySupported"),
    "free": _with_keys("Free"),
    "periodic": _periodic,
}
"""What builds each condition."""
