"""What a user should know about a run that went through."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from solvers.solution import Solution

UNRESOLVED = 1e-10
"""Fraction of the volume below which cells left to the low-order fallback are not worth a word."""

AGREEMENT = 1e-8
"""Difference of boundary data at a shared corner that counts as rounding."""


def warnings_of(solution: Solution) -> tuple[str, ...]:
    """Warnings about the data and the quadrature of a solution, one sentence each."""
    return (*solution.notes, *_corner_jumps(solution), *_unresolved(solution))


def _corner_jumps(solution: Solution) -> list[str]:
    """Dirichlet data of two parts that do not agree where the parts meet."""
    from solvers.trial import prescribed_values
    from structures.corners import corner_jumps

    found = []
    corners = (
        corner
        for values in prescribed_values(solution.problem)
        for corner in corner_jumps(solution.problem.domain, values)
    )
    for corner in corners:
        if corner.jump <= AGREEMENT:
            continue
        where = ", ".join(f"{c:.6g}" for c in corner.location)
        first, second = corner.parts
        found.append(
            f"the Dirichlet data of {first} and {second} differ by {corner.jump:.6g} where these parts meet, "
            f"at ({where}): no continuous field has both; expect slow convergence near that point"
        )
    return found


def _unresolved(solution: Solution) -> list[str]:
    """Volume that the quadrature could only treat to low order."""
    rules = solution.background.rules
    volume, unresolved = solution.background.sharing.total(
        [rules.inner.weights.sum() + rules.cut.weights.sum(), rules.unresolved]
    )
    if unresolved <= UNRESOLVED * volume:
        return []
    return [
        f"the quadrature could not resolve the boundary in {unresolved / volume:.2g} of the volume (a cusp, "
        "tangent surfaces or a very thin part); errors there are of low order: refine the grid to check"
    ]
