"""Fields with arithmetic: coefficient formulas that read like the paper.

A *field* is any callable ``f(x, y[, z])`` on floats, arrays, jets or intervals.  :func:`field` wraps
one so that ``w**2 * phi - 1`` is again a field.  The result is a small directed graph whose leaves are
the user's callables; :mod:`structures.expansion` evaluates several graphs together, each leaf once.

Notation: alpha is a multi-index, d^alpha the partial derivative.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import derivative
from rfm.calculus.types import Field, Value

MultiIndex = tuple[int, ...]


class FieldExpr:
    """A field with ``+ - * / **``; build one with :func:`field`.

    Numbers fold and structural zeros and ones disappear, so that operator coefficients keep the
    sparsity of the formula they came from.
    """

    __array_ufunc__ = None  # numpy scalars on the left defer to __radd__ and friends

    @property
    def children(self) -> tuple[FieldExpr, ...]:
        """The fields this one is made of."""
        return ()

    @property
    def operands(self) -> tuple[FieldExpr, ...]:
        """The children whose plain values suffice to compute this one's."""
        return self.children

    def at(self, coords: Sequence[Value], values: Sequence[Value]) -> Value:
        """Return the value at ``coords`` given the values of :attr:`operands` there."""
        raise TypeError(f"{type(self).__name__} cannot be evaluated; build fields with field(...)")

    def __call__(self, *coords: Value) -> Value:
        """Evaluate at coordinates of any kind (floats, arrays, jets, intervals, jax arrays)."""
        values: dict[int, Value] = {}
        for node in children_first((self,), lambda node: node.operands):
            values[id(node)] = node.at(coords, [values[id(child)] for child in node.operands])
        return values[id(self)]

    def __add__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the sum as a field."""
        return self._sum(self, other) if _is_field(other) else NotImplemented

    def __radd__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the sum as a field."""
        return self._sum(other, self) if _is_field(other) else NotImplemented

    def __sub__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the difference as a field."""
        return self._difference(self, other) if _is_field(other) else NotImplemented

    def __rsub__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the difference as a field."""
        return self._difference(other, self) if _is_field(other) else NotImplemented

    def __mul__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the product as a field."""
        return self._product(self, other) if _is_field(other) else NotImplemented

    def __rmul__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the product as a field."""
        return self._product(other, self) if _is_field(other) else NotImplemented

    def __truediv__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the quotient as a field."""
        return self._quotient(self, other) if _is_field(other) else NotImplemented

    def __rtruediv__(self, other: FieldExpr | Field | float) -> FieldExpr:
        """Return the quotient as a field."""
        return self._quotient(other, self) if _is_field(other) else NotImplemented

    def __pow__(self, exponent: float) -> FieldExpr:
        """Return the power with a constant exponent as a field."""
        if exponent == 0:
            return ONE
        if exponent == 1:
            return self
        whole = int(exponent)  # integer powers are defined for negative bases and cheap on jets
        return _fold(_Power(whole if whole == exponent else exponent), self)

    def __neg__(self) -> FieldExpr:
        """Return the negative as a field."""
        return _fold(operator.neg, self)

    @staticmethod
    def _sum(a: FieldExpr | Field | float, b: FieldExpr | Field | float) -> FieldExpr:
        f, g = field(a), field(b)
        if is_constant(f, 0.0):
            return g
        return f if is_constant(g, 0.0) else _fold(operator.add, f, g)

    @staticmethod
    def _difference(a: FieldExpr | Field | float, b: FieldExpr | Field | float) -> FieldExpr:
        f, g = field(a), field(b)
        if is_constant(f, 0.0):
            return -g
        return f if is_constant(g, 0.0) else _fold(operator.sub, f, g)

    @staticmethod
    def _product(a: FieldExpr | Field | float, b: FieldExpr | Field | float) -> FieldExpr:
        f, g = field(a), field(b)
        if is_constant(f, 0.0) or is_constant(g, 0.0):
            return ZERO
        if is_constant(f, 1.0):
            return g
        return f if is_constant(g, 1.0) else _fold(operator.mul, f, g)

    @staticmethod
    def _quotient(a: FieldExpr | Field | float, b: FieldExpr | Field | float) -> FieldExpr:
        f, g = field(a), field(b)
        return f if is_constant(f, 0.0) or is_constant(g, 1.0) else _fold(operator.truediv, f, g)


@dataclass(frozen=True, eq=False)
class Constant(FieldExpr):
    """The same number everywhere."""

    value: float

    def at(self, coords: Sequence[Value], values: Sequence[Value]) -> Value:
        """Return the number itself; callers broadcast."""
        return self.value


@dataclass(frozen=True, eq=False)
class Leaf(FieldExpr):
    """A callable somebody else wrote."""

    function: Field

    def at(self, coords: Sequence[Value], values: Sequence[Value]) -> Value:
        """Call it."""
        return self.function(*coords)


@dataclass(frozen=True, eq=False)
class Arithmetic(FieldExpr):
    """An elementary operation on one or two fields; the rule works on every kind of value."""

    rule: Callable[..., Value]
    of: tuple[FieldExpr, ...]

    @property
    def children(self) -> tuple[FieldExpr, ...]:
        """The operands."""
        return self.of

    def at(self, coords: Sequence[Value], values: Sequence[Value]) -> Value:
        """Apply the rule."""
        return self.rule(*values)


@dataclass(frozen=True, eq=False)
class Derivative(FieldExpr):
    """The partial derivative d^alpha of a field."""

    of: FieldExpr
    alpha: MultiIndex

    @property
    def children(self) -> tuple[FieldExpr, ...]:
        """The differentiated field."""
        return (self.of,)

    @property
    def operands(self) -> tuple[FieldExpr, ...]:
        """Nothing: the plain value of a field does not tell its derivative."""
        return ()

    def at(self, coords: Sequence[Value], values: Sequence[Value]) -> Value:
        """Evaluate through :func:`rfm.calculus.jets.derivative`, which takes jets as coordinates too."""
        return derivative(self.of, self.alpha)(*coords)


@dataclass(frozen=True)
class _Power:
    exponent: float

    def __call__(self, value: Value) -> Value:
        return value**self.exponent


ZERO: FieldExpr = Constant(0.0)
ONE: FieldExpr = Constant(1.0)
_NUMBERS = (int, float, np.integer, np.floating)


def field(value: FieldExpr | Field | float) -> FieldExpr:
    """Return ``value`` (a callable, a number or already a :class:`FieldExpr`) as a field with arithmetic.

    Raises
    ------
    TypeError
        When ``value`` is none of these.
    """
    if isinstance(value, FieldExpr):
        return value
    if isinstance(value, _NUMBERS):
        return Constant(float(value))
    if callable(value):
        return Leaf(value)
    raise TypeError(f"a field is a callable f(x, y[, z]) or a number, got {type(value).__name__}")


def is_constant(f: FieldExpr, value: float) -> bool:
    """Tell whether ``f`` is structurally the number ``value``."""
    return isinstance(f, Constant) and f.value == value


def differentiate(f: FieldExpr | Field | float, alpha: MultiIndex) -> FieldExpr:
    """Return d^alpha f; nested derivatives merge, constants vanish."""
    g = field(f)
    if not any(alpha):
        return g
    if isinstance(g, Constant):
        return ZERO
    if isinstance(g, Derivative):
        return Derivative(g.of, tuple(a + b for a, b in zip(g.alpha, alpha, strict=True)))
    return Derivative(g, alpha)


def unit(dimension: int, axis: int) -> MultiIndex:
    """Return the multi-index of the first derivative along ``axis``."""
    return tuple(int(k == axis) for k in range(dimension))


def children_first(
    roots: Sequence[FieldExpr], below: Callable[[FieldExpr], tuple[FieldExpr, ...]]
) -> list[FieldExpr]:
    """Return every node reachable through ``below`` once, operands before operations.

    An explicit stack instead of recursion: sums built in a loop are deep.
    """
    done: dict[int, FieldExpr] = {}
    stack = [(root, False) for root in reversed(roots)]
    while stack:
        node, expanded = stack.pop()
        if id(node) in done:
            continue
        if expanded:
            done[id(node)] = node
        else:
            stack.append((node, True))
            stack.extend((child, False) for child in reversed(below(node)))
    return list(done.values())


def _is_field(value: object) -> bool:
    """Operators answer for themselves; everything callable or numeric is a field."""
    return callable(value) or isinstance(value, _NUMBERS)


def _fold(rule: Callable[..., Value], *operands: FieldExpr) -> FieldExpr:
    if all(isinstance(f, Constant) for f in operands):
        return Constant(float(rule(*(f.value for f in operands if isinstance(f, Constant)))))
    return Arithmetic(rule, operands)
