"""What a method of solution is: which functional or form determines the splines, and how it becomes a system.

Ritz takes the energy, least squares the squared residual, Galerkin the weak form, collocation the residual at points.
Everything else (background, structure, quadrature) is common to all, in :mod:`solvers.pipeline`; the methods are
siblings that share this interface, listed by name in :mod:`solvers.methods`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from rfm.calculus.types import Array
from rfm.errors import DiscretizationError
from solvers.bases.basis import Basis
from solvers.bases.registry import basis
from solvers.device.backend import NONE
from solvers.problem import Condition, Discretization, Periodic, Problem, SolverOptions

if TYPE_CHECKING:
    from solvers.equations.density import Density
    from solvers.pipeline import Assembly
    from solvers.stopwatch import Stopwatch
    from solvers.systems import System


class Method(Protocol):
    """A method: densities in the domain and on its boundary, and the system made of them."""

    @property
    def name(self) -> str:
        """Name in a case file."""
        ...

    def linear_solvers(self, problem: Problem) -> tuple[str, ...]:
        """Names of the linear solvers that suit its systems, besides ``auto``."""
        ...

    def refusal(self, problem: Problem) -> str | None:
        """Why the method does not suit the problem and which one does; None when it suits."""
        ...

    def order(self, problem: Problem) -> int:
        """Highest derivative of u in the domain's density, and least degree of the splines."""
        ...

    def boundary_order(self, problem: Problem) -> int:
        """Highest derivative of u in the boundary's density."""
        ...

    def symmetric(self, problem: Problem) -> bool:
        """Whether the matrix is symmetric."""
        ...

    def volume(self, problem: Problem, coords: Sequence[Array], *, check: bool = True) -> Density:
        """Density at points of the domain; `check` refuses data that are not finite."""
        ...

    def boundary(
        self, problem: Problem, condition: Condition, coords: Sequence[Array], normals: Array, spacing: float
    ) -> Density | None:
        """Density of a natural condition at points of the boundary, None when it has none."""
        ...

    def system(self, assembly: Assembly, watch: Stopwatch) -> System:
        """Equations for the unknowns."""
        ...


@dataclass(frozen=True)
class Refusal:
    """What does not combine, and why.

    `of` is ``method``, ``degree``, ``linear``, ``basis``, ``conditions``, ``singular``, ``device`` or ``shards``.
    """

    of: str
    message: str


def refused(
    method: Method, problem: Problem, discretization: Discretization, options: SolverOptions
) -> Refusal | None:
    """Why a method does not suit an equation, a degree or a linear solver, and the nearest that does."""
    why = method.refusal(problem)
    if why is not None:
        return Refusal("method", f"the method {method.name} does not suit the problem: {why}")
    order = method.order(problem)
    added = 0
    if discretization.conditions == "exact":
        from solvers.flux_conditions import derivatives

        added = derivatives(problem)
    space = basis(discretization.basis)
    if space.smoothness(discretization.degree) < order + added:
        return Refusal("degree", too_rough(method, space, order, added, discretization.degree))
    if discretization.conditions == "exact" and not space.local:
        return Refusal(
            "basis",
            f"conditions: exact puts a second spline into collars, which basis: {discretization.basis} does not have: "
            "use basis: web-spline, or conditions: natural",
        )
    if any(isinstance(c, Periodic) for c in problem.conditions):
        if not space.local:
            return Refusal(
                "basis",
                f"periodic conditions need periodic splines, which basis: {discretization.basis} does not have: use "
                "basis: web-spline",
            )
        if added:
            return Refusal(
                "conditions",
                "conditions: exact has no collars that go on across the seam of a periodic condition: use "
                "conditions: natural",
            )
    if problem.inclusions and not space.local:
        return Refusal(
            "basis",
            f"the fields of several materials need splines, unlike basis: {discretization.basis}: use web-spline",
        )
    if problem.inclusions and discretization.conditions == "exact":
        return Refusal(
            "conditions", "conditions: exact has no structure across interfaces: use conditions: natural"
        )
    if discretization.singular == "corners":
        from solvers.corners.enrichment import unsuitable

        why = unsuitable(method.name, options, problem, discretization)
        if why is not None:
            return Refusal(
                "singular", f"singular functions at corners are not available here: {why}; use singular: auto"
            )
    if options.linear != "auto" and options.linear not in method.linear_solvers(problem):
        return Refusal(
            "linear",
            f"the linear solver {options.linear} does not suit the method {method.name}: choose auto or one of "
            f"{', '.join(method.linear_solvers(problem))}",
        )
    if options.device != NONE:
        from solvers.device.requirements import without_device
        from solvers.device.shards import unsuitable_shards

        why = without_device(method.name, problem, discretization, options)
        if why is not None:
            return Refusal("device", why)
        why = unsuitable_shards(options)
        return None if why is None else Refusal("shards", why)
    if options.shards not in (None, 1):
        return Refusal(
            "shards",
            f"shards: {options.shards} cuts the grid for devices of JAX, and device: {NONE} solves with NumPy: choose "
            "device: gpu or cpu, or remove shards",
        )
    return None


def too_rough(method: Method, space: Basis, order: int, added: int, degree: int) -> str:
    """Message of a basis whose functions have too few derivatives."""
    needs = f"the method {method.name} needs derivatives of order {order} of u"
    if added:
        needs += f", hence with conditions: exact of order {order + added} of the spline"
    least = least_degree(space, order + added)
    if least is None:
        return f"{needs}; basis: {space.name} has none of any degree: use basis: web-spline"
    return f"{needs}: use degree {least} or more of basis: {space.name}, got {degree}"


def least_degree(space: Basis, order: int) -> int | None:
    """Lowest degree of a basis at which its functions have derivatives of some order, None when no degree does."""
    lowest, highest = space.degrees
    return next((p for p in range(lowest, highest + 1) if space.smoothness(p) >= order), None)


def require(method: Method, problem: Problem, discretization: Discretization, options: SolverOptions) -> None:
    """Refuse what does not combine.

    Raises
    ------
    DiscretizationError
        See :func:`refused`.
    """
    refusal = refused(method, problem, discretization, options)
    if refusal is not None:
        raise DiscretizationError(refusal.message)
