"""The solution at the points of the fitted mesh: computed once, shared by file, pictures and report."""

from __future__ import annotations

from dataclasses import dataclass

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
        The solution (n,) and its gradient (n, d).
    error
        ``u - exact`` (n,) where the exact solution is known.
    """

    mesh: FittedMesh
    u: Array
    gradient: Array
    error: Array | None = None


def sample(record: RunRecord, subcells: int | None = None) -> Samples:
    """Fit a mesh to the domain of `record` and evaluate its solution there."""
    mesh = fit(record.domain, record.grid, record.classification, subcells)
    u = np.asarray(record.u(mesh.points), dtype=np.float64)
    gradient = np.asarray(record.gradient(mesh.points), dtype=np.float64)
    error = None
    if record.exact is not None:
        with np.errstate(all="ignore"):
            error = u - np.broadcast_to(record.exact(*np.ascontiguousarray(mesh.points.T)), u.shape)
    return Samples(mesh, u, gradient, error)
