r"""Families of functions of one variable, the factors of tensor bases.

Notation: ``t`` is the unit coordinate of the box, ``0 <= t <= 1``; polynomials are functions of ``s = 2 t - 1``.

.. math::

    T_{k+1} &= 2 s\,T_k - T_{k-1}, \\
    (k+1)\,P_{k+1} &= (2k+1)\,s\,P_k - k\,P_{k-1},

and differentiating r times, :math:`(sP_k)^{(r)} = sP_k^{(r)} + r P_k^{(r-1)}` (DLMF 18.9). Trigonometric functions
have a period longer than the box, so that a function of the box needs not be periodic (Boyd, *A comparison of
numerical algorithms for Fourier extension*, J. Comput. Phys. 178, 2002).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from rfm.calculus.types import Array
from solvers.bases.resolution import Growth, polynomial_growth, trigonometric_growth

PERIOD = 2.0
"""Period of the trigonometric functions in lengths of the box."""


class Line(Protocol):
    """Functions of one variable by degree; the first one is the constant 1.

    Attributes
    ----------
    coordinate
        Coefficients of the first two functions whose combination is t; None where t is no combination.
    """

    @property
    def coordinate(self) -> tuple[float, float] | None: ...  # noqa: D102

    def count(self, degree: int) -> int:
        """Number of functions."""
        ...

    def table(self, degree: int, t: ArrayLike, order: int = 0) -> Array:
        """Derivatives with respect to t, shape (order + 1, *t.shape, count)."""
        ...

    def growth(self, degree: int, cells: int) -> Growth:
        """Growth of products of two functions on one of `cells` cells (:mod:`solvers.bases.resolution`)."""
        ...

    def exact_degree(self, degree: int) -> int | None:
        """Degree of products of two functions as polynomials; None when they are none."""
        ...


@dataclass(frozen=True)
class Polynomials:
    """Orthogonal polynomials of degree 0 ... p.

    Attributes
    ----------
    recurrence
        ``k -> (a, c)`` of the recurrence ``P_{k+1} = a s P_k - c P_{k-1}``.
    norm
        ``k -> `` factor that is multiplied onto P_k.
    """

    recurrence: Callable[[int], tuple[float, float]]
    norm: Callable[[int], float]

    @property
    def coordinate(self) -> tuple[float, float]:
        """``t = 1/2 + s/2``."""
        return 0.5, 0.5 / self.norm(1)

    def count(self, degree: int) -> int:
        """One more than the degree."""
        return degree + 1

    def table(self, degree: int, t: ArrayLike, order: int = 0) -> Array:
        """Derivatives by the differentiated recurrence."""
        s = 2.0 * np.asarray(t, dtype=float) - 1.0
        rows = np.zeros((degree + 1, order + 1, *s.shape))
        rows[0, 0] = 1.0
        if degree:
            rows[1, 0] = s
            if order:
                rows[1, 1] = 1.0
        for k in range(1, degree):
            a, c = self.recurrence(k)
            rows[k + 1] = a * s * rows[k] - c * rows[k - 1]
            for r in range(1, order + 1):
                rows[k + 1, r] += a * r * rows[k, r - 1]
        for k in range(degree + 1):
            for r in range(order + 1):
                rows[k, r] *= 2.0**r * self.norm(k)
        return np.ascontiguousarray(np.moveaxis(rows, 0, -1))

    def growth(self, degree: int, cells: int) -> Growth:
        """That of polynomials of degree 2 p."""
        return polynomial_growth(2 * degree, cells)

    def exact_degree(self, degree: int) -> int:
        """Twice the degree."""
        return 2 * degree


@dataclass(frozen=True)
class Trigonometric:
    """1, cos(w t), sin(w t), ..., cos(k w t), sin(k w t) with ``w = 2 pi / period``, t from the middle of the box."""

    period: float = PERIOD
    coordinate: None = None

    def count(self, degree: int) -> int:
        """2 k + 1."""
        return 2 * degree + 1

    def table(self, degree: int, t: ArrayLike, order: int = 0) -> Array:
        """Derivatives in closed form: each is a shift of the phase by a quarter."""
        where = np.asarray(t, dtype=float)[..., None] - 0.5
        result = np.zeros((order + 1, *where.shape[:-1], 2 * degree + 1))
        result[0, ..., 0] = 1.0
        frequency = 2 * math.pi / self.period * np.arange(1, degree + 1)
        for r in range(order + 1):
            phase = frequency * where + r * math.pi / 2
            result[r, ..., 1::2] = frequency**r * np.cos(phase)
            result[r, ..., 2::2] = frequency**r * np.sin(phase)
        return result

    def growth(self, degree: int, cells: int) -> Growth:
        """That of frequency 2 k over half a cell."""
        return trigonometric_growth(2 * math.pi * degree / (self.period * cells))

    def exact_degree(self, degree: int) -> None:
        """They are no polynomials."""
        return


CHEBYSHEV_LINE = Polynomials(lambda k: (2.0, 1.0), lambda k: 1.0)
LEGENDRE_LINE = Polynomials(
    lambda k: ((2 * k + 1) / (k + 1), k / (k + 1)),
    lambda k: math.sqrt(2 * k + 1),
)
