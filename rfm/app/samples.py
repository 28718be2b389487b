"""The solution at the points of the fitted mesh: computed once, shared by file, pictures and report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from rfm.app.fitted import FittedMesh, fit
from rfm.app.record import RunRecord
from rfm.calculus.types import Array


@dataclass(frozen=True)
class Samples:
    """Values at the points of a mesh.

    Attributes
    ----------
    mesh
        The mesh fitted to the boundary, n points.
    u, gradient
        The solution (n,) and its gradient (n, d); of a vector (n, c) and (n, c, d).
    error
        ``u - exact`` of the shape of u where the exact solution is known.
    derived
        Further quantities (n,) by name, such as stresses.
    """

    mesh: FittedMesh
    u: Array
    gradient: Array
    error: Array | None = None
    derived: Mapping[str, Array] = field(default_factory=dict)

    @property
    def shown(self) -> Array:
        """What a picture of the solution shows (n,): the solution, of a vector its length."""
        return lengths(self.u)

    @property
    def shown_error(self) -> Array | None:
        """What a picture of the error shows (n,): the error, of a vector its length."""
        return None if self.error is None else lengths(self.error)


def sample(record: RunRecord, subcells: int | None = None) -> Samples:
    """Fit a mesh to the domain of `record` and evaluate its solution there."""
    mesh = fit(record.domain, record.grid, record.classification, subcells)
    u = np.asarray(record.u(mesh.points), dtype=np.float64)
    gradient = np.asarray(record.gradient(mesh.points), dtype=np.float64)
    error = None if record.exact is None else u - exact_values(record, mesh.points)
    derived = {name: np.asarray(function(mesh.points)) for name, function in record.derived.items()}
    return Samples(mesh, u, gradient, error, derived)


def exact_values(record: RunRecord, points: Array) -> Array:
    """Exact solution of `record` at points (n, d), shaped like its solution."""
    coords = np.ascontiguousarray(points.T)
    with np.errstate(all="ignore"):
        if isinstance(record.exact, tuple):
            values = [np.broadcast_to(component(*coords), len(points)) for component in record.exact]
            return np.stack(values, axis=1)
        if record.exact is None:
            raise ValueError("the exact solution is not known")
        return np.asarray(np.broadcast_to(record.exact(*coords), len(points)))


def lengths(values: Array) -> Array:
    """Lengths (n,) of vectors (n, c); scalars (n,) as they are."""
    return values if values.ndim == 1 else np.linalg.norm(values, axis=1)
