"""Values of user data (numbers or fields) at quadrature points, checked where they must be finite."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field
from rfm.errors import DataError


def values(name: str, datum: Field | float, coords: Sequence[Array], *, check: bool = True) -> Array | float:
    """Values of `datum` at the points `coords`; a number stays a number.

    Parameters
    ----------
    name
        What the datum is, for the message of the error.
    datum
        Number or field.
    coords
        d arrays of one common shape.
    check
        Refuse values that are not finite.  Nodes outside the domain are evaluated with ``check=False``.

    Raises
    ------
    DataError
        A value is not finite.
    """
    if not callable(datum):
        return float(datum)
    with np.errstate(all="ignore"):
        result: Array = partials(datum, coords, 0)[0]
    if check:
        require_finite(name, datum, coords, result)
    return result


def require_finite(name: str, datum: object, coords: Sequence[Array], result: Array) -> None:
    """Raise :class:`DataError` at the first point where `result` is not finite."""
    if np.isfinite(result.sum()):
        return
    bad = ~np.isfinite(result)
    if not bad.any():  # the sum overflowed, the values did not
        return
    first = np.unravel_index(int(np.argmax(bad)), result.shape)
    point = tuple(float(np.broadcast_to(c, result.shape)[first]) for c in coords)
    raise DataError(name, datum, point, float(result[first]))


def as_field(datum: Field | float) -> Field:
    """Return `datum` as a field, numbers as constants."""
    if callable(datum):
        return datum
    number = float(datum)

    def constant(*_: object) -> float:
        return number

    constant.source = repr(number)  # type: ignore[attr-defined]
    return constant
