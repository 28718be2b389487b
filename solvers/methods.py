"""The methods of solution by name, and the table of what combines with what."""

from __future__ import annotations

from solvers.collocation import Collocation
from solvers.galerkin import Galerkin
from solvers.least_squares import LeastSquares
from solvers.method import Method
from solvers.ritz import Ritz

METHODS: dict[str, Method] = {
    method.name: method for method in (Ritz(), LeastSquares(), Galerkin(), Collocation())
}
"""The methods by name."""
