"""Background of a solve: grid over the domain, classified cells, quadrature rules, spline space."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rfm.errors import DiscretizationError
from rfm.geometry.shape import Shape
from solvers.classify import Classification, classify
from solvers.grid import Grid
from solvers.problem import Discretization
from solvers.quadrature import DomainRules, domain_rules
from solvers.quadrature.batch import TensorBatch
from solvers.quadrature.moments import fold
from solvers.stopwatch import Stopwatch
from solvers.web import SplineSpace


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
        Spline space of the unknown.
    """

    grid: Grid
    classification: Classification
    rules: DomainRules
    folded: TensorBatch | None
    space: SplineSpace


def background_grid(domain: Shape, discretization: Discretization) -> Grid:
    """Grid of the discretisation over its box (the bounding box of the domain when none is given)."""
    box = discretization.box or domain.box
    if discretization.spacing is not None:
        return Grid.with_spacing(box, discretization.spacing)
    return Grid.cover(box, discretization.grid)


def tensor_nodes(degree: int) -> int:
    """Nodes a direction of the tensor rule that replaces a cut cell's rule.

    Measured on a smooth solution in an annulus: 2p reproduce the full rule to two digits for p > 4, 2p + 2 are
    needed below (docs/architecture.md).
    """
    return 2 * degree if degree > 4 else 2 * degree + 2


def prepare(domain: Shape, discretization: Discretization, watch: Stopwatch) -> Background:
    """Classify the cells, integrate the cut ones and build the spline space.

    Raises
    ------
    GeometryError
        The domain is empty or does not touch the grid.
    DiscretizationError
        The grid is too coarse for the degree; the message names a grid that would do.
    """
    degree = discretization.degree
    with watch.phase("geometry"):
        grid = background_grid(domain, discretization)
        classification = classify(domain, grid)
    with watch.phase("quadrature"):
        points = discretization.quadrature_points or degree + 3
        rules = domain_rules(domain, classification, inner=degree + 1, cut=points)
        folded = fold(rules.cut, tensor_nodes(degree)) if discretization.moment_fitting else None
    with watch.phase("assembly"):

        def finer(cells: int) -> Classification:
            trial = replace(discretization, grid=cells, spacing=None)
            return classify(domain, background_grid(domain, trial))

        space = SplineSpace.build(
            grid, degree, classification, basis=discretization.basis, cut_cells=rules.cut.cells, finer=finer
        )
    if space.n_dofs == 0:
        raise DiscretizationError("no spline of the grid meets the domain: refine `grid`")
    return Background(grid, classification, rules, folded, space)
