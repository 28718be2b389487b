"""Solution structures as affine differential operators.

A structure is a field that depends affinely on unknown functions psi_m and their derivatives,

    u = u0 + sum_m sum_alpha a_{m,alpha}(x) d^alpha psi_m,

with ordinary fields u0 (the *offset*) and a_{m,alpha}.  Operators add, subtract and multiply with
fields and numbers, and :func:`D` differentiates along grad w, so that the code reads as
Shapiro, *Semi-analytic geometry with R-functions* (Acta Numerica 16, 2007), e.g. (7.13)

    psi - w * D(w, psi) + w * phi + w**2 * psi2.

Vector problems use one operator per component; the components share the indices m of the psi's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rfm.calculus.types import Field
from rfm.errors import StructureError
from structures.field_expression import (
    ONE,
    ZERO,
    FieldExpr,
    MultiIndex,
    differentiate,
    field,
    is_constant,
    unit,
)


@dataclass(frozen=True, eq=False)
class Term:
    """One summand ``coefficient * d^alpha psi``, ``psi`` being the index m of the unknown."""

    psi: int
    alpha: MultiIndex
    coefficient: FieldExpr


@dataclass(frozen=True, eq=False)
class Operator:
    """An affine differential operator; see the module's docstring.

    Attributes
    ----------
    dimension
        Number of coordinates d.
    offset
        The field u0 that does not depend on any psi.
    terms
        Distinct pairs (psi, alpha), none with a structurally zero coefficient.
    """

    dimension: int
    offset: FieldExpr
    terms: tuple[Term, ...]

    __array_ufunc__ = None

    @property
    def order(self) -> int:
        """Highest order of a derivative of a psi."""
        return max((sum(term.alpha) for term in self.terms), default=0)

    @property
    def unknowns(self) -> tuple[int, ...]:
        """Indices of the psi's, ascending."""
        return tuple(sorted({term.psi for term in self.terms}))

    def coefficient(self, psi: int, alpha: MultiIndex) -> FieldExpr:
        """Return a_{psi,alpha}, the zero field when there is no such term."""
        for term in self.terms:
            if (term.psi, term.alpha) == (psi, alpha):
                return term.coefficient
        return ZERO

    def apply(self, psi: Mapping[int, Field] | Field) -> FieldExpr:
        """Return the field u for given psi's (a mapping from index, or one field for the only unknown)."""
        if not isinstance(psi, Mapping):
            if len(self.unknowns) > 1:
                raise StructureError(
                    f"the structure has {len(self.unknowns)} unknowns {self.unknowns}: "
                    "pass a mapping from index to field"
                )
            psi = dict.fromkeys(self.unknowns, psi)
        result = self.offset
        for term in self.terms:
            result = result + term.coefficient * differentiate(psi[term.psi], term.alpha)
        return result

    def __add__(self, other: Operator | Field | float) -> Operator:
        """Add an operator or a field."""
        that = _operator(other, self.dimension)
        return _collect(self.dimension, self.offset + that.offset, (*self.terms, *that.terms))

    def __radd__(self, other: Field | float) -> Operator:
        """Add a field on the left."""
        return self + other

    def __neg__(self) -> Operator:
        """Return the operator with all signs changed."""
        return self * -1.0

    def __sub__(self, other: Operator | Field | float) -> Operator:
        """Subtract an operator or a field."""
        return self + -_operator(other, self.dimension)

    def __rsub__(self, other: Field | float) -> Operator:
        """Subtract from a field."""
        return -self + other

    def __mul__(self, other: Field | float | Operator) -> Operator:
        """Multiply with a field, a number or an operator without unknowns."""
        if isinstance(other, Operator):
            if self.terms and other.terms:
                raise StructureError(
                    "the product of two structures with unknowns is not affine in psi: "
                    "multiply with fields only"
                )
            return self * other.offset if self.terms else other * self.offset
        factor = field(other)
        terms = tuple(Term(term.psi, term.alpha, factor * term.coefficient) for term in self.terms)
        return _collect(self.dimension, factor * self.offset, terms)

    def __rmul__(self, other: Field | float) -> Operator:
        """Multiply with a field on the left."""
        return self * other

    def __truediv__(self, other: Field | float) -> Operator:
        """Divide by a field."""
        return self * (ONE / field(other))


def unknown(dimension: int, index: int = 0) -> Operator:
    """Return the operator u = psi_index."""
    return Operator(dimension, ZERO, (Term(index, (0,) * dimension, ONE),))


def known(dimension: int, value: FieldExpr | Field | float) -> Operator:
    """Return the operator u = value without unknowns."""
    return Operator(dimension, field(value), ())


def renumbered(op: Operator, indices: Mapping[int, int]) -> Operator:
    """Return the operator with psi_m called psi_{indices[m]}; indices that are not mentioned stay."""
    terms = (Term(indices.get(term.psi, term.psi), term.alpha, term.coefficient) for term in op.terms)
    return _collect(op.dimension, op.offset, tuple(terms))


def differentiated(op: Operator, axis: int) -> Operator:
    """Return du/dx_axis by Leibniz' rule: (a d^alpha psi)' = a' d^alpha psi + a (d^alpha psi)'."""
    step = unit(op.dimension, axis)
    terms = []
    for term in op.terms:
        terms.append(Term(term.psi, term.alpha, differentiate(term.coefficient, step)))
        raised = tuple(a + b for a, b in zip(term.alpha, step, strict=True))
        terms.append(Term(term.psi, raised, term.coefficient))
    return _collect(op.dimension, differentiate(op.offset, step), tuple(terms))


def D(w: FieldExpr | Field, op: Operator) -> Operator:
    """Return grad w . grad u, the normal derivative on w = 0 when w is normalised (Shapiro 2007, section 7)."""
    result = known(op.dimension, 0.0)
    for axis in range(op.dimension):
        slope = differentiate(w, unit(op.dimension, axis))
        result = result + slope * differentiated(op, axis)
    return result


def _operator(value: Operator | Field | float, dimension: int) -> Operator:
    if not isinstance(value, Operator):
        return known(dimension, value)
    if value.dimension != dimension:
        raise StructureError(f"cannot combine structures in {dimension} and {value.dimension} dimensions")
    return value


def _collect(dimension: int, offset: FieldExpr, terms: tuple[Term, ...]) -> Operator:
    """Merge terms of equal (psi, alpha) and drop structural zeros."""
    merged: dict[tuple[int, MultiIndex], FieldExpr] = {}
    for term in terms:
        key = (term.psi, term.alpha)
        merged[key] = merged[key] + term.coefficient if key in merged else term.coefficient
    kept = (Term(psi, alpha, f) for (psi, alpha), f in merged.items() if not is_constant(f, 0.0))
    return Operator(dimension, offset, tuple(kept))
