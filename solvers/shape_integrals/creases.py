r"""What corners and edges contribute to the derivative of the surface of a shape.

Where the surfaces f = 0 and g = 0 meet, the crease moves with the velocity v across it,

.. math:: \nabla f \cdot v = -\partial_t f, \qquad \nabla g \cdot v = -\partial_t g,

and a face that ends there grows by :math:`v \cdot \nu`, nu the direction in the face across the crease that points out
of the face.  In the plane the crease is a corner; in space an edge, along which this is integrated: each piece of the
polygon of its points by Gauss's rule, the nodes moved onto the curve in the planes across the piece.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array
from rfm.geometry.logic import Logic
from rfm.geometry.shape import Shape
from rfm.geometry.singular.boxes import signs_on
from rfm.geometry.singular.corners import corners
from rfm.geometry.singular.edges import Edge, edges

Rate = Callable[[int, Array], Array]

GAUSS = 6
NEWTON_STEPS = 8


def crease_term(shape: Shape, rate: Rate) -> float:
    """Sum over the creases of a shape.

    Parameters
    ----------
    shape
        The shape.
    rate
        Derivative of the surface of a number in the parameter at points (n, d), shape (n,).
    """
    logic = Logic(shape.expression, shape.surfaces)
    if shape.dimension == 2:
        total = 0.0
        for corner in corners(shape):
            active = [logic.index[surface] for surface in corner.surfaces]
            total += float(growth(logic, active, np.array([corner.point]), rate)[0])
        return total
    total = 0.0
    for edge in edges(shape):
        points, weights = edge_rule(edge)
        active = [logic.index[surface] for surface in edge.surfaces]
        total += float(weights @ growth(logic, active, points, rate))
    return total


def growth(logic: Logic, active: list[int], points: Array, rate: Rate) -> Array:
    """Sum of v . nu over the faces that end at points (n, d) of a crease, shape (n,)."""
    slopes = np.stack(
        [partials(logic.surfaces[i].function, tuple(points.T), 1)[1:].T for i in active], axis=1
    )
    rates = np.stack([rate(i, points) for i in active], axis=1)
    velocity = -np.einsum("nij,nj->ni", np.linalg.pinv(slopes), rates)
    signs = signs_on(logic, points, points)
    total = np.zeros(len(points))
    for k, i in enumerate(active):
        others = [j for j in range(len(active)) if j != k]
        across = _across(slopes[:, k], slopes[:, others[0]])
        for side in (1.0, -1.0):
            trial = signs.copy()
            for j in others:
                trial[:, active[j]] = np.sign(side * (across * slopes[:, j]).sum(axis=1))
            inside = []
            for s in (1, -1):
                trial[:, i] = s
                inside.append(logic.value(trial) > 0)
            face = inside[0] != inside[1]  # the face extends along side * across, so it grows the other way
            total -= np.where(face, side * (velocity * across).sum(axis=1), 0.0)
    return total


def edge_rule(edge: Edge) -> tuple[Array, Array]:
    """Points (q, 3) on an edge and weights (q,) that integrate along it."""
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    start, piece = edge.points[:-1], np.diff(edge.points, axis=0)
    length = np.linalg.norm(piece, axis=1)
    start, piece, length = start[length > 0], piece[length > 0], length[length > 0]
    along = np.repeat(piece / length[:, None], GAUSS, axis=0)
    planes = (start[:, None] + 0.5 * (nodes[:, None] + 1.0) * piece[:, None]).reshape(-1, 3)
    x = planes.copy()
    for _ in range(NEWTON_STEPS):
        jets = [partials(surface.function, tuple(x.T), 1) for surface in edge.surfaces]
        matrix = np.stack([jets[0][1:].T, jets[1][1:].T, along], axis=1)
        right = np.stack([jets[0][0], jets[1][0], ((x - planes) * along).sum(axis=1)], axis=1)
        x = x - np.linalg.solve(matrix, right[..., None])[..., 0]
    tangent = np.cross(matrix[:, 0], matrix[:, 1])
    slant = np.abs((tangent * along).sum(axis=1)) / np.linalg.norm(tangent, axis=1)
    return x, np.repeat(0.5 * length, GAUSS) * np.tile(weights, len(length)) / slant


def _across(own: Array, other: Array) -> Array:
    """Unit directions in the face of `own` across the crease with `other`, shape (n, d)."""
    unit = own / np.linalg.norm(own, axis=1, keepdims=True)
    across = other - (other * unit).sum(axis=1, keepdims=True) * unit
    return np.asarray(across / np.linalg.norm(across, axis=1, keepdims=True))
