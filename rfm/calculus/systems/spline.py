r"""Spline R-functions: piecewise polynomials of bidegree k = 1, 2, 3 that do Boolean algebra on signs.

Notation: x, y in [-1, 1] are the values of two functions, scaled; r(x, y) is a tensor product spline of bidegree k
with one inner knot 0 in each direction, hence a polynomial on each of the four quadrants and of class C^(k-1).  It
is an R-conjunction if

* (a) r = 0 on the half axes x = 0, y >= 0 and y = 0, x >= 0, crossing zero with a slope except at the origin,
* (b) r > 0 for x > 0 and y > 0,
* (c) r < 0 in the other three quadrants and on the negative half axes.

The disjunction is -r(-x, -y).  Of the :math:`(2k + 1)^2` Bezier ordinates :math:`b_{ij}`, :math:`|i|, |j| \le k`, of a
symmetric r condition (a) and the smoothness leave free

* *inner*: :math:`b_{ij}`, :math:`1 \le i \le j \le k` (that is :math:`b_{11}, b_{12}, \dots, b_{kk}`, row by row),
* *outer*: :math:`b_{-k,0}, b_{-k,1}, \dots, b_{-k,k}`,
* *corner*: :math:`b_{-k,-k}`,

4, 7 and 11 numbers for k = 1, 2, 3.  (b) and (c) are inequalities for them, certified in
`rfm.calculus.systems.spline_signs`.  With k = 3 they force b_11 = 0: r = c x y + ... would be positive beside the
origin in the third quadrant, where everything else is of degree 3.  A bound B scales arguments of size up to B:
f ^ g = B r(f/B, g/B).

Beyond [-1, 1]^2 the polynomial pieces are continued; signs are certified inside only.

Reference: the idea is that of "Spline R-function and applications in FEM" (Numer. Math. Theory Methods Appl., 2020), of
which only the abstract was at hand; the formulas and numbers here are derived from conditions (a) to (c).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement

import numpy as np

from rfm.calculus.functions import minimum, power
from rfm.calculus.systems.base import RSystem
from rfm.calculus.systems.spline_forms import (
    bezier_of_bspline,
    bezier_of_coefficients,
    bspline_of_bezier,
    power_of_bezier,
)
from rfm.calculus.systems.spline_signs import violation
from rfm.calculus.types import Array, Value
from rfm.errors import GeometryError

DEGREES = (1, 2, 3)

_QUADRANTS = (
    # signs of x and y, factors x^i y^j taken out, sign r must have, criterion
    ((1, 1), (1, 1), 1, "b"),
    ((-1, 1), (1, 0), -1, "c"),
    ((-1, -1), (0, 0), -1, "c"),
)


@dataclass(frozen=True)
class RSpline(RSystem):
    """Spline R-functions of bidegree k by their free Bezier ordinates.

    Parameters
    ----------
    degree
        The bidegree k, 1 to 3.
    inner, outer, corner
        Free ordinates, see the module's docstring.
    bound
        Size of the arguments for which the signs are certified.

    Raises
    ------
    GeometryError
        When the degree, a number of ordinates or the bound is wrong, or a sign criterion fails: the message says
        which and where.
    """

    degree: int
    inner: tuple[float, ...]
    outer: tuple[float, ...]
    corner: float
    bound: float = 1.0

    def __post_init__(self) -> None:
        k = self.degree
        _check_degree(k)
        for name, given, wanted in (
            ("inner", self.inner, k * (k + 1) // 2),
            ("outer", self.outer, k + 1),
        ):
            if len(given) != wanted:
                raise GeometryError(
                    f"a spline R-function of bidegree {k} has {wanted} {name} ordinates, got {len(given)}"
                )
        if not (np.isfinite(self.bound) and self.bound > 0.0):
            raise GeometryError(f"the bound of a spline R-function must be positive, got {self.bound:g}")
        self._check_signs()

    @property
    def smoothness(self) -> int:
        """Return k - 1."""
        return self.degree - 1

    def kappa(self, f: Value, g: Value) -> Value:
        """Return (f g)^2: the pieces meet where one argument changes sign."""
        return (f * g) ** 2

    @classmethod
    def of_bezier(cls, net: Sequence[Sequence[float]] | Array, bound: float = 1.0) -> RSpline:
        """Take all Bezier ordinates, ``net[i + k][j + k]`` being b_ij.

        Raises
        ------
        GeometryError
            When the net is not symmetric, not C^(k-1) or not zero where (a) wants it, naming the ordinate.
        """
        table = np.asarray(net, dtype=np.float64)
        size = len(table)
        if table.shape != (size, size) or size % 2 == 0 or (size - 1) // 2 not in DEGREES:
            raise GeometryError(
                f"Bezier ordinates of a spline R-function are a square of 3, 5 or 7, got {table.shape}"
            )
        k = (size - 1) // 2
        table = np.where(np.abs(table) < 1e-14 * np.abs(table).max(), 0.0, table)
        inner = tuple(float(table[i + k, j + k]) for i, j in _pairs(k))
        result = cls(k, inner, tuple(map(float, table[0, k:])), float(table[0, 0]), bound)
        wrong = np.abs(table - result.bezier) > 1e-12 * np.abs(table).max()
        if wrong.any():
            i, j = (int(n) for n in np.argwhere(wrong)[0])
            reason = f"by criterion (a), symmetry and C^{k - 1}"
            raise GeometryError(
                f"Bezier ordinate b[{i - k}, {j - k}] must be {result.bezier[i, j]:g} {reason}, got {table[i, j]:g}"
            )
        return result

    @classmethod
    def of_bspline(cls, ordinates: Sequence[Sequence[float]] | Array, bound: float = 1.0) -> RSpline:
        """Take the (k + 2)^2 B-spline ordinates on the knots (-1)^(k+1), 0, 1^(k+1) in each direction."""
        table = np.asarray(ordinates, dtype=np.float64)
        if table.ndim != 2 or table.shape[0] != table.shape[1] or len(table) - 2 not in DEGREES:
            raise GeometryError(
                f"B-spline ordinates of a spline R-function are a square of 3, 4 or 5, got {table.shape}"
            )
        matrix = bezier_of_bspline(len(table) - 2)
        return cls.of_bezier(matrix @ table @ matrix.T, bound)

    @cached_property
    def coefficients(self) -> Array:
        """Coefficients c_ab in the products of 1, x, ..., x^k, min(x, 0)^k, shape (k + 2, k + 2)."""
        k = self.degree
        net = np.zeros((k + 1, k + 1))
        for (i, j), value in zip(_pairs(k), self.inner, strict=True):
            net[i, j] = net[j, i] = value
        powers = power_of_bezier(k)
        table = np.zeros((k + 2, k + 2))
        table[:-1, :-1] = powers @ net @ powers.T
        signs = (-1.0) ** np.arange(k + 1)
        # r(-1, y), y >= 0, fixes what min(x, 0)^k is multiplied with; r(-1, -1) the last coefficient.
        edge = powers @ np.array(self.outer) - signs @ table[:-1, :-1]
        table[-1, :-1] = table[:-1, -1] = signs[k] * edge
        at_corner = np.append(signs, signs[k])
        table[-1, -1] = self.corner - at_corner @ table @ at_corner
        table[np.abs(table) < 1e-14 * np.abs(table).max()] = 0.0
        return table

    @cached_property
    def bezier(self) -> Array:
        """All Bezier ordinates b_ij, shape (2k + 1, 2k + 1)."""
        matrix = bezier_of_coefficients(self.degree)
        result: Array = matrix @ self.coefficients @ matrix.T
        return result

    @cached_property
    def bspline(self) -> Array:
        """B-spline ordinates, shape (k + 2, k + 2)."""
        matrix = bspline_of_bezier(self.degree)
        result: Array = matrix @ self.bezier @ matrix.T
        return result

    @property
    def analytic_across(self) -> bool:
        """The pieces meet where one argument changes sign."""
        return False

    def pair(self, f: Value, g: Value, sign: float) -> Value:
        """Return B r(f/B, g/B), or the disjunction by De Morgan's law."""
        if sign < 0 and self.bound == 1.0:
            return self._spline(f, g)
        scale = -sign * self.bound  # the disjunction is -r(-x, -y)
        return self._spline(f * (1.0 / scale), g * (1.0 / scale)) * scale

    def _spline(self, x: Value, y: Value) -> Value:
        of_x, of_y = _basis(x, self.degree), _basis(y, self.degree)
        total: Value = 0.0
        for row, factor in zip(self.coefficients[1:], of_x[1:], strict=True):
            used = [(float(c), of_y[b]) for b, c in enumerate(row) if c != 0.0]
            if used:
                inner = sum((c * p for c, p in used[1:]), used[0][0] * used[0][1])
                total = total + factor * inner
        for c, p in zip(self.coefficients[0], of_y, strict=True):
            total = total + float(c) * p if c != 0.0 else total
        return total

    def _check_signs(self) -> None:
        k = self.degree
        if k == 3 and self.inner[0] != 0.0:
            raise GeometryError(
                "a spline R-function of bidegree 3 must have b[1, 1] = 0, or it is positive beside the corner "
                f"(criterion (c)), got {self.inner[0]:g}"
            )
        for signs, factor, wanted, criterion in _QUADRANTS:
            table = wanted * _in_quadrant(self.coefficients, k, signs)[factor[0] :, factor[1] :]
            size = max(table.shape)
            square = np.zeros((size, size))
            square[: table.shape[0], : table.shape[1]] = table
            found = violation(square)
            if found is not None:
                point = (signs[0] * found[0], signs[1] * found[1])
                raise GeometryError(
                    f"a spline R-function must be {'positive' if wanted > 0 else 'negative'} for "
                    f"{_sides(signs)} (criterion ({criterion})), not so near ({point[0]:.3g}, {point[1]:.3g})"
                )


def _check_degree(degree: int) -> None:
    if degree not in DEGREES:
        raise GeometryError(f"spline R-functions have bidegree 1, 2 or 3, got {degree}")


def _pairs(k: int) -> list[tuple[int, int]]:
    return list(combinations_with_replacement(range(1, k + 1), 2))


def _basis(x: Value, k: int) -> list[Value]:
    powers: list[Value] = [1.0, x]
    for exponent in range(2, k + 1):
        powers.append(power(x, exponent))
    return [*powers, power(minimum(x, 0.0), k)]


def _in_quadrant(table: Array, k: int, signs: tuple[int, int]) -> Array:
    """Coefficients of |x|^i |y|^j in a quadrant."""
    for axis, sign in enumerate(signs):
        rows = np.moveaxis(table, axis, 0)
        piece = rows[:-1].copy()
        if sign < 0:
            piece[k] += rows[-1]
            piece *= ((-1.0) ** np.arange(k + 1)).reshape(-1, 1)
        table = np.moveaxis(piece, 0, axis)
    return table


def _sides(signs: tuple[int, int]) -> str:
    return ", ".join(f"{name} {'>' if sign > 0 else '<'} 0" for name, sign in zip("xy", signs, strict=True))
