"""The bases by name."""

from __future__ import annotations

from difflib import get_close_matches

from rfm.errors import DiscretizationError
from solvers.bases.basis import Basis
from solvers.bases.radial import RADIAL
from solvers.bases.spline import B_SPLINE, WEB_SPLINE
from solvers.bases.tensor import CHEBYSHEV, LEGENDRE, TRIGONOMETRIC

_ALL: tuple[Basis, ...] = (WEB_SPLINE, B_SPLINE, CHEBYSHEV, LEGENDRE, TRIGONOMETRIC, RADIAL)
BASES: dict[str, Basis] = {basis.name: basis for basis in _ALL}


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
