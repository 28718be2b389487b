"""Inclusions of a case: their regions are looked at before anything is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rfm.app.case import Case
from rfm.app.formulation import build_inclusion
from rfm.app.yaml_reader import Path
from rfm.calculus.types import Array
from rfm.errors import CaseError, RfmError

if TYPE_CHECKING:
    from rfm.geometry.shape import Shape
    from solvers.problem import Inclusion, Problem

SAMPLES = 4096
"""Points of the domain at which regions are compared."""


def build_inclusions(case: Case, problem: Problem, shapes: Mapping[str, Shape]) -> tuple[Inclusion, ...]:
    """Inclusions of a case in its domain.

    Raises
    ------
    CaseError
        A region lies outside of the domain, is all of it, or meets another one.
    """
    from rfm.geometry.predicate import shape as substitute
    from solvers.materials import interface_of, require_materials
    from structures.contact import boundary_points, spread_points

    found: list[Inclusion] = []
    points = spread_points(problem.domain, SAMPLES)
    points = points[np.asarray(problem.domain.membership(*points.T)) > 0]
    slack = 1e-9 * max(problem.domain.box.size)
    for i, given in enumerate(case.equation.inclusions):
        path: Path = ("equation", case.equation.name, "inclusions", i)
        try:
            region = substitute(given.region.predicate, shapes)
            inclusion = build_inclusion(case, i, region)
            border = boundary_points(problem.domain & region, interface_of(problem, inclusion))
            require_materials(replace(problem, inclusions=(inclusion,)))
        except CaseError:
            raise
        except RfmError as error:
            raise case.error((*path, "region"), str(error)) from error
        for other in found:
            for where in (points[np.asarray(region.membership(*points.T)) > 0], border):
                shared = np.asarray(other.region.membership(*where.T)) > -slack
                if shared.any():
                    at = _shown(where[int(np.argmax(shared))])
                    message = (
                        f"meets the inclusion {other.name} at {at}; inclusions must lie apart from each other"
                    )
                    raise case.error((*path, "region"), message)
        found.append(inclusion)
    return tuple(found)


def _shown(point: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in point) + ")"
