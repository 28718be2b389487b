"""What a finished run is, as plain values: all that files, pictures and the report are made of."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib import metadata
from typing import TYPE_CHECKING, Any

from rfm.calculus.types import Array, Field

if TYPE_CHECKING:
    from rfm.app.singularities import Singularity
    from rfm.geometry.shape import Shape
    from solvers.classify import Classification
    from solvers.grid import Grid

PointFunction = Callable[[Array], Array]
"""A function of points of shape (n, dimension)."""

PACKAGES = ("rfm", "numpy", "scipy", "h5py", "matplotlib")


@dataclass(frozen=True)
class Residual:
    """How well one condition holds on one part of the boundary.

    Attributes
    ----------
    part
        Name of the part, e.g. ``plate.left``.
    condition
        Kind of the condition, e.g. ``dirichlet``.
    data
        Its data as text, e.g. ``x*z``.
    value
        Largest absolute residual of the condition at the points of the boundary rule.
    """

    part: str
    condition: str
    data: str
    value: float


@dataclass(frozen=True)
class LinearFacts:
    """Which linear solver ran, why it was chosen and how far it came."""

    method: str
    reason: str
    unknowns: int
    residual: float
    iterations: int | None = None


@dataclass(frozen=True)
class Provenance:
    """Where, when and with which versions a run was made (times in UTC, ISO 8601)."""

    versions: Mapping[str, str]
    host: Mapping[str, str]
    started: str
    finished: str

    @classmethod
    def collect(cls, started: datetime, finished: datetime | None = None) -> Provenance:
        """Provenance of a run of this process that `started` then and finished now."""
        finished = finished or datetime.now(UTC)
        return cls(installed_versions(), host_facts(), as_text(started), as_text(finished))


@dataclass(frozen=True, eq=False)
class FurtherSpline:
    """A spline beside the first: of another component of a vector, or of a structure with several."""

    degree: int
    coefficients: Array


@dataclass(frozen=True)
class RunRecord:
    """A finished run.

    Attributes
    ----------
    name, title
        Name of the run (its directory) and title of the case.
    case
        The resolved case: every default filled in, plain numbers, text, lists and mappings.
    summary
        What ``summary.json`` holds and ``rfm run --json`` prints.
    domain, grid, classification
        The shape, its background grid and the states of the cells.
    degree, basis, coefficients
        The first spline: its degree, the name of its basis, its coefficients on the full index grid.
    more
        The other splines, where there are several.
    u, gradient
        The solution at points (n, d): values (n,) and gradients (n, d); of a vector (n, c) and (n, c, d).
    derived
        Further quantities by name, at points (n, d), shape (n,).
    exact
        The exact solution where it is known; a tuple of fields for a vector.
    residuals
        One row per condition and part.
    timings
        Wall seconds of the phases, in their order.
    linear
        Facts about the linear solver.
    study
        Rows of the convergence table where a study was made (keys as in ``rfm study --json``).
    provenance
        Versions, host and times.
    singularities
        Corners or edges of the domain.
    """

    name: str
    title: str
    case: Mapping[str, Any]
    summary: Mapping[str, Any]
    domain: Shape
    grid: Grid
    classification: Classification
    degree: int
    basis: str
    coefficients: Array
    u: PointFunction
    gradient: PointFunction
    provenance: Provenance
    exact: Field | tuple[Field, ...] | None = None
    more: tuple[FurtherSpline, ...] = ()
    derived: Mapping[str, PointFunction] = field(default_factory=dict)
    residuals: tuple[Residual, ...] = ()
    timings: Mapping[str, float] = field(default_factory=dict)
    linear: LinearFacts | None = None
    study: tuple[Mapping[str, Any], ...] | None = None
    singularities: tuple[Singularity, ...] = ()


def installed_versions(packages: tuple[str, ...] = PACKAGES) -> dict[str, str]:
    """Versions of Python and of the `packages` that are installed."""
    versions = {"python": platform.python_version()}
    for package in packages:
        try:
            versions[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return versions


def host_facts() -> dict[str, str]:
    """Name, system, architecture and number of processors of this computer."""
    return {
        "name": platform.node(),
        "system": f"{platform.system()} {platform.release()}",
        "machine": platform.machine(),
        "processors": str(os.cpu_count() or 1),
    }


def as_text(moment: datetime) -> str:
    """`moment` in ISO 8601, to the millisecond, in UTC."""
    return moment.astimezone(UTC).isoformat(timespec="milliseconds")
