"""Rules for a domain on a grid: inner cells, cut cells, boundary."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.jets import partials
from rfm.geometry.logic import Logic
from rfm.geometry.surface import Surface
from solvers.quadrature.batch import PointBatch, PointRule, TensorBatch
from solvers.quadrature.lines import LineRule
from solvers.quadrature.recursion import BoundaryPart, boundary_rule, volume_rule
from solvers.quadrature.sampling import is_exact
from solvers.quadrature.tensor import inner_rule

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.shape import Shape
    from solvers.classify import Classification
    from solvers.grid import Grid, Integers


STEEPEST = 1e-3
"""Least slope of a surface against its base, relative to its gradient."""


@dataclass(frozen=True, eq=False)
class DomainRules:
    """Quadrature rules of a domain.

    Attributes
    ----------
    inner
        Tensor Gauss rule of the inner cells.
    cut
        Rule of the cut cells, positive weights; cells that turn out to hold nothing are left out.  It is made of
        lines; where something else replaces it, of points.
    boundary
        Rules on the boundary by surface, with unit normals that point out of the domain.
    unresolved
        Volume of the boxes at the greatest depth, integrated at low order (0 but for degenerate geometry).
    """

    inner: TensorBatch
    cut: LineRule | PointRule
    boundary: Mapping[Surface, PointBatch]
    unresolved: float


class Deferred(Mapping[Surface, PointBatch]):
    """Rules on the boundary, built when they are first looked at: with Dirichlet conditions only, no solve needs them.

    Parameters
    ----------
    build
        Builds the rules.
    """

    def __init__(self, build: Callable[[], dict[Surface, PointBatch]]) -> None:
        self._build = cache(build)

    def __getitem__(self, surface: Surface) -> PointBatch:
        """Rule on a surface."""
        return self._build()[surface]

    def __iter__(self) -> Iterator[Surface]:
        """Surfaces that meet the boundary."""
        return iter(self._build())

    def __len__(self) -> int:
        """Count the surfaces that meet the boundary."""
        return len(self._build())


def domain_rules(domain: Shape, classification: Classification, inner: int, cut: int) -> DomainRules:
    """Build the quadrature rules of a domain.

    Parameters
    ----------
    domain
        The shape.
    classification
        Its cells, from :func:`solvers.classify.classify`.
    inner
        Gauss points a direction in inner cells.
    cut
        Gauss points on each piece of a line in cut cells and on the boundary.
    """
    grid = classification.grid
    logic = Logic(domain.expression, domain.surfaces)
    cut_cells = classification.cut_cells
    cells = np.concatenate([cut_cells, classification.touching_cells])
    boxes = classification.boxes
    in_cut = [group.take(np.flatnonzero(group.row < len(cut_cells))) for group in boxes]
    volume = list(volume_rule(logic, [group for group in in_cut if len(group)], cut))
    gathered = LineRule.gather(cells, [part.row for part in volume], [part.lines for part in volume], cut)
    boundary = Deferred(lambda: _boundary_batches(logic, grid, cells, list(boundary_rule(logic, boxes, cut))))
    return DomainRules(
        inner_rule(grid, classification.inner_cells, inner),
        replace(gathered, lines=replace(gathered.lines, weight=grid.cell_volume * gathered.lines.weight)),
        boundary,
        grid.cell_volume * sum(part.unresolved for part in volume),
    )


def _boundary_batches(
    logic: Logic, grid: Grid, cells: Integers, parts: list[BoundaryPart]
) -> dict[Surface, PointBatch]:
    if not parts:
        return {}
    batches = {}
    number = np.concatenate([part.surface for part in parts])
    row = np.concatenate([part.row for part in parts])
    axis = np.concatenate([part.axis for part in parts])
    nodes = np.concatenate([part.nodes for part in parts])
    inner_sign = np.concatenate([part.inner_sign for part in parts])
    # The measure of a cell across each direction.
    across = grid.cell_volume / grid.spacing
    weights = across[axis] * np.concatenate([part.weights for part in parts])
    for i in np.flatnonzero(np.bincount(number)):
        surface = logic.surfaces[i]
        chosen = np.flatnonzero(number == i)
        at, gradient = _on_surface(surface, grid, cells[row[chosen]], nodes[chosen], axis[chosen])
        # A vanishing gradient (the apex of a cone) has no normal; the point has no measure either.
        length = np.maximum(np.sqrt((gradient**2).sum(axis=1)), np.finfo(np.float64).tiny)
        # The floor only acts in unresolved boxes, where the surface may turn.
        slope = np.maximum(np.abs(gradient[np.arange(len(chosen)), axis[chosen]]), STEEPEST * length)
        normals = -gradient * (inner_sign[chosen] / length)[:, None]
        rule = PointRule.gather(cells, row[chosen], at, weights[chosen] * length / slope, normals)
        batches[surface] = rule.padded()
    return batches


def _on_surface(
    surface: Surface, grid: Grid, cells: Integers, nodes: Array, axis: Integers
) -> tuple[Array, Array]:
    """Nodes moved onto the surface (one Newton step cancels the interpolation error) and gradients there."""
    rows = np.arange(len(nodes))
    for moved in (False, True):
        coords = grid.lower + grid.spacing * (cells + nodes)
        jet = partials(surface.function, tuple(coords.T), 1)
        if moved or is_exact(surface):
            break
        step = jet[0] / (jet[1:][axis, rows] * grid.spacing[axis])
        step = np.where(np.abs(step) < 1e-3, step, 0.0)
        nodes = nodes.copy()
        nodes[rows, axis] = np.clip(nodes[rows, axis] - step, 0.0, 1.0)
    return nodes, jet[1:].T
