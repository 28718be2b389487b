"""Formulas on numbers, jets, intervals and JAX arrays.

A field is written once, with ordinary arithmetic and the functions of this package, and is evaluated
four ways: on arrays, on jets (value and partial derivatives), on intervals (bounds over boxes) and on
JAX arrays.
"""

from rfm.calculus.functions import (
    abs_,
    absolute,
    acos,
    asin,
    atan,
    atan2,
    cos,
    cosh,
    erf,
    exp,
    hypot,
    log,
    maximum,
    minimum,
    power,
    sign,
    sin,
    sinh,
    sqrt,
    square,
    tan,
    tanh,
    where,
)
from rfm.calculus.intervals import Interval
from rfm.calculus.jets import Jet, derivative, derivatives, gradient, multi_indices, partials, variables
from rfm.calculus.r_systems import R0, R1, R0m, RAlpha, Rp, RSystem, equivalence, system
from rfm.calculus.tri_state import TriState
from rfm.calculus.types import Array, Field, Value

__all__ = [
    "R0",
    "R1",
    "Array",
    "Field",
    "Interval",
    "Jet",
    "R0m",
    "RAlpha",
    "RSystem",
    "Rp",
    "TriState",
    "Value",
    "abs_",
    "absolute",
    "acos",
    "asin",
    "atan",
    "atan2",
    "cos",
    "cosh",
    "derivative",
    "derivatives",
    "equivalence",
    "erf",
    "exp",
    "gradient",
    "hypot",
    "log",
    "maximum",
    "minimum",
    "multi_indices",
    "partials",
    "power",
    "sign",
    "sin",
    "sinh",
    "sqrt",
    "square",
    "system",
    "tan",
    "tanh",
    "variables",
    "where",
]
