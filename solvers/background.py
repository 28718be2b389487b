"""Background of a solve: grid over the domain, classified cells, quadrature rules, space of psi."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from rfm.calculus.r_systems import RSystem
from rfm.errors import DiscretizationError
from rfm.geometry.shape import Shape
from rfm.geometry.weight import analytic_across
from solvers.bases.basis import Space
from solvers.bases.registry import basis
from solvers.classify import Classification, classify
from solvers.grid import Grid
from solvers.problem import Discretization
from solvers.sharing import WHOLE, Sharing
from solvers.stopwatch import Stopwatch

if TYPE_CHECKING:
    from solvers.quadrature import DomainRules
    from solvers.quadrature.batch import TensorBatch


@dataclass(frozen=True)
class Background:
    """What depends on the shape and the discretisation only, not on the equation.

    Attributes
    ----------
    grid, classification
        Uniform cells and which of them lie inside, are cut, lie outside.
    rules
        Volume rules of inner and cut cells, and boundary rules per surface.
    folded
        Moment-fitted tensor rule of the cut cells, or None when it is not asked for.
    space
        Space of the unknown.
    sharing
        The processes, each of which has rules of its own cells only.
    """

    grid: Grid
    classification: Classification
    rules: DomainRules
    folded: TensorBatch | None
    space: Space
    sharing: Sharing = WHOLE


def background_grid(domain: Shape, discretization: Discretization) -> Grid:
    """Grid of the discretisation over its box (the bounding box of the domain when none is given)."""
    box = discretization.box or domain.box
    if discretization.spacing is not None:
        return Grid.with_spacing(box, discretization.spacing)
    return Grid.cover(box, discretization.grid)


def prepare(
    domain: Shape,
    discretization: Discretization,
    watch: Stopwatch,
    wraps: Mapping[int, float] = MappingProxyType({}),
    grid: Grid | None = None,
    sharing: Callable[[Classification, int], Sharing] = lambda *_: WHOLE,
) -> Background:
    """Classify the cells, integrate the cut ones and build the space.

    Parameters
    ----------
    domain, discretization, watch
        What to discretise and how.
    wraps
        Axes along which the grid covers one period of the splines, with their factors.
    grid
        A grid to share; that of the discretisation when absent.
    sharing
        How cells are divided among devices and processes, from their classification and the degree.

    Raises
    ------
    GeometryError
        The domain is empty or does not touch the grid.
    DiscretizationError
        The grid is too coarse for the degree; the message names a grid that would do.
    """
    from solvers.quadrature import domain_rules
    from solvers.quadrature.moments import fold
    from solvers.web import SplineSpace

    degree, chosen = discretization.degree, basis(discretization.basis)
    chosen.require(degree, domain.dimension)
    with watch.phase("geometry"):
        grid = grid or background_grid(domain, discretization)
        classification = classify(domain, grid)
        divided = sharing(classification, degree)
    with watch.phase("quadrature"):
        points = chosen.points(degree, int(max(grid.cells)))
        own = divided.own(classification)
        rules = domain_rules(
            domain, own, inner=points.inner, cut=discretization.quadrature_points or points.cut
        )
        fitted = points.folded if discretization.moment_fitting and goes_on(domain, discretization) else None
        folded = fold(rules.cut, fitted) if fitted is not None else None
    with watch.phase("assembly"):

        def finer(cells: int) -> Classification:
            trial = replace(discretization, grid=cells, spacing=None)
            return classify(domain, background_grid(domain, trial))

        space: Space
        cut = divided.all_cells(rules.cut.cells)
        if wraps:
            space = SplineSpace.build(grid, degree, classification, discretization.basis, cut, finer, wraps)
        else:
            space = chosen.build(grid, degree, classification, cut_cells=cut, finer=finer)
    if space.n_dofs == 0:
        raise DiscretizationError("no spline of the grid meets the domain: refine `grid`")
    return Background(grid, classification, rules, folded, space, divided)


def goes_on(domain: Shape, discretization: Discretization) -> bool:
    """Whether the weights are smooth across the boundary, as moment-fitted rules, with nodes outside, need them."""
    weight = discretization.weight
    return not isinstance(weight, str | RSystem) or analytic_across(domain, weight)
