"""Generalised Taylor polynomials: fields with prescribed value and normal derivatives on a part.

Shapiro, *Semi-analytic geometry with R-functions* (Acta Numerica 16, 2007), (7.1)-(7.5).  With w normalised
to order m

    f(x) = sum_{k=0..m} w^k / k! f*_k(x),    f*(x) = f(x - w grad w)                       (7.1), (7.2)

takes the values f_0 on w = 0 and the normal derivatives d^k f / dn^k = f_k there, k = 1..m (Theorem 7), n
pointing *into* the domain: f* is constant along normals to order m.  What the polynomial leaves open is
w^(m+1) psi.

The normaliser f -> f* comes in two ways.  By exact composition, (7.2) as it stands, it is evaluated outside
the point itself: only data can be normalised.  By its own Taylor expansion

    f* = sum_{k=0..m} (-w)^k / k! D_k f + O(w^(m+1)),    D_k = (grad w . d/dx)^k with grad w held fixed,

it uses derivatives at the point: unknown psi's can be normalised too, which makes solution structures, (7.13):
the polynomial of (psi, phi) is psi - w D psi + w phi.

Notation: w, f_k, f*, m as in the paper; d the number of coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import factorial, prod

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Field, Value
from rfm.errors import StructureError
from structures.field_expression import Arithmetic, FieldExpr, differentiate, field, unit
from structures.operator import Operator, differentiated, known

Normaliser = Callable[[Operator, FieldExpr, int], Operator]


def normal_derivative(w: Field | FieldExpr, u: Operator, k: int) -> Operator:
    """Return D_k u = (grad w . d/dx)^k u with grad w held fixed: the k-th normal derivative on w = 0.

    Parameters
    ----------
    w
        First-order normalised.
    u
        An operator; a field is ``known(dimension, field)``.
    k
        Order, 0 gives u.
    """
    slope = [differentiate(w, unit(u.dimension, axis)) for axis in range(u.dimension)]
    if k == 0:
        return u
    result = known(u.dimension, 0.0)
    for alpha in multi_indices(u.dimension, k):
        if sum(alpha) != k:
            continue
        weight = field(float(factorial(k) // prod(map(factorial, alpha))))
        derived = u
        for axis, power in enumerate(alpha):
            weight = weight * slope[axis] ** power
            for _ in range(power):
                derived = differentiated(derived, axis)
        result = result + weight * derived
    return result


def by_jets(f: Operator, w: FieldExpr, order: int) -> Operator:
    """Return f* expanded to an order: f at the foot of the normal, from derivatives at the point itself."""
    result = f
    for k in range(1, order + 1):
        result = result + ((-w) ** k / float(factorial(k))) * normal_derivative(w, f, k)
    return result


def by_composition(f: Operator, w: FieldExpr, order: int) -> Operator:
    """Return f*(x) = f(x - w grad w), (7.2); ``order`` is that of w.

    :func:`rfm.geometry.extension.extend` for data that are fields already.

    Raises
    ------
    StructureError
        For unknown functions, which are known at the point only.
    """
    if f.terms:
        raise StructureError(
            "an unknown psi cannot be evaluated at x - w grad w: normalise it by jets (normaliser='jets')"
        )
    axes = range(f.dimension)
    foot = tuple(field(_Coordinate(k)) - w * differentiate(w, unit(f.dimension, k)) for k in axes)
    # as an operation on fields: w and its slopes are evaluated once, whoever else needs them
    return known(f.dimension, Arithmetic(f.offset, foot))


@dataclass(frozen=True)
class _Coordinate:
    axis: int

    def __call__(self, *coords: Value) -> Value:
        return coords[self.axis]


NORMALISERS: dict[str, Normaliser] = {"jets": by_jets, "composition": by_composition}


def taylor(
    w: Field | FieldExpr,
    derivatives: Sequence[Operator | Field | FieldExpr | float],
    dimension: int,
    normaliser: str = "jets",
) -> Operator:
    """Return the generalised Taylor polynomial (7.1).

    Parameters
    ----------
    w
        Zero on the part and normalised to order m (:func:`structures.features.normalised`).
    derivatives
        f_0, ..., f_m: the value and the derivatives along the normal into the domain; fields, numbers or
        operators.
    dimension
        d.
    normaliser
        ``jets`` or ``composition``.

    Returns
    -------
    Operator
        Without unknowns (its ``offset`` is the field) when the data have none.

    Raises
    ------
    StructureError
        Without data, or for an unknown normaliser.
    """
    if not derivatives:
        raise StructureError("a Taylor polynomial needs at least the value f_0")
    if normaliser not in NORMALISERS:
        raise StructureError(f"unknown normaliser {normaliser!r}; choose one of {', '.join(NORMALISERS)}")
    omega, order = field(w), len(derivatives) - 1
    result = known(dimension, 0.0)
    for k, datum in enumerate(derivatives):
        f = datum if isinstance(datum, Operator) else known(dimension, datum)
        # f*_k is multiplied with w^k: an expansion to order m - k is enough
        star = f if order == k else NORMALISERS[normaliser](f, omega, order - k)
        result = result + (omega**k / float(factorial(k))) * star
    return result
