"""Transfinite interpolation of data given on different parts of the boundary.

Shapiro, *Semi-analytic geometry with R-functions* (Acta Numerica 16, 2007), (7.10)-(7.12):

    g = sum_i g_i W_i,    W_i = prod_{j != i} omega_j^mu_j / sum_k prod_{j != k} omega_j^mu_j,

with omega_i >= 0 vanishing exactly on part i.  W_i is one on part i and zero on the others, so g takes
the data of every part.  On part i the other weights vanish to order mu_i, so g has the derivatives of g_i below
order mu_i.  Data given as a value and normal derivatives up to order m become generalised
Taylor polynomials (:mod:`structures.taylor`) with mu_i = m + 1, (7.12).  The parts may be features of any
dimension: points, curves, regions (:mod:`structures.features`).

The weights are products over a sum of products, never 1 / omega_i, hence finite and smooth on the parts
themselves.  Where two parts meet all products vanish and W has no limit (it depends on the direction);
a tiny number added to every factor makes it the mean of the two there and changes nothing elsewhere.

Notation: omega_i, W_i, mu_i as in the paper; g_i the data of part i.
"""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Field
from rfm.errors import StructureError
from structures.features import Feature
from structures.field_expression import ONE, ZERO, FieldExpr, field
from structures.taylor import taylor

# Far below the square of any distance that double precision resolves, far above underflow even for
# the product of several: only exact common zeros feel it.
COMMON_ZERO = 1e-60


def weights(
    omegas: Sequence[Field | FieldExpr | Feature], exponents: Sequence[float] | float = 1.0
) -> list[FieldExpr]:
    """Return the weights W_i of (7.11): a partition of unity with W_i = 1 on part i, 0 on the others.

    Parameters
    ----------
    omegas
        One field or feature per part, zero on it and positive elsewhere in the domain.  Comparable scales
        give the least wiggly weights: use normalised or saturated functions.
    exponents
        mu_i, one for all or one per part, positive.  Odd exponents change sign outside the domain;
        take 2 where parts meet, so that no pole runs out of the common corner.
    """
    powers = _exponents(len(omegas), exponents)
    factors = [_raised(omega, mu) + COMMON_ZERO for omega, mu in zip(omegas, powers, strict=True)]
    products = _products_of_others(factors)
    total = ZERO
    for product in products:
        total = total + product
    return [product / total for product in products]


def interpolate(
    pieces: Sequence[tuple[Field | FieldExpr | float, Field | FieldExpr | Feature]],
    exponents: Sequence[float] | float = 1.0,
) -> FieldExpr:
    """Return the field that equals g_i where omega_i vanishes, (7.10).

    Parameters
    ----------
    pieces
        Pairs (g_i, omega_i).
    exponents
        See :func:`weights`.

    Raises
    ------
    StructureError
        Without pieces, or when exponents are not positive or do not match the pieces in number.
    """
    if not pieces:
        raise StructureError("nothing to interpolate: give at least one pair (data, omega)")
    if len(pieces) == 1:
        return field(pieces[0][0])
    result = ZERO
    for (data, _), w in zip(pieces, weights([omega for _, omega in pieces], exponents), strict=True):
        result = result + field(data) * w
    return result


def interpolate_derivatives(
    pieces: Sequence[tuple[Sequence[Field | FieldExpr | float], Field | FieldExpr]],
    dimension: int,
    normaliser: str = "jets",
) -> FieldExpr:
    """Return the field with prescribed values and normal derivatives on every part, (7.12).

    Parameters
    ----------
    pieces
        Pairs ((f_0, ..., f_m), w): value and derivatives along the normal into the domain, and w normalised
        to order m. m may differ from part to part.
    dimension
        Number of coordinates.
    normaliser
        See :func:`structures.taylor.taylor`.
    """
    polynomials = [(taylor(w, data, dimension, normaliser).offset, field(w)) for data, w in pieces]
    return interpolate(polynomials, [float(len(data)) for data, _ in pieces])


def _raised(omega: Field | FieldExpr | Feature, mu: float) -> FieldExpr:
    return omega.raised(mu) if isinstance(omega, Feature) else field(omega) ** mu


def _exponents(count: int, exponents: Sequence[float] | float) -> list[float]:
    powers = list(exponents) if isinstance(exponents, Sequence) else [exponents] * count
    if len(powers) != count:
        raise StructureError(f"{count} parts need {count} exponents, got {len(powers)}")
    if min(powers) <= 0:
        raise StructureError(f"exponents of transfinite weights must be positive, got {min(powers)}")
    return powers


def _products_of_others(factors: Sequence[FieldExpr]) -> list[FieldExpr]:
    """Return prod_{j != i} factor_j for every i with 3n multiplications."""
    before, after = [ONE], [ONE]
    for factor in factors[:-1]:
        before.append(before[-1] * factor)
    for factor in reversed(factors[1:]):
        after.append(factor * after[-1])
    return [left * right for left, right in zip(before, reversed(after), strict=True)]
