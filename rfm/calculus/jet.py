r"""Jets: truncated Taylor expansions, the value and all partial derivatives at once.

Notation: a jet of order m at a point x lists c_alpha = d^alpha f(x)/alpha! for |alpha| <= m, in the order of
`multi_indices`. A field evaluated on the jets of its coordinates, f(x + h_1, y + h_2, ...), gives its own
jet. The coefficients may be arrays (many points at once), intervals (enclosures of the derivatives over a
box) or JAX arrays. `rfm.calculus.jets` differentiates fields with them.

References: Griewank and Walther, Evaluating Derivatives (SIAM 2008), chapter 13; Tsukanov and Hall, Data
structure and algorithms for fast automatic differentiation (IJNME 56, 2003), who use them for solution
structures.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from rfm.calculus import taylor
from rfm.calculus.multi_index import MultiIndex, taylor_space
from rfm.calculus.types import Value


class Jet:
    """A truncated Taylor expansion in `dim` variables.

    Parameters
    ----------
    dim
        Number of variables.
    order
        Highest degree kept.
    coefficients
        d^alpha f/alpha! in the order of ``multi_indices(dim, order)``. Python floats 0.0 are structural
        zeros and cost nothing.

    Notes
    -----
    Jets of different orders combine to the lower order.  Comparisons look at the values.
    """

    __slots__ = ("coefficients", "dim", "order")
    __array_ufunc__ = None  # so that array * jet reaches Jet.__rmul__
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, dim: int, order: int, coefficients: taylor.Coefficients) -> None:
        self.dim = dim
        self.order = order
        self.coefficients = coefficients

    @property
    def value(self) -> Value:
        """The value at the point, c_0."""
        return self.coefficients[0]

    def derivative(self, alpha: MultiIndex) -> Value:
        """Return the partial derivative d^alpha f = alpha! c_alpha at the point."""
        space = taylor_space(self.dim, self.order)
        if alpha not in space.position:
            raise ValueError(f"a jet in {self.dim} variables of order {self.order} has no derivative {alpha}")
        i = space.position[alpha]
        scale, c = space.factorials[i], self.coefficients[i]
        return c if scale == 1.0 else c * scale

    def truncate(self, order: int) -> Jet:
        """Return the jet of a lower order."""
        if order >= self.order:
            return self
        return Jet(self.dim, order, self.coefficients[: taylor_space(self.dim, order).starts[-1]])

    def apply(self, series: Callable[[Value, int], Sequence[Value]]) -> Jet:
        """Apply a function F of one variable.

        Parameters
        ----------
        series
            Called with the value f_0 and the order m, returns F^(k)(f_0)/k! for k = 0..m. Where a derivative
            does not exist it is inf or nan, silently.
        """
        space = taylor_space(self.dim, self.order)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            head = series(self.coefficients[0], self.order)
            coefficients = taylor.compose(head, self.coefficients, space)
        return Jet(self.dim, self.order, coefficients)

    def __repr__(self) -> str:
        return f"Jet(dim={self.dim}, order={self.order}, coefficients={self.coefficients!r})"

    # Arithmetic.  The first branch of each is the hot path.

    def __add__(self, other: Value) -> Jet:
        if type(other) is Jet:
            a, b = _aligned(self, other)
            return Jet(a.dim, a.order, taylor.add(a.coefficients, b.coefficients))
        return Jet(self.dim, self.order, (self.coefficients[0] + other, *self.coefficients[1:]))

    __radd__ = __add__

    def __sub__(self, other: Value) -> Jet:
        if type(other) is Jet:
            a, b = _aligned(self, other)
            return Jet(a.dim, a.order, taylor.subtract(a.coefficients, b.coefficients))
        return Jet(self.dim, self.order, (self.coefficients[0] - other, *self.coefficients[1:]))

    def __rsub__(self, other: Value) -> Jet:
        c = self.coefficients
        return Jet(self.dim, self.order, (other - c[0], *[b if taylor.is_zero(b) else -b for b in c[1:]]))

    def __neg__(self) -> Jet:
        return Jet(self.dim, self.order, tuple([b if taylor.is_zero(b) else -b for b in self.coefficients]))

    def __pos__(self) -> Jet:
        return self

    def __mul__(self, other: Value) -> Jet:
        if other is self:
            squared: Jet = self._square()
            return squared
        if type(other) is Jet:
            a, b = _aligned(self, other)
            space = taylor_space(a.dim, a.order)
            return Jet(a.dim, a.order, taylor.product(a.coefficients, b.coefficients, space))
        return Jet(self.dim, self.order, taylor.scale(self.coefficients, other))

    __rmul__ = __mul__

    def __truediv__(self, other: Value) -> Jet:
        if type(other) is Jet:
            a, b = _aligned(self, other)
            space = taylor_space(a.dim, a.order)
            return Jet(a.dim, a.order, taylor.quotient(a.coefficients, b.coefficients, space))
        if type(other) is float and other != 0.0:
            return Jet(self.dim, self.order, tuple([c / other for c in self.coefficients]))
        divided = [c if taylor.is_zero(c) else taylor.divide(c, other) for c in self.coefficients]
        return Jet(self.dim, self.order, tuple(divided))

    def __rtruediv__(self, other: Value) -> Jet:
        space = taylor_space(self.dim, self.order)
        constant = (other, *[0.0] * (space.starts[-1] - 1))
        return Jet(self.dim, self.order, taylor.quotient(constant, self.coefficients, space))

    def __pow__(self, exponent: Value) -> Jet:
        if type(exponent) is int and exponent == 2:
            return self._square()
        if isinstance(exponent, Jet):
            from rfm.calculus.functions import exp, log

            result: Jet = exp(exponent * log(self))
            return result
        if isinstance(exponent, int | float | np.number) and float(exponent).is_integer():
            n = int(exponent)
            return self._integer_power(n) if n >= 0 else 1.0 / self._integer_power(-n)
        return self.apply(lambda value, order: _power_series(value, exponent, order))

    def __rpow__(self, base: Value) -> Jet:
        from rfm.calculus.functions import exp, log

        result: Jet = exp(self * log(base))
        return result

    def __abs__(self) -> Jet:
        from rfm.calculus.selection import absolute

        result: Jet = absolute(self)
        return result

    def _square(self) -> Jet:
        space = taylor_space(self.dim, self.order)
        return Jet(self.dim, self.order, taylor.square(self.coefficients, space))

    def _integer_power(self, n: int) -> Jet:
        """Multiply repeatedly, so that negative bases and zeros are as good as any."""
        result: Jet = taylor.repeated_product(self, n) if n else self * 0.0 + 1.0
        return result

    # Comparisons look at the values: they steer `where`, they are not equalities of expansions.

    def __lt__(self, other: Value) -> Value:
        return self.value < value_of(other)

    def __le__(self, other: Value) -> Value:
        return self.value <= value_of(other)

    def __gt__(self, other: Value) -> Value:
        return self.value > value_of(other)

    def __ge__(self, other: Value) -> Value:
        return self.value >= value_of(other)

    def __eq__(self, other: object) -> Value:
        return self.value == value_of(other)

    def __ne__(self, other: object) -> Value:
        return self.value != value_of(other)


def value_of(x: Value) -> Value:
    """Return the value of a jet, and anything else as it is."""
    return x.coefficients[0] if type(x) is Jet else x


def _aligned(a: Jet, b: Jet) -> tuple[Jet, Jet]:
    if a.dim != b.dim:
        raise ValueError(f"jets in {a.dim} and in {b.dim} variables do not combine")
    if a.order == b.order:
        return a, b
    return a.truncate(b.order), b.truncate(a.order)


def _power_series(value: Value, exponent: Value, order: int) -> list[Value]:
    """Binomial series; each power is taken by itself, so that 0**2.5 has its two zero derivatives."""
    series, binomial = [], 1.0
    for k in range(order + 1):
        series.append(value ** (exponent - k) * binomial)
        binomial = binomial * (exponent - k) / (k + 1.0)
    return series


def variables(coords: Sequence[Value], order: int) -> tuple[Jet, ...]:
    """Return the jets of the coordinates, x_i + h_i.

    Parameters
    ----------
    coords
        One value for each coordinate (numbers, arrays, intervals, JAX arrays).
    order
        Highest degree.
    """
    dim = len(coords)
    count = taylor_space(dim, order).starts[-1]
    result = []
    for i, x in enumerate(coords):
        rest = [0.0] * (count - 1)
        if order > 0:
            rest[i] = 1.0
        # A Python float would be taken for a structural zero, and would raise where NumPy gives inf.
        result.append(Jet(dim, order, (np.float64(x) if isinstance(x, int | float) else x, *rest)))
    return tuple(result)
