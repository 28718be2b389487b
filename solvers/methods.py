"""The methods of solution by name, and the table of what combines with what."""

from __future__ import annotations

from rfm.lazy import Registry
from solvers.method import Method

METHODS: Registry[Method] = Registry(
    {
        "ritz": "solvers.ritz:Ritz",
        "least-squares": "solvers.least_squares:LeastSquares",
        "galerkin": "solvers.galerkin:Galerkin",
        "collocation": "solvers.collocation:Collocation",
    },
    made=lambda kind: kind(),
)
"""The methods by name."""
