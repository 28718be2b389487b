r"""Partial derivatives of fields, by evaluating them on jets.

Notation: d^alpha f, alpha a multi-index, in the order of `multi_indices`: values, then (1, 0), (0, 1), then
(2, 0), (1, 1), (0, 2), ...

    partials(field, coords, order)      all derivatives at points, one array: the fast path of the program
    derivatives(field, coords, order)   the same on values of any kind, inside other fields
    derivative(field, alpha)            d^alpha f as a field
    gradient(field, dim)                the first derivatives as fields

Reference: Griewank and Walther, Evaluating Derivatives (SIAM 2008), chapter 13.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus import taylor
from rfm.calculus.jet import Jet, value_of, variables
from rfm.calculus.multi_index import MultiIndex, add, factorial, multi_indices, taylor_space
from rfm.calculus.types import Array, Field, Value

__all__ = [
    "Derivative",
    "Jet",
    "derivative",
    "derivatives",
    "gradient",
    "multi_indices",
    "partials",
    "variables",
]

# Points evaluated at once: what keeps the coefficients of a jet in a second-level cache.
CHUNK = 8192


def partials(field: Field, coords: Sequence[Array | float], order: int) -> Array:
    """Evaluate the partial derivatives of a field at points.

    Parameters
    ----------
    field
        The field.
    coords
        One array for each coordinate; they broadcast to the shape of the points.
    order
        Highest derivative; 0 gives the values only.

    Returns
    -------
    Array
        d^alpha f, shape (number of multi-indices, *points), in the order of ``multi_indices(dim, order)``; inf or
        nan, silently, where it does not exist.
    """
    dim = len(coords)
    arrays = [np.asarray(x, dtype=np.float64) for x in coords]
    shape = arrays[0].shape
    if any(x.shape != shape for x in arrays):
        shape = np.broadcast_shapes(*[x.shape for x in arrays])
    count = taylor_space(dim, order).starts[-1]
    result = np.empty((count, *shape))
    if result.size <= CHUNK * count:
        _fill_partials(result, field, arrays, order)
        return result
    flat = [np.broadcast_to(x, shape).reshape(-1) for x in arrays]
    rows = result.reshape(len(result), -1)
    for start in range(0, rows.shape[1], CHUNK):
        piece = slice(start, start + CHUNK)
        _fill_partials(rows[:, piece], field, [x[piece] for x in flat], order)
    return result


def _fill_partials(result: Array, field: Field, coords: Sequence[Array], order: int) -> None:
    # A field may be singular in some of the points; that shows in the result, not as a warning from inside.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        jet = field(*variables(coords, order)) if order else field(*coords)
    if type(jet) is not Jet:
        result[0], result[1:] = jet, 0.0
        return
    factorials = taylor_space(jet.dim, jet.order).factorials
    for i, (coefficient, scale) in enumerate(zip(jet.coefficients, factorials, strict=True)):
        if scale == 1.0:
            result[i] = coefficient
        else:
            np.multiply(coefficient, scale, out=result[i, ...])


def derivatives(field: Field, coords: Sequence[Value], order: int) -> tuple[Value, ...]:
    """Evaluate all partial derivatives up to `order` on values of any kind, in one go.

    This is `partials` for use inside other fields: the coordinates may be numbers, arrays, intervals, JAX
    arrays or jets.  On jets the result is the jet of the derivative: the expansion of the field of the higher
    order that this needs, shifted by alpha, and composed with the increments of the arguments.

    Returns
    -------
    tuple
        d^alpha f in the order of ``multi_indices(len(coords), order)``.
    """
    dim = len(coords)
    jets = [x for x in coords if type(x) is Jet]
    extra = min((x.order for x in jets), default=0)
    expansion = field(*variables([value_of(x) for x in coords], order + extra))
    indices = multi_indices(dim, order)
    if type(expansion) is not Jet:
        return (expansion, *[0.0] * (len(indices) - 1))
    if not jets:
        return tuple([expansion.derivative(alpha) for alpha in indices])
    monomials = None if _are_variables(coords) else _monomials(coords, jets[0].dim, extra)
    return tuple([_shifted(expansion, alpha, extra, monomials) for alpha in indices])


def _are_variables(coords: Sequence[Value]) -> bool:
    """Tell whether the arguments are the coordinates themselves: then there is nothing to compose."""
    for i, x in enumerate(coords):
        if type(x) is not Jet or x.dim != len(coords) or x.order != coords[0].order:
            return False
        for j, c in enumerate(x.coefficients[1:]):
            if type(c) is not float or c != (1.0 if i == j else 0.0):
                return False
    return True


def _monomials(coords: Sequence[Value], dim: int, order: int) -> list[Jet]:
    """List the powers h^beta of the increments of the arguments, in the order of the indices beta."""
    zeros = (0.0,) * (taylor_space(dim, order).starts[-1] - 1)
    increments = [
        Jet(dim, order, (0.0, *(x.truncate(order).coefficients[1:] if type(x) is Jet else zeros)))
        for x in coords
    ]
    space = taylor_space(len(coords), order)
    result = [Jet(dim, order, (1.0, *zeros))]
    for beta in space.indices[1:]:
        i = next(k for k, b in enumerate(beta) if b)
        lower = space.position[tuple(b - (k == i) for k, b in enumerate(beta))]
        result.append(result[lower] * increments[i])
    return result


def _shifted(expansion: Jet, alpha: MultiIndex, order: int, monomials: list[Jet] | None) -> Jet:
    """Return the jet of d^alpha f: coefficients (alpha+beta)!/beta! c_{alpha+beta}, composed with h^beta."""
    position = taylor_space(expansion.dim, expansion.order).position
    shifted = []
    for beta in multi_indices(expansion.dim, order):
        gamma = add(alpha, beta)
        scale, c = float(factorial(gamma) // factorial(beta)), expansion.coefficients[position[gamma]]
        shifted.append(c if scale == 1.0 or taylor.is_zero(c) else c * scale)
    if monomials is None:
        return Jet(expansion.dim, order, tuple(shifted))
    result: Jet = monomials[0] * shifted[0]
    for monomial, c in zip(monomials[1:], shifted[1:], strict=True):
        if not taylor.is_zero(c):
            result = result + monomial * c
    return result


@dataclass(frozen=True, eq=False)
class Derivative:
    """The field d^alpha f, itself evaluable on numbers, arrays, jets, intervals and JAX arrays."""

    field: Field
    alpha: MultiIndex

    def __call__(self, *coords: Value) -> Value:
        """Evaluate at the coordinates."""
        index = taylor_space(len(coords), sum(self.alpha)).position[self.alpha]
        return derivatives(self.field, coords, sum(self.alpha))[index]


def derivative(field: Field, alpha: MultiIndex) -> Field:
    """Return the partial derivative d^alpha of a field as a field."""
    if isinstance(field, Derivative):
        return Derivative(field.field, add(field.alpha, alpha))
    return Derivative(field, tuple(alpha)) if any(alpha) else field


def gradient(field: Field, dim: int) -> tuple[Field, ...]:
    """Return the first partial derivatives of a field of `dim` coordinates, as fields.

    Where the values of all of them are needed together, ``derivatives(field, coords, 1)`` is one evaluation.
    """
    return tuple(derivative(field, alpha) for alpha in multi_indices(dim, 1)[1:])
