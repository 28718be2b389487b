"""Systems of R-functions by name, as case files and the command line give them."""

from __future__ import annotations

import re
from collections.abc import Callable

from rfm.calculus.systems.alpha import R0, RAlpha
from rfm.calculus.systems.base import RSystem
from rfm.calculus.systems.nary import RNorm, RSum
from rfm.calculus.systems.powers import R1, R0m, Rp
from rfm.calculus.systems.spline_groups import spline_system
from rfm.errors import GeometryError

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)"

_PATTERNS: tuple[tuple[str, Callable[[re.Match[str]], RSystem]], ...] = (
    (r"r1", lambda _: R1()),
    (r"r0", lambda _: R0),
    (r"r0m(\d+)", lambda match: R0m(int(match[1]))),
    (r"rp(\d+)", lambda match: Rp(int(match[1]))),
    (rf"ralpha({_NUMBER})", lambda match: RAlpha(float(match[1]))),
    (r"rnorm(\d+)", lambda match: RNorm(int(match[1]))),
    (r"rsum(\d+)", lambda match: RSum(int(match[1]))),
    (
        rf"spline(\d+)(?:[:_]group(\d+))?(?:[:_]bound({_NUMBER}))?",
        lambda match: spline_system(int(match[1]), int(match[2] or 1), float(match[3] or 1.0)),
    ),
)

# The names worth listing to a user; `system` knows the other parameters too.
NAMES: tuple[str, ...] = ("r0", "r1", "rp2", "rp4", "r0m1", "r0m2", "rnorm2", "spline2", "spline3")


def system(name: str) -> RSystem:
    """Return the R-system with a name.

    Parameters
    ----------
    name
        ``r1``, ``r0``, ``r0m2``, ``rp4``, ``ralpha0.5``, ``rnorm3``, ``rsum1``, ``spline2``, ``spline3:group4``,
        ``spline3:group4:bound2.5`` (or with ``_`` for ``:``, which makes it an identifier).

    Raises
    ------
    GeometryError
        If there is none, the message lists the names; or if a parameter is out of range.
    """
    for pattern, build in _PATTERNS:
        match = re.fullmatch(pattern, name.strip().lower())
        if match:
            return build(match)
    raise GeometryError(f"unknown R-system {name!r}; choose one of {', '.join(NAMES)}")
