"""From a validated case to the values that the solvers take: domain, problem, discretisation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rfm.app.blame import located
from rfm.app.case import Case
from rfm.app.covering import assign_parts
from rfm.app.formulation import build_condition, build_equation, build_exact
from rfm.app.inclusions import build_inclusions
from rfm.app.schema.discretization import DEFAULT_GRID
from rfm.app.schema.results import DOMAIN
from rfm.app.shapes import build_shapes
from rfm.app.yaml_reader import Path
from rfm.errors import RfmError

if TYPE_CHECKING:
    from rfm.geometry.box import Box
    from rfm.geometry.shape import Shape
    from solvers.problem import Condition, Discretization, Problem, SolverOptions

__all__ = ["build_discretization", "build_domain", "build_problem", "given_box", "located", "solver_options"]

BORDER_SAMPLES = {2: 400, 3: 48}
"""Points a direction at which the border of a given background box is compared with the domain."""


def build_problem(case: Case) -> Problem:
    """Problem of a case.

    Raises
    ------
    CaseError
        A shape cannot be built, the domain is empty or unbounded, or the conditions do not fit the boundary.
    """
    from solvers.problem import Problem

    shapes = build_shapes(case)
    domain = _domain(case, shapes)
    equation = build_equation(case)
    parts = assign_parts(case, domain)
    _check_results(case, domain)
    conditions = tuple(build_condition(case, i, part) for i, part in enumerate(parts))
    _check_periods(case, domain, conditions)
    problem = Problem(domain, equation, conditions, build_exact(case))
    return (
        replace(problem, inclusions=build_inclusions(case, problem, shapes))
        if case.equation.inclusions
        else problem
    )


def build_domain(case: Case) -> Shape:
    """Domain of a case, with the surfaces of its shapes named after them."""
    return _domain(case, build_shapes(case))


def _domain(case: Case, shapes: Mapping[str, Shape]) -> Shape:
    from rfm.geometry.predicate import shape as substitute

    path: Path = ("geometry", "domain")
    try:
        domain = substitute(case.geometry.domain.predicate, shapes).using(case.geometry.membership)
    except RfmError as error:
        raise case.error(path, str(error)) from error
    if domain.box.empty:
        raise case.error(path, "the domain is empty")
    if not domain.box.finite and case.discretization.box is None:
        message = "the domain is unbounded; intersect it with a bounded shape"
        raise case.error(path, message)
    return domain


def build_discretization(case: Case, domain: Shape) -> Discretization:
    """Discretisation of a case.

    Raises
    ------
    CaseError
        The background box misses the domain or cuts it.
    """
    from solvers.problem import Discretization

    given = case.discretization
    return Discretization(
        degree=given.degree,
        grid=given.grid or DEFAULT_GRID,
        spacing=given.spacing,
        box=_background_box(case, domain),
        basis=given.basis,
        weight=given.weight,
        quadrature_points=given.quadrature_points,
        moment_fitting=given.moment_fitting,
        conditions=case.solver.conditions,
        singular=given.singular,
    )


def solver_options(case: Case) -> SolverOptions:
    """Options of the linear solver."""
    from solvers.problem import SolverOptions

    given = case.solver
    return SolverOptions(
        linear=given.linear, tolerance=given.tolerance, device=given.device, shards=given.shards
    )


def given_box(case: Case) -> Box | None:
    """Background box of the case; None when it has none."""
    from rfm.geometry.box import Box

    return None if case.discretization.box is None else Box(*case.discretization.box)


def _check_results(case: Case, domain: Shape) -> None:
    """Refuse probes outside the domain and integrals over unknown parts before anything is solved."""
    background = given_box(case) or domain.box
    for name, point in case.probes.items():
        if not float(np.asarray(domain.sign(*point))) >= -1e-9 * max(background.size):
            raise case.error(
                ("probes", name), f"the point lies outside the domain, which is in {_corners(domain.box)}"
            )
    for name, integral in case.integrals.items():
        for part in integral.on if DOMAIN not in integral.on else ():
            try:
                domain.part(part)
            except RfmError as error:
                raise case.error(("integrals", name, "on"), str(error)) from error


def _check_periods(case: Case, domain: Shape, conditions: Sequence[Condition]) -> None:
    """Refuse parts that are no translates of each other, at the condition that joins them."""
    from solvers.periodicity import period_of
    from solvers.problem import Periodic

    for i, condition in enumerate(conditions):
        if isinstance(condition, Periodic):
            try:
                period_of(domain, condition)
            except RfmError as error:
                key, _, message = str(error).partition(" ")
                path: Path = ("boundary_conditions", i, "periodic")
                if key == "shift" and condition.shift is not None:
                    raise case.error((*path, key), message) from error
                raise case.error(path, str(error), key=True) from error


def _background_box(case: Case, domain: Shape) -> Box | None:
    """Check that the given box holds the whole domain, at points of its border."""
    box, path = given_box(case), ("discretization", "box")
    if box is None:
        return None
    bounds = f"the domain lies in {_corners(domain.box)}"
    if box.intersect(domain.box).empty:
        raise case.error(path, f"the box does not touch the domain; {bounds}")
    lattice = np.linspace(0.0, 1.0, BORDER_SAMPLES[domain.dimension])
    for axis in range(domain.dimension):
        for side in (0.0, 1.0):
            axes = [lattice] * domain.dimension
            axes[axis] = np.array([side])
            unit = np.meshgrid(*axes, indexing="ij")
            points = [low + u * size for low, u, size in zip(box.lower, unit, box.size, strict=True)]
            if (np.asarray(domain.sign(*points)) > 1e-12 * max(box.size)).any():
                raise case.error(path, f"the box cuts the domain; {bounds}")
    return box


def _corners(box: Box) -> str:
    corners = ["[" + ", ".join(f"{c:.6g}" for c in corner) + "]" for corner in (box.lower, box.upper)]
    return f"[{corners[0]}, {corners[1]}]"
