"""The words of an expression: constants, coordinates and functions.  Nothing else can be named or called."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any

from rfm.calculus.types import Value

CONSTANTS = {"pi": math.pi, "e": math.e}

COORDINATES = ("x", "y", "z")

VARIABLES = (*COORDINATES, "t")
"""Names that stand for the point and the time at which an expression is evaluated."""


@dataclass(frozen=True)
class Function:
    """A function that expressions may call.

    Attributes
    ----------
    name
        Name in the expression.
    minimum, maximum
        Number of arguments; no upper limit when `maximum` is None.
    meaning
        One line for the list of functions.
    calculus
        Name of the function in :mod:`rfm.calculus.functions` that does the work.
    """

    name: str
    minimum: int
    maximum: int | None
    meaning: str
    calculus: str

    @property
    def arity(self) -> str:
        """Number of arguments in words."""
        if self.maximum is None:
            return f"at least {self.minimum} arguments"
        return "1 argument" if self.minimum == 1 else f"{self.minimum} arguments"

    def __call__(self, *arguments: Value) -> Value:
        """Value of the function; with more than two arguments a binary one is applied from the left."""
        function = self._implementation()
        if self.maximum is None:
            return reduce(function, arguments)
        return function(*arguments)

    def _implementation(self) -> Callable[..., Any]:
        from rfm.calculus import functions

        implementation: Callable[..., Any] = getattr(functions, self.calculus)
        return implementation


def _unary(*rows: tuple[str, str]) -> dict[str, Function]:
    return {name: Function(name, 1, 1, meaning, name) for name, meaning in rows}


FUNCTIONS: dict[str, Function] = {
    **_unary(
        ("sin", "sine of an angle in radians"),
        ("cos", "cosine"),
        ("tan", "tangent"),
        ("asin", "arc sine, in [-pi/2, pi/2]"),
        ("acos", "arc cosine, in [0, pi]"),
        ("atan", "arc tangent, in (-pi/2, pi/2)"),
        ("sinh", "hyperbolic sine"),
        ("cosh", "hyperbolic cosine"),
        ("tanh", "hyperbolic tangent"),
        ("exp", "exponential function"),
        ("log", "natural logarithm"),
        ("sqrt", "square root"),
        ("erf", "error function"),
        ("sign", "-1, 0 or 1"),
    ),
    "abs": Function("abs", 1, 1, "absolute value", "absolute"),
    "atan2": Function("atan2", 2, 2, "atan2(y, x): angle of the point (x, y), in (-pi, pi]", "atan2"),
    "hypot": Function("hypot", 2, 2, "hypot(a, b): sqrt(a^2 + b^2)", "hypot"),
    "min": Function("min", 2, None, "smallest of the arguments", "minimum"),
    "max": Function("max", 2, None, "largest of the arguments", "maximum"),
    "where": Function("where", 3, 3, "where(condition, a, b): a where the condition holds, else b", "where"),
}

RESERVED = frozenset({*CONSTANTS, *VARIABLES, *FUNCTIONS, "u", "and", "or", "not", "all", "rest", "domain"})
"""Names that parameters and shapes may not take."""
