"""Expressions of a case file: parsed through a whitelist, evaluated on any kind of value."""

from rfm.app.expressions.expression import Expression, ExpressionField
from rfm.app.expressions.syntax import ExpressionError
from rfm.app.expressions.vocabulary import CONSTANTS, FUNCTIONS, RESERVED, VARIABLES

__all__ = [
    "CONSTANTS",
    "FUNCTIONS",
    "RESERVED",
    "VARIABLES",
    "Expression",
    "ExpressionError",
    "ExpressionField",
]
