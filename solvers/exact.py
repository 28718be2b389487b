"""The exact solution of a problem: one field, or one for each component of a vector."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field

Exact = Field | tuple[Field, ...]
"""A field, or one for each component."""


def components_of(exact: Exact) -> tuple[Field, ...]:
    """Fields of the components."""
    return exact if isinstance(exact, tuple) else (exact,)


def exact_jet(exact: Exact, coords: Sequence[Array], order: int) -> Array:
    """Partial derivatives up to `order`, the jets of the components one below the other.

    Returns
    -------
    ndarray, shape (n_components * n_beta, *points)
    """
    jets = [partials(component, coords, order) for component in components_of(exact)]
    return jets[0] if len(jets) == 1 else np.concatenate(jets)


def required(exact: Exact | None) -> Exact:
    """Return the exact solution.

    Raises
    ------
    ValueError
        There is none, but data are taken from it.
    """
    if exact is None:
        raise ValueError("data 'from exact' need an exact solution")
    return exact
