r"""Logical operations beyond "and" and "or": equivalence of boundaries, implication, conditional R-functions.

Notation: :math:`\wedge, \vee` are those of any system, c is a condition, positive where it holds.

.. math:: f \to g &= (-f) \vee g, \\
          f \wedge_c g &= f \wedge (c \to g), \\
          f \vee_c g &= f \vee (c \wedge g), \\
          (c\,?\,f : g) &= (c \to f) \wedge (-c \to g).

A *conditional* operation acts only where its condition holds: where c is negative, :math:`f \wedge_c g` and
:math:`f \vee_c g` have the sign of f, and g neither cuts nor adds.  They are built from the system's own operations,
so they are continuous, as smooth as the system is, and normalised where it is: near a point of g = 0 with f, c > 0
the value is g to the order that the system keeps.  A triangle's trimming volume is such a conjunction: the line of
an edge cuts only near that edge.

References: Shapiro, Acta Numerica 16 (2007), sections 3 (conditional R-functions, (3.7)) and 5; the operations are
written here from their truth tables.
"""

from __future__ import annotations

from rfm.calculus.functions import absolute, guarded_power, power, where
from rfm.calculus.jet import value_of
from rfm.calculus.systems.alpha import R0
from rfm.calculus.systems.base import RSystem
from rfm.calculus.types import Value
from rfm.errors import GeometryError


def equivalence(a: Value, b: Value, p: int = 2) -> Value:
    """Join two distance functions of pieces of boundary into that of their union, equation (5.3).

    Parameters
    ----------
    a, b
        Values of functions that vanish on one piece each, normalised to order `p`.
    p
        Order to which the normalisation is kept.

    Returns
    -------
    Value
        ``a*b/(|a|^p + |b|^p)^(1/p)``, 0 where both vanish.
    """
    if p < 1:
        raise GeometryError(f"the R-equivalence needs p >= 1, got {p}")
    powers = power(a, p) + power(b, p) if p % 2 == 0 else power(absolute(a), p) + power(absolute(b), p)
    root = guarded_power(powers, 1.0 / p)
    return a * b / where(value_of(root) == 0.0, 1.0, root)


def implication(f: Value, g: Value, system: RSystem = R0) -> Value:
    """Return f -> g, positive where f is negative or g positive."""
    return system.disjunction(system.negation(f), g)


def conditional_conjunction(f: Value, g: Value, condition: Value, system: RSystem = R0) -> Value:
    """Return f ^ (condition -> g): g cuts f only where the condition is positive.

    Parameters
    ----------
    f, g
        Values of functions that are positive inside.
    condition
        Value of a function that is positive where g is to cut.
    system
        The R-functions.
    """
    return system.conjunction(f, implication(condition, g, system))


def conditional_disjunction(f: Value, g: Value, condition: Value, system: RSystem = R0) -> Value:
    """Return f v (condition ^ g): g is added to f only where the condition is positive."""
    return system.disjunction(f, system.conjunction(condition, g))


def choice(condition: Value, f: Value, g: Value, system: RSystem = R0) -> Value:
    """Return an R-function with the sign of f where the condition is positive, of g where it is negative."""
    return system.conjunction(
        implication(condition, f, system), implication(system.negation(condition), g, system)
    )
