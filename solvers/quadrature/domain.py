"""Rules for a domain on a grid: inner cells, cut cells, boundary."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rfm.calculus.jets import partials
from solvers.quadrature.batch import PointBatch, PointRule, TensorBatch
from solvers.quadrature.boxes import initial_boxes
from solvers.quadrature.logic import Logic
from solvers.quadrature.recursion import BoundaryPart, VolumePart, boundary_rule, volume_rule
from solvers.quadrature.sampling import is_exact
from solvers.quadrature.tensor import inner_rule

if TYPE_CHECKING:
    from rfm.calculus.types import Array
    from rfm.geometry.shape import Shape
    from rfm.geometry.surface import Surface
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
        Rule of the cut cells, positive weights; cells that turn out to hold nothing are left out.
    boundary
        Rules on the boundary by surface, with unit normals that point out of the domain.
    unresolved
        Volume of the boxes at the greatest depth, integrated at low order (0 but for degenerate geometry).
    """

    inner: TensorBatch
    cut: PointRule
    boundary: dict[Surface, PointBatch]
    unresolved: float


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
    rows = np.arange(len(cells))
    boxes = list(initial_boxes(logic, grid, cells, classification.signs, classification.active, rows))
    in_cut = [group.take(np.flatnonzero(group.row < len(cut_cells))) for group in boxes]
    volume = list(volume_rule(logic, [group for group in in_cut if len(group)], cut))
    boundary = list(boundary_rule(logic, boxes, cut))
    return DomainRules(
        inner_rule(grid, classification.inner_cells, inner),
        _volume_batch(grid, cells, volume),
        _boundary_batches(logic, grid, cells, boundary),
        grid.cell_volume * sum(part.unresolved for part in volume),
    )


def _joined(arrays: Iterable[Array], empty: tuple[int, ...]) -> Array:
    arrays = list(arrays)
    return np.concatenate(arrays) if arrays else np.zeros(empty)


def _volume_batch(grid: Grid, cells: Integers, parts: list[VolumePart]) -> PointRule:
    rows = _joined((part.row for part in parts), (0,)).astype(np.int64)
    nodes = _joined((part.nodes for part in parts), (0, grid.dimension))
    weights = _joined((part.weights for part in parts), (0,)) * grid.cell_volume
    return PointRule.gather(cells, rows, nodes, weights)


def _boundary_batches(
    logic: Logic, grid: Grid, cells: Integers, parts: list[BoundaryPart]
) -> dict[Surface, PointBatch]:
    batches = {}
    number = _joined((part.surface for part in parts), (0,)).astype(np.int64)
    row = _joined((part.row for part in parts), (0,)).astype(np.int64)
    axis = _joined((part.axis for part in parts), (0,)).astype(np.int64)
    nodes = _joined((part.nodes for part in parts), (0, grid.dimension))
    inner_sign = _joined((part.inner_sign for part in parts), (0,))
    across = grid.cell_volume / grid.spacing
    weights = _joined((part.weights for part in parts), (0,)) * across[axis]
    for i in np.unique(number):
        surface = logic.surfaces[i]
        chosen = np.flatnonzero(number == i)
        at, gradient = _on_surface(surface, grid, cells[row[chosen]], nodes[chosen], axis[chosen])
        length = np.sqrt((gradient**2).sum(axis=1))
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
        jet = partials(surface.function, tuple(grid.corners(cells + nodes).T), 1)
        if moved or is_exact(surface):
            break
        step = jet[0] / (jet[1:][axis, rows] * grid.spacing[axis])
        step = np.where(np.abs(step) < 1e-3, step, 0.0)
        nodes = nodes.copy()
        nodes[rows, axis] = np.clip(nodes[rows, axis] - step, 0.0, 1.0)
    return nodes, jet[1:].T
