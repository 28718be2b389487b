r"""What the solution of Poisson's equation looks like at a corner between two straight edges.

Polar coordinates as in :mod:`rfm.geometry.singular.straight`, :math:`\zeta = r e^{i\theta}`.  The solution has an
expansion in (Grisvard, *Elliptic Problems in Nonsmooth Domains*, 1985, chapter 4; Strang and Fix, *An Analysis of the
Finite Element Method*, 1973, chapter 8)

.. math:: \operatorname{Im} \zeta^{\lambda_k} = r^{\lambda_k} \sin \lambda_k \theta, \qquad
          \operatorname{Re} \zeta^{\lambda_k} = r^{\lambda_k} \cos \lambda_k \theta,

the former where a value is given at :math:`\theta = 0`, the latter where a flux is;
:math:`\lambda_k = k\pi/\omega` where both edges have the same kind of condition, :math:`(k - 1/2)\pi/\omega`
otherwise; in polynomials, and, where :math:`\lambda_k = m` is a whole number, in

.. math:: L_m = \operatorname{Im}\,(\zeta^m \log \zeta) - \omega \cos(m\omega)\,(y/\sin\omega)^m
          = r^m (\log r \sin m\theta + \theta \cos m\theta) - \dots

the part of the solution for a source of degree m - 2 that is no polynomial (resonance; at 270 degrees a constant
source has one).  The last term, y the distance to the first edge, makes it vanish on the second edge too; with a flux
on the first edge it is the real part, and a power of the coordinate along the second edge that does the same.
Polynomials that vanish on the edges with given values are products of the distances to them,

.. math:: \ell_1 \ell_2\, x^i y^j,

and are of no help of their own: but the weight of two edges at a re-entrant corner is their R-disjunction, like r, so
psi = u/w of the smoothest u has a kink there, and the splines alone would have order two in the gradient.

With a reaction, or data g that are themselves singular, products :math:`r^{2j} S_k` belong to the solution as well:
:math:`\Delta (r^{2j} S_k) = 4j(j + \lambda_k)\, r^{2j-2} S_k`.

All functions are zero where values are given on the two edges, to rounding, and their derivatives are known in closed
form: those of a holomorphic function F(z) are :math:`\partial_x^a \partial_y^b F = i^b F^{(a+b)}`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from math import comb, pi

import numpy as np

from rfm.calculus.jets import multi_indices, partials
from rfm.calculus.types import Array, Value
from rfm.geometry.singular.straight import StraightCorner

WHOLE = 1e-9
"""How near to a whole number an exponent counts as one."""
NEAREST = 1e-10
"""Distance to the corner, relative to the reach, below which derivatives are those at this distance."""


@dataclass(frozen=True)
class CornerFunctions:
    """The functions of one corner up to a degree.

    Attributes
    ----------
    corner
        Where, and between which edges.
    held
        Whether values are given on the first and on the second edge.
    degree
        Largest exponent.
    reach
        Unit of length: with the distance to the farthest point of the domain all powers stay below one.
    radial
        Whether the products with powers of r^2 are there too.
    """

    corner: StraightCorner
    held: tuple[bool, bool]
    degree: float
    reach: float
    radial: bool = False

    @cached_property
    def exponents(self) -> tuple[float, ...]:
        """The lambda_k that are not whole numbers, ascending; the first belongs to the leading singularity."""
        return tuple(one for one in self._all_exponents if abs(one - round(one)) > WHOLE)

    @cached_property
    def resonances(self) -> tuple[int, ...]:
        """The lambda_k that are whole numbers."""
        if (
            all(self.held) and abs(math.sin(self.corner.angle)) < WHOLE
        ):  # a slit: all solutions are polynomials
            return ()
        return tuple(round(one) for one in self._all_exponents if abs(one - round(one)) <= WHOLE)

    @property
    def count(self) -> int:
        """Number of functions."""
        return len(self.exponents) + int(self._coefficients.shape[1]) + len(self._products)

    @property
    def intensity_factor(self) -> float:
        """What turns the coefficient of the first function into that of r^lambda_1 sin or cos lambda_1 theta."""
        return float(self.reach ** -self.exponents[0])

    def table(self, x: Array, y: Array, order: int) -> Array:
        """Partial derivatives of all functions at points (n,), shape (n_alpha, count, n).

        First those of the exponents, then those of the resonances, then polynomials, then products with powers of r^2.
        At the corner itself, where derivatives are infinite, they are those at a tiny distance; values are zero there.
        """
        angle, start = self.corner.angle, self.corner.start
        local = ((x - self.corner.point[0]) + 1j * (y - self.corner.point[1])) * (1.0 / self.reach)
        # the bisector is turned to the real axis: the cut lies opposite, outside
        turned = local * np.exp(-1j * (start + 0.5 * angle))
        distance = np.abs(turned)
        radius = np.maximum(distance, NEAREST)
        logarithm = np.log(radius) + 1j * (np.angle(turned) + 0.5 * angle)
        analytic = self._analytic(logarithm, order)
        analytic[0][:, distance < NEAREST] = 0.0
        monomials = self._monomials(local * np.exp(-1j * start))
        step = np.exp(-1j * start) / self.reach  # dzeta/dx
        alphas = multi_indices(2, order)
        result = np.empty((len(alphas), self.count, len(x)))
        singular, smooth = len(self.exponents), len(analytic[0])
        last = self.count - len(self._products)
        for row, (a, b) in enumerate(alphas):
            values = analytic[a + b] * (step ** (a + b) * 1j**b)
            result[row, :smooth] = values.imag if self.held[0] else values.real
            result[row, smooth:last] = 0.0
            result[row, singular:last] += self._derived(a, b) @ monomials
        if self._products:
            squared = partials(self._squared_distance, (x, y), order)
            for row, (k, power) in enumerate(self._products, start=last):
                before = k if power == 1 else row - 1
                result[:, row : row + 1] = times(squared, result[:, before : before + 1], order)
        return result

    @cached_property
    def _products(self) -> list[tuple[int, int]]:
        """Numbers of exponents and powers of r^2 with which they stay up to the degree, those of one in a row."""
        if not self.radial:
            return []
        return [
            (k, power)
            for k, exponent in enumerate(self.exponents)
            for power in range(1, int(0.5 * (self.degree - exponent)) + 1)
        ]

    def _squared_distance(self, x: Value, y: Value) -> Value:
        dx, dy = x - self.corner.point[0], y - self.corner.point[1]
        return (dx * dx + dy * dy) * (1.0 / self.reach**2)

    def _analytic(self, logarithm: Array, order: int) -> list[Array]:
        """Powers of zeta, then zeta^m log zeta, and their derivatives, each (number of both, n)."""
        zeta = np.exp(logarithm)
        inverse = 1.0 / zeta if order else zeta
        count = len(self.exponents) + len(self.resonances)
        found = [np.empty((count, len(zeta)), dtype=complex) for _ in range(order + 1)]
        unit = np.exp(self._unit * logarithm)
        power, reached = np.ones_like(zeta), 0
        for row, exponent in enumerate(self.exponents):
            for _ in range(round(exponent / self._unit) - reached):
                power = power * unit
            reached = round(exponent / self._unit)
            term = power
            for j, target in enumerate(found):
                target[row] = term
                term = term * ((exponent - j) * inverse) if j < order else term
        for row, m in enumerate(self.resonances, start=len(self.exponents)):
            term = zeta**m
            first, second = 1.0, 0.0  # of zeta^(m-j) log zeta and of zeta^(m-j)
            for j, target in enumerate(found):
                target[row] = term * (first * logarithm + second)
                first, second = first * (m - j), second * (m - j) + first
                term = term * inverse if j < order else term
        return found

    @property
    def _unit(self) -> float:
        """What all exponents are whole multiples of."""
        return pi / self.corner.angle * (1.0 if self.held[0] == self.held[1] else 0.5)

    @cached_property
    def _all_exponents(self) -> tuple[float, ...]:
        ratio = pi / self.corner.angle
        shift = 0.0 if self.held[0] == self.held[1] else 0.5
        found = [(k - shift) * ratio for k in range(1, int(self.degree / ratio + shift) + 1)]
        return tuple(one for one in found if one <= self.degree + WHOLE)

    @cached_property
    def _powers(self) -> list[tuple[int, int]]:
        """Exponents of the monomials in the frame of the first edge."""
        top = int(self.degree)
        return [(i, j) for i in range(top + 1) for j in range(top + 1 - i)]

    @cached_property
    def _coefficients(self) -> Array:
        """Polynomials, those of the resonances first, in monomials."""
        row = {power: k for k, power in enumerate(self._powers)}
        sine, cosine = math.sin(self.corner.angle), math.cos(self.corner.angle)
        columns = []
        for m in self.resonances:
            column = np.zeros(len(row))
            if all(self.held):
                column[row[0, m]] = -self.corner.angle * math.cos(m * self.corner.angle) / sine**m
            elif self.held[1]:  # minus the value on the second edge, where x cos(omega) + y sin(omega) is r
                value = -self.corner.angle * math.sin(m * self.corner.angle)
                for i in range(m + 1):
                    column[row[i, m - i]] = -value * comb(m, i) * cosine**i * sine ** (m - i)
            columns.append(column)
        factor = _vanishing(self.held, sine, cosine)
        lines = sum(self.held)
        top = int(self.degree)
        for i in range(top + 1 - lines if lines else 0):
            for j in range(top + 1 - lines - i):
                column = np.zeros(len(row))
                for (a, b), value in factor.items():
                    column[row[a + i, b + j]] += value
                columns.append(column)
        return np.stack(columns, axis=1) if columns else np.zeros((len(row), 0))

    @cached_property
    def _steps(self) -> tuple[Array, Array]:
        """Derivatives of monomials along x and y, in monomials."""
        powers = np.array(self._powers)
        i, j = powers.T
        along = [
            ((i - p)[:, None] == i) & ((j - q)[:, None] == j) for p, q in ((1, 0), (0, 1))
        ]  # row: monomial, column: its derivative
        first, second = along[0] * i[:, None], along[1] * j[:, None]
        c, s = math.cos(self.corner.start) / self.reach, math.sin(self.corner.start) / self.reach
        return c * first - s * second, s * first + c * second

    def _derived(self, a: int, b: int) -> Array:
        """Coefficients of the derivatives of order (a, b) of all polynomials, shape (their number, monomials)."""
        along_x, along_y = self._steps
        rows = self._coefficients.T
        for step in (*[along_x] * a, *[along_y] * b):
            rows = rows @ step
        return rows

    def _monomials(self, frame: Array) -> Array:
        """Values of all monomials at points (n,), shape (monomials, n)."""
        top = int(self.degree)
        xs, ys = [np.ones_like(frame.real)], [np.ones_like(frame.real)]
        for _ in range(top):
            xs.append(xs[-1] * frame.real)
            ys.append(ys[-1] * frame.imag)
        found = np.empty((len(self._powers), len(frame)))
        for row, (i, j) in enumerate(self._powers):
            np.multiply(xs[i], ys[j], out=found[row])
        return found


def times(factor: Array, table: Array, order: int) -> Array:
    """Leibniz' rule: partial derivatives (n_alpha, n) of a factor times those (n_alpha, k, n) of functions."""
    rows = {alpha: k for k, alpha in enumerate(multi_indices(2, order))}
    result: Array = factor[0] * table
    for (a, b), row in rows.items():
        for (c, d), other in rows.items():
            if c <= a and d <= b and other:
                binomial = comb(a, c) * comb(b, d)
                result[row] += (binomial * factor[other]) * table[rows[a - c, b - d]]
    return result


def _vanishing(held: tuple[bool, bool], sine: float, cosine: float) -> dict[tuple[int, int], float]:
    """Product of the distances to the held edges, in monomials of the frame: y, and x sin(omega) - y cos(omega)."""
    if all(held):
        return {(1, 1): sine, (0, 2): -cosine}
    return {(0, 1): 1.0} if held[0] else {(1, 0): sine, (0, 1): -cosine}
