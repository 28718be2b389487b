r"""The functional voxel model of a function of n variables: its local function at every node of a lattice.

Near a node the graph u = f(x) is replaced by its tangent plane, whose equation

.. math:: n_1 \xi_1 + \dots + n_n \xi_n + n_{n+1} \eta + n_{n+2} = 0, \qquad n_1^2 + \dots + n_{n+2}^2 = 1,

is given by n + 2 *local geometric characteristics* in [-1, 1].  xi are the coordinates scaled so that the box is
[-1, 1]^n, eta = u / scale is the scaled value; the plane through the node is oriented by n_{n+1} < 0, that is
(g, -1, eta - g . xi) / length, g the gradient of eta.  Slopes come from jets, not from differences of neighbours.

Reference: Tolok, *Functional Voxel Modelling* (Fizmatlit 2016, in Russian); Tolok, Tolok, Sycheva, Construction of the
functional voxel model for a spline curve, CEUR Workshop Proceedings 2744 (2020), paper 52.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from rfm.errors import GeometryError
from rfm.geometry.box import Box


@dataclass(frozen=True, eq=False)
class VoxelModel:
    """Local geometric characteristics on the nodes of a lattice.

    Attributes
    ----------
    box
        The lattice runs from its lower to its upper corner.
    scale
        Unit of the values.
    characteristics
        n_1 ... n_{n+2} at the nodes, shape (n + 2, k_1, ..., k_n).
    """

    box: Box
    scale: float
    characteristics: Array

    @property
    def dimension(self) -> int:
        """Number of variables n."""
        return self.box.dimension

    @property
    def counts(self) -> tuple[int, ...]:
        """Nodes in each direction."""
        return self.characteristics.shape[1:]

    @property
    def spacing(self) -> Array:
        """Distance of neighbouring nodes in each direction, shape (n,)."""
        return np.asarray(np.array(self.box.size) / (np.array(self.counts) - 1))

    @property
    def nodes(self) -> tuple[Array, ...]:
        """Coordinates of the nodes, one array of the shape of the lattice for each."""
        lines = [
            np.linspace(low, high, count)
            for low, high, count in zip(self.box.lower, self.box.upper, self.counts, strict=True)
        ]
        return tuple(np.meshgrid(*lines, indexing="ij"))

    @property
    def values(self) -> Array:
        """Values of the function at the nodes."""
        xi = scaled(self.box, self.nodes)
        n = self.characteristics
        along = sum(n[i] * xi[i] for i in range(self.dimension))
        return np.asarray(-self.scale * (along + n[-1]) / n[-2])

    @property
    def slopes(self) -> Array:
        """Gradients of the function at the nodes, shape (n, k_1, ..., k_n)."""
        half = 0.5 * np.array(self.box.size)
        n = self.characteristics
        return np.stack([-self.scale * n[i] / (n[-2] * half[i]) for i in range(self.dimension)])


def voxels(field: Field, box: Box, counts: Sequence[int], scale: float | None = None) -> VoxelModel:
    """Return the functional voxel model of a field.

    Parameters
    ----------
    field
        The function, of as many variables as the box has.
    box
        Where.
    counts
        Nodes in each direction, at least 2.
    scale
        Unit of the values; the largest value on the lattice by default.

    Raises
    ------
    GeometryError
        The box is not finite, a count is below 2, or the field is not finite at some node.
    """
    if not box.finite or box.empty:
        raise GeometryError(f"a voxel model needs a finite box, got {box.lower} to {box.upper}")
    if len(counts) != box.dimension or min(counts) < 2:
        raise GeometryError(f"a voxel model needs {box.dimension} counts of at least 2, got {list(counts)}")
    lattice = VoxelModel(box, 1.0, np.empty((box.dimension + 2, *counts)))
    jet = partials(field, lattice.nodes, 1)
    if not np.isfinite(jet).all():
        where = np.argwhere(~np.isfinite(jet).all(axis=0))[0]
        at = [float(x[tuple(where)]) for x in lattice.nodes]
        raise GeometryError(
            f"the function or its gradient is not finite at {at}: move the box or the lattice"
        )
    if scale is None:
        scale = float(np.abs(jet[0]).max()) or 1.0
    return of_jet(box, scale, jet)


def of_jet(box: Box, scale: float, jet: Array) -> VoxelModel:
    """Return the model of the values and slopes (1 + n, k_1, ..., k_n) at the nodes."""
    dimension = box.dimension
    model = VoxelModel(box, scale, np.empty((dimension + 2, *jet.shape[1:])))
    half = 0.5 * np.array(box.size)
    eta = jet[0] / scale
    g = np.stack([jet[1 + i] * half[i] / scale for i in range(dimension)])
    free = eta - sum(g[i] * x for i, x in enumerate(scaled(box, model.nodes)))
    plane = np.concatenate([g, np.full((1, *eta.shape), -1.0), free[None]])
    return VoxelModel(box, scale, plane / np.sqrt((plane * plane).sum(axis=0)))


def scaled(box: Box, coords: Sequence[Array]) -> list[Array]:
    """Coordinates scaled so that the box is [-1, 1]^n."""
    middle, half = np.array(box.center), 0.5 * np.array(box.size)
    return [(x - middle[i]) / half[i] for i, x in enumerate(coords)]
