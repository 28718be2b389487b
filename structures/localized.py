r"""Flux conditions that hold exactly for every psi, corrected in a collar of a few cells only.

The published structures for a flux condition (Shapiro, Acta Numerica 16, 2007, (7.13) and (7.15)) contain
``w D(psi)`` over the whole domain; they lose an order and have functions that they nearly annihilate.  Here the
correction lives in a *collar* along the part.  On the part m, with the function w normalised there, a condition
with one derivative reads

    L(u) = phi   where w = 0,

in the normal form ``L(w v) = v`` there (:class:`FluxCondition`): for a scalar ``b . grad u + c u`` with
``b . grad w = 1``.  For any structure ``ua`` that satisfies the essential conditions

    u = ua + sum_m [ w_m X_m (phi_m - L_m(ua)) + w_m^2 X_m psi_m ],
    X_m = chi(w_m / l) prod_{j != m} w_j^2 / (w_j^2 + w_m^2),      chi(t) = exp(-t^4)

satisfies all conditions at once: X_m is one on its own part, so that L_m(u) = phi_m, and vanishes to second order
on every other, so that neither values nor fluxes change there.  The psi_m make up for whatever extension phi_m has
away from its part; one degree less than psi is enough for them, as ``w^2`` is of the size ``h^2``.  chi is smooth
because everything has to be integrated: a cutoff with a kink costs three digits.  Of exp(-t^2) and exp(-t^4), the
latter has the shorter tail: fewer cells, fewer psi_m that the other splines nearly represent (docs/structures.md).

Parts that meet need no order: where w_j = w_m = 0 the window X has no limit, but what it multiplies is
as small there as the error of psi, and ``w X`` has a bounded gradient.  Only quadrature has to see the corner.

Notation: w, phi, psi, D as in the paper; L, X, chi, l as above.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rfm.calculus.functions import exp
from rfm.calculus.types import Field, Value
from structures.field_expression import (
    ONE,
    ZERO,
    Arithmetic,
    FieldExpr,
    differentiate,
    field,
    is_constant,
    unit,
)
from structures.operator import Operator, differentiated, known, unknown

COMMON_ZERO = 1e-60
"""Added to ``w_j^2 + w_m^2``: only a common zero of both feels it."""


@dataclass(frozen=True, eq=False)
class FluxCondition:
    """``L(u) = phi`` where ``w = 0``, one row for each component of u.

    Attributes
    ----------
    w
        Zero on the part, positive in the domain, of unit slope on the part.
    rows
        L: coefficients by the position ``component * (d + 1) + beta`` in the jet of order 1 (beta = 0 the value, 1 + j
        the derivative along axis j).  Normal form: ``L(w v) = v`` on the part for every vector v.
    values
        phi.
    """

    w: FieldExpr
    rows: tuple[Mapping[int, FieldExpr], ...]
    values: tuple[FieldExpr, ...]

    def left(self, u: Sequence[Operator]) -> list[Operator]:
        """L(u), one operator a row."""
        dimension = u[0].dimension
        jet: dict[int, Operator] = {}
        for position in sorted({position for row in self.rows for position in row}):
            component, beta = divmod(position, dimension + 1)
            jet[position] = u[component] if beta == 0 else differentiated(u[component], beta - 1)
        found = []
        for row in self.rows:
            total = known(dimension, 0.0)
            for position, coefficient in row.items():
                total = total + coefficient * jet[position]
            found.append(total)
        return found


def gradient(w: FieldExpr, dimension: int) -> tuple[FieldExpr, ...]:
    """Return the partial derivatives of a field."""
    return tuple(differentiate(w, unit(dimension, axis)) for axis in range(dimension))


def conormal(
    w: Field | FieldExpr,
    dimension: int,
    conductivity: Field | FieldExpr | float,
    coefficient: Field | FieldExpr | float,
    value: Field | FieldExpr | float,
) -> FluxCondition:
    """Return the condition ``k du/dn + h u = g`` with the outward normal, n = -grad w on the part.

    Divided by -k it reads ``grad w . grad u - (h/k) u = -g/k``.
    """
    f, k, h = field(w), field(conductivity), field(coefficient)
    row = {1 + axis: slope for axis, slope in enumerate(gradient(f, dimension))}
    if not is_constant(h, 0.0):
        row[0] = -(h / k)
    return FluxCondition(f, (row,), (-(field(value) / k),))


def oblique(
    w: Field | FieldExpr,
    direction: Sequence[Field | FieldExpr | float],
    coefficient: Field | FieldExpr | float,
    value: Field | FieldExpr | float,
) -> FluxCondition:
    """Return the condition ``b . grad u + h u = g`` for a direction b that is nowhere tangential.

    All is divided by ``b . grad w``.
    """
    f, b, h = field(w), [field(component) for component in direction], field(coefficient)
    across = ZERO
    for component, slope in zip(b, gradient(f, len(b)), strict=True):
        across = across + component * slope
    row = {1 + axis: component / across for axis, component in enumerate(b)}
    if not is_constant(h, 0.0):
        row[0] = h / across
    return FluxCondition(f, (row,), (field(value) / across,))


def traction(
    w: Field | FieldExpr,
    moduli: tuple[FieldExpr | float, FieldExpr | float],
    values: Sequence[Field | FieldExpr | float],
) -> FluxCondition:
    """Return the condition ``sigma n = t`` of an isotropic elastic body, n = -grad w the outward normal.

    With N = grad w, ``(sigma N)_i = lambda N_i div u + mu sum_j N_j (d_j u_i + d_i u_j)``.  On w = 0 a field w v has
    ``sigma N = A v``, ``A = mu I + (lambda + mu) N N^T``, and ``A^-1 = (I - (lambda + mu)/(lambda + 2 mu) N N^T)/mu``
    brings the rows to normal form.

    Parameters
    ----------
    w
        Normalised on the part.
    moduli
        lambda and mu.
    values
        The traction t, one field a coordinate.
    """
    f, lam, mu = field(w), field(moduli[0]), field(moduli[1])
    dimension = len(values)
    normal = gradient(f, dimension)
    rows: list[dict[int, FieldExpr]] = []
    for i in range(dimension):
        row: dict[int, FieldExpr] = {}
        for j in range(dimension):
            for position, entry in (
                (j * (dimension + 1) + 1 + j, lam * normal[i]),
                (i * (dimension + 1) + 1 + j, mu * normal[j]),
                (j * (dimension + 1) + 1 + i, mu * normal[j]),
            ):
                row[position] = row[position] + entry if position in row else entry
        rows.append(row)
    share = (lam + mu) / (lam + 2.0 * mu)
    inverse = [
        [((ONE if i == j else ZERO) - share * normal[i] * normal[j]) / mu for j in range(dimension)]
        for i in range(dimension)
    ]
    given = [field(value) for value in values]
    solved: list[Mapping[int, FieldExpr]] = []
    for line in inverse:
        total: dict[int, FieldExpr] = {}
        for factor, row in zip(line, rows, strict=True):
            for position, entry in row.items():
                term = factor * entry
                total[position] = total[position] + term if position in total else term
        solved.append(total)
    right = tuple(
        -sum((factor * t for factor, t in zip(line, given, strict=True)), start=ZERO) for line in inverse
    )
    return FluxCondition(f, tuple(solved), right)


@dataclass(frozen=True)
class Bell:
    """``exp(-(t / length)^4)``."""

    length: float

    def __call__(self, t: Value) -> Value:
        """Value at t of any kind."""
        scaled = t * (1.0 / self.length)
        square = scaled * scaled
        return exp(-(square * square))


def window(
    w: FieldExpr, length: float, others: Sequence[FieldExpr] = (), own: FieldExpr | None = None
) -> FieldExpr:
    """Return X: one on the part, falling off over `length`, zero to second order where one of the `others` is zero.

    Parameters
    ----------
    w, length
        The function whose level sets the collar follows, and the length over which it ends.
    others
        Functions normalised on the other parts.
    own
        Zero on the part only, where that is a piece of w = 0; w itself by default.
    """
    result: FieldExpr = Arithmetic(Bell(length), (w,))
    square = (w if own is None else own) ** 2
    for other in others:
        other_square = other * other
        result = result * (other_square / (other_square + square + COMMON_ZERO))
    return result


def localized(
    essential: Sequence[Operator],
    conditions: Sequence[FluxCondition],
    windows: Sequence[FieldExpr],
) -> tuple[Operator, ...]:
    """Return the structure of the module's docstring, one operator for each component.

    The psi_m take the indices after those of `essential`: one for each component of the first condition, then of
    the second, and so on.

    Parameters
    ----------
    essential
        ua, one operator a component, which satisfy the essential conditions for every psi.
    conditions, windows
        The flux conditions with their X, see :func:`window`.
    """
    number = 1 + max((psi for u in essential for psi in u.unknowns), default=-1)
    result = list(essential)
    for condition, near in zip(conditions, windows, strict=True):
        wx = condition.w * near
        for i, (value, left) in enumerate(zip(condition.values, condition.left(essential), strict=True)):
            free = unknown(left.dimension, number)
            result[i] = result[i] + wx * (value - left) + (condition.w * wx) * free
            number += 1
    return tuple(result)
