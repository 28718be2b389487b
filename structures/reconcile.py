"""Make two extensions of boundary data agree near the corner where their parts meet.

Transfinite weights have no limit at a common point of two parts: W is homogeneous of degree zero there, so that
a W_a + b W_b behaves like (b - a) times a function of the angle.  With data that agree at the corner this
is r Phi(theta), and splines of any degree converge slowly.  But the data fix a and b on their parts only:

    a' = a + omega_a Q_a,    b' = b + omega_b Q_b

are as good, and smooth Q_a, Q_b exist that make them agree: every smooth function that vanishes where
omega_a and omega_b do is a combination of both (Hadamard's lemma near a transversal corner).  Here Q_a and Q_b are
the smoothest polynomials that make the gap b' - a' small in the domain and O(r^m) at the corners, by least
squares; in space the corners are sample points of the common edge.  Whatever gap remains, the weights
close it: the values on the parts are exact in any case.

Notation: xi box coordinates in [-1, 1]; P_r products of Chebyshev polynomials T_i(xi_1) T_j(xi_2) ... of total
degree <= n; c_beta Taylor coefficients in xi.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from rfm.calculus.jets import multi_indices, variables
from rfm.calculus.types import Array, Value
from rfm.geometry.shape import Shape
from structures.contact import finite_box, spread_points
from structures.expansion import coefficients, expand
from structures.field_expression import FieldExpr, field

ORDER = 4  # m: expansions agree below this order at the corners
DEGREE = {2: 10, 3: 7}  # n
SAMPLES = {2: 300, 3: 900}  # points of the domain at which the gap is made small, over twice the unknowns
ROUGHNESS = 6.0  # high degrees are used reluctantly: penalty (1 + degree)^ROUGHNESS


@dataclass(frozen=True, eq=False)
class Polynomial:
    """sum_ij c_ij T_i(xi_1) T_j(xi_2) [T_k(xi_3)] in the coordinates of a box."""

    center: tuple[float, ...]
    half_width: tuple[float, ...]
    table: Array

    def __call__(self, *coords: Value) -> Value:
        """Evaluate at coordinates of any kind, contracting one direction after the other."""
        xi = [(x - c) / h for x, c, h in zip(coords, self.center, self.half_width, strict=True)]
        return _contract(
            self.table, [_chebyshev(t, n - 1) for t, n in zip(xi, self.table.shape, strict=True)]
        )


def reconcile(
    domain: Shape, data: tuple[FieldExpr, FieldExpr], omegas: tuple[FieldExpr, FieldExpr], corners: Array
) -> tuple[FieldExpr, FieldExpr, float]:
    """Return a' = a + omega_a Q_a and b' = b + omega_b Q_b that agree as well as polynomials can make them.

    Parameters
    ----------
    domain
        The shape.
    data
        a and b, equal at the corners.
    omegas
        omega_a and omega_b.
    corners
        ``(n, d)``, common zeros of both, possibly none.  Points where an expansion is not finite are left alone.

    Returns
    -------
    tuple
        a', b' and what is left of the gap, relative to b - a: about 1e-10 where smooth extensions exist that the
        polynomials resolve, above 1e-4 where features are too small for them.
    """
    box = finite_box(domain.box)
    half = (np.array(box.upper) - np.array(box.lower)) / 2
    center = (np.array(box.upper) + np.array(box.lower)) / 2
    degrees = _degrees(len(half), DEGREE[len(half)])
    inside = spread_points(domain, SAMPLES[len(half)])
    inside = inside[domain.contains(inside)]
    fields = (data[1] - data[0], *omegas)
    frame = center, half, degrees
    at_corners = _equations(fields, corners, ORDER - 1, *frame)
    in_domain = _equations(fields, inside, 0, *frame)
    # the first rows at the corners compare values: given, nothing to be done
    matrix = np.concatenate([at_corners[0][1:].reshape(-1, 2 * len(degrees)), in_domain[0][0]])
    right = np.concatenate([at_corners[1][1:].reshape(-1), in_domain[1][0]])
    weight = (1.0 + np.tile(degrees.sum(axis=1), 2)) ** -ROUGHNESS
    solution = weight * np.linalg.lstsq(matrix * weight, right, rcond=1e-10)[0]
    gap = float(np.linalg.norm(right))
    left_over = float(np.linalg.norm(matrix @ solution - right)) / gap if gap > 0.0 else 0.0
    q_a, q_b = (field(_polynomial(degrees, c, center, half)) for c in np.split(solution, 2))
    return data[0] + omegas[0] * q_a, data[1] + omegas[1] * q_b, left_over


def _equations(
    fields: Sequence[FieldExpr], points: Array, order: int, center: Array, half: Array, degrees: Array
) -> tuple[Array, Array]:
    """Return matrix ``(n_beta, n, 2 n_basis)`` and right side of omega_a Q_a - omega_b Q_b = b - a, expanded."""
    with np.errstate(all="ignore"):
        gap, omega_a, omega_b = _expansions(fields, points, half, order)
    finite = np.isfinite(gap + omega_a + omega_b).all(axis=0)
    basis = _basis_expansions(degrees, (points[finite] - center) / half, order)
    times = _multiplication_table(len(half), order)
    columns = [_times(omega[:, finite], basis, times) for omega in (omega_a, -omega_b)]
    return np.concatenate(columns, axis=-1), gap[:, finite]


def _polynomial(degrees: Array, values: Array, center: Array, half: Array) -> Polynomial:
    table = np.zeros(degrees.max(axis=0) + 1)
    table[tuple(degrees.T)] = values
    return Polynomial(tuple(center.tolist()), tuple(half.tolist()), table)


def _degrees(dimension: int, total: int) -> Array:
    found = [index for index in product(range(total + 1), repeat=dimension) if sum(index) <= total]
    return np.array(found)


def _expansions(fields: Sequence[FieldExpr], points: Array, half: Array, order: int) -> list[Array]:
    """Taylor coefficients ``(n_beta, n)`` in box coordinates."""
    indices = np.array(multi_indices(len(half), order))
    scale = np.prod(half**indices, axis=1)[:, None]
    values = expand([(f, order) for f in fields], tuple(points.T))
    return [scale * _rows(value, len(indices), len(points)) for value in values]


def _rows(value: Value, count: int, points: int) -> Array:
    return np.stack([np.broadcast_to(np.asarray(c, float), points) for c in coefficients(value, count)])


def _basis_expansions(degrees: Array, xi: Array, order: int) -> Array:
    """Taylor coefficients ``(n_beta, n, n_basis)`` of all P_r: products of one-dimensional expansions."""
    indices = np.array(multi_indices(xi.shape[1], order))
    result = np.ones((len(indices), len(xi), len(degrees)))
    for axis in range(xi.shape[1]):
        (t,) = variables((xi[:, axis],), order)
        line = [_rows(value, order + 1, len(xi)) for value in _chebyshev(t, int(degrees[:, axis].max()))]
        table = np.stack(line, axis=-1)  # (order + 1, n, degree + 1)
        result *= table[indices[:, axis]][:, :, degrees[:, axis]]
    return result


def _multiplication_table(dimension: int, order: int) -> list[tuple[int, int, int]]:
    place = {index: k for k, index in enumerate(multi_indices(dimension, order))}
    sums = ((i, j, tuple(np.add(a, b).tolist())) for a, i in place.items() for b, j in place.items())
    return [(i, j, place[total]) for i, j, total in sums if total in place]


def _times(omega: Array, basis: Array, table: Sequence[tuple[int, int, int]]) -> Array:
    result = np.zeros_like(basis)
    for i, j, total in table:
        result[total] += omega[i][:, None] * basis[j]
    return result


def _chebyshev(t: Value, degree: int) -> list[Value]:
    """Return T_0 ... T_degree by T_{k+1} = 2 t T_k - T_{k-1}; T_0 is the number 1."""
    values: list[Value] = [1.0, t]
    for _ in range(degree - 1):
        values.append(2.0 * t * values[-1] - values[-2])
    return values[: degree + 1]


def _contract(table: Array, lines: Sequence[Sequence[Value]]) -> Value:
    if table.ndim == 0:
        return float(table)
    total: Value = 0.0
    for row, value in zip(table, lines[0], strict=True):
        if np.any(row):
            total = total + _contract(row, lines[1:]) * value
    return total
