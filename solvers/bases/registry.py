"""The bases by name."""

from __future__ import annotations

from difflib import get_close_matches

from rfm.errors import DiscretizationError
from rfm.lazy import Registry
from solvers.bases.basis import Basis

BASES: Registry[Basis] = Registry(
    {
        "web-spline": "solvers.bases.spline:WEB_SPLINE",
        "b-spline": "solvers.bases.spline:B_SPLINE",
        "chebyshev": "solvers.bases.tensor:CHEBYSHEV",
        "legendre": "solvers.bases.tensor:LEGENDRE",
        "trigonometric": "solvers.bases.tensor:TRIGONOMETRIC",
        "radial": "solvers.bases.radial:RADIAL",
    }
)


def basis(name: str) -> Basis:
    """The basis of that name.

    Raises
    ------
    DiscretizationError
        There is none.
    """
    if name in BASES:
        return BASES[name]
    close = get_close_matches(name, BASES, 1)
    hint = f"did you mean {close[0]!r}?" if close else f"the bases are: {', '.join(BASES)}"
    raise DiscretizationError(f"unknown basis {name!r}; {hint}")
