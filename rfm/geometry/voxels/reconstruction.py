"""What a functional voxel model says between its nodes: values, and points of the zero set.

Each node stands for the plane of its characteristics within half a spacing.  A tangent plane leaves the function by
h^2/8 times its second derivative at most, so values and zero sets are of second order in the spacing h.
"""

from __future__ import annotations

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import GeometryError
from rfm.geometry.voxels.model import VoxelModel


def value_at(model: VoxelModel, points: Array) -> Array:
    """Values at points (m, n) by the plane of the nearest node, shape (m,).

    Raises
    ------
    GeometryError
        A point lies outside the box.
    """
    lower, upper = np.array(model.box.lower), np.array(model.box.upper)
    if ((points < lower) | (points > upper)).any():
        outside = points[((points < lower) | (points > upper)).any(axis=1)][0]
        raise GeometryError(
            f"{outside.tolist()} lies outside the model's box {model.box.lower} to {model.box.upper}"
        )
    at = tuple(np.rint((points - lower) / model.spacing).astype(np.int64).T)
    offsets = points.T - np.stack([x[at] for x in model.nodes])
    return np.asarray(model.values[at] + (model.slopes[(slice(None), *at)] * offsets).sum(axis=0))


def zero_points(model: VoxelModel) -> tuple[Array, Array]:
    """Points of the zero set, one in each voxel that its plane passes, and the unit normals towards larger values.

    Returns
    -------
    tuple
        Points (m, n) and normals (m, n).
    """
    value, slope = model.values, model.slopes
    square = (slope * slope).sum(axis=0)
    with np.errstate(all="ignore"):
        foot = -value * slope / square
    half = 0.5 * model.spacing.reshape((-1,) + (1,) * model.dimension)
    inside = (np.abs(foot) <= half * (1 + 1e-12)).all(axis=0)
    points = np.stack([x[inside] for x in model.nodes], axis=1) + foot[:, inside].T
    normals = (slope[:, inside] / np.sqrt(square[inside])).T
    return points, normals
