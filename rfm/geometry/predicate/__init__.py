"""From a predicate over named shapes to one function (Shapiro, Acta Numerica 2007, Theorems 3 and 4).

``formula`` has the predicates, ``simplify`` their normal form and the substitution of shapes, ``report`` says whether
the function that comes out is normalised.
"""

from rfm.geometry.predicate.formula import And, Iff, Implies, Name, Not, Or, Predicate, Product, Xor
from rfm.geometry.predicate.report import NormalisationReport, normalisation_report, normalised_function
from rfm.geometry.predicate.simplify import shape, simplified

__all__ = [
    "And",
    "Iff",
    "Implies",
    "Name",
    "NormalisationReport",
    "Not",
    "Or",
    "Predicate",
    "Product",
    "Xor",
    "normalisation_report",
    "normalised_function",
    "shape",
    "simplified",
]
