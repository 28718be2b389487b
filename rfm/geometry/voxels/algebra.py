"""R-operations on functional voxel models: they act on the characteristics of each node alone.

The value and the gradient that the characteristics of a node stand for are the jet of order one of the function there;
an R-operation on these jets is the jet of the combined function, hence its characteristics.  So a model of a complex
shape is combined from models of its primitives without their formulas, and equals the model of the combined formula to
rounding (except at nodes where both functions vanish).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rfm.calculus.jet import Jet
from rfm.calculus.r_systems import R0, RSystem
from rfm.calculus.types import Value
from rfm.errors import GeometryError
from rfm.geometry.voxels.model import VoxelModel, of_jet


def intersection(first: VoxelModel, second: VoxelModel, system: RSystem = R0) -> VoxelModel:
    """Return the model of the R-conjunction of two functions, given by their models.

    Raises
    ------
    GeometryError
        The models have different lattices.
    """
    return _combined(first, second, system.conjunction)


def union(first: VoxelModel, second: VoxelModel, system: RSystem = R0) -> VoxelModel:
    """Return the model of the R-disjunction, see :func:`intersection`."""
    return _combined(first, second, system.disjunction)


def complement(model: VoxelModel) -> VoxelModel:
    """Return the model of -f: all characteristics but n_{n+1} change sign."""
    signs = -np.ones(len(model.characteristics))
    signs[-2] = 1.0
    shape = (-1,) + (1,) * model.dimension
    return VoxelModel(model.box, model.scale, signs.reshape(shape) * model.characteristics)


def _combined(
    first: VoxelModel, second: VoxelModel, operation: Callable[[Value, Value], Value]
) -> VoxelModel:
    if first.box != second.box or first.counts != second.counts:
        raise GeometryError(
            f"the models have different lattices: {first.counts} nodes on {first.box.lower} to {first.box.upper} and "
            f"{second.counts} on {second.box.lower} to {second.box.upper}"
        )
    with np.errstate(all="ignore"):
        found = operation(_jet(first), _jet(second))
    jet = np.stack([np.broadcast_to(c, first.counts) for c in found.coefficients])
    return of_jet(first.box, max(first.scale, second.scale), np.nan_to_num(jet, posinf=0.0, neginf=0.0))


def _jet(model: VoxelModel) -> Jet:
    return Jet(model.dimension, 1, (model.values, *model.slopes))
