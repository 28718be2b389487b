r"""R-functions: real functions that do Boolean algebra on signs.

Notation: f, g are values of functions that are positive inside and negative outside; f ^ g (conjunction)
is positive exactly where both are, f v g (disjunction) where one is, -f is the negation. Every system obeys
De Morgan's law f v g = -((-f) ^ (-g)). The upper sign belongs to the conjunction ([1], section 3):

    R_alpha   (f + g -+ sqrt(f^2 + g^2 - 2 alpha f g))/(1 + alpha),   -1 < alpha <= 1
    R_1       min(f, g), max(f, g)                                    (R_alpha with alpha = 1)
    R_0       f + g -+ sqrt(f^2 + g^2)                                (R_alpha with alpha = 0)
    R_0^m     (f + g -+ sqrt(f^2 + g^2)) (f^2 + g^2)^(m/2)
    R_p       f + g -+ (f^p + g^p)^(1/p),   p even

R_0 is analytic except at f = g = 0; R_0^m is m times differentiable there too, and R_p keeps normalisation
to order p - 1.  The formulas live in `rfm.calculus.systems`, one concept to a file: `alpha` (also with alpha a
function), `powers`, `nary` (for any number of arguments), `conditional`, `spline` (piecewise polynomials) and `names`.

References: [1] Shapiro, Semi-analytic geometry with R-functions, Acta Numerica 16 (2007), 239-303;
[2] Rvachev, Theory of R-functions and some applications (Naukova Dumka, Kiev 1982, in Russian).
"""

from rfm.calculus.systems.alpha import R0, RAlpha, RAlphaField, RAlphaOf
from rfm.calculus.systems.base import RSystem
from rfm.calculus.systems.conditional import (
    choice,
    conditional_conjunction,
    conditional_disjunction,
    equivalence,
    implication,
)
from rfm.calculus.systems.names import NAMES, system
from rfm.calculus.systems.nary import RNorm, RSum
from rfm.calculus.systems.powers import R1, R0m, Rp
from rfm.calculus.systems.scaling import Scaled, magnitude, scaled
from rfm.calculus.systems.spline import RSpline
from rfm.calculus.systems.spline_groups import spline_system

__all__ = [
    "NAMES",
    "R0",
    "R1",
    "R0m",
    "RAlpha",
    "RAlphaField",
    "RAlphaOf",
    "RNorm",
    "RSpline",
    "RSum",
    "RSystem",
    "Rp",
    "Scaled",
    "choice",
    "conditional_conjunction",
    "conditional_disjunction",
    "equivalence",
    "implication",
    "magnitude",
    "scaled",
    "spline_system",
    "system",
]
