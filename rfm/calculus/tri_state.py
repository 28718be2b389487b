"""Conditions on intervals: certainly true, certainly false, or undecided."""

from __future__ import annotations

from typing import Any

import numpy as np


class TriState:
    """The truth of a comparison over boxes.

    Parameters
    ----------
    certain
        Boolean array: the comparison holds everywhere in the box.
    possible
        Boolean array: the comparison may hold somewhere in the box.

    Notes
    -----
    It combines with ``& | ~`` like Boolean arrays do. It has a truth value only where it is decided, and is
    meant for `rfm.calculus.functions.where`.
    """

    __slots__ = ("certain", "possible")
    __array_ufunc__ = None

    def __init__(self, certain: Any, possible: Any) -> None:
        self.certain = certain
        self.possible = possible

    @staticmethod
    def of(condition: Any) -> TriState:
        """Take a Boolean or Boolean array for a decided condition."""
        return condition if isinstance(condition, TriState) else TriState(condition, condition)

    @property
    def undecided(self) -> Any:
        """Boolean array: neither certainly true nor certainly false."""
        return np.logical_and(self.possible, np.logical_not(self.certain))

    def __and__(self, other: Any) -> TriState:
        other = TriState.of(other)
        return TriState(
            np.logical_and(self.certain, other.certain), np.logical_and(self.possible, other.possible)
        )

    __rand__ = __and__

    def __or__(self, other: Any) -> TriState:
        other = TriState.of(other)
        return TriState(
            np.logical_or(self.certain, other.certain), np.logical_or(self.possible, other.possible)
        )

    __ror__ = __or__

    def __invert__(self) -> TriState:
        return TriState(np.logical_not(self.possible), np.logical_not(self.certain))

    def __bool__(self) -> bool:
        if np.all(self.certain):
            return True
        if not np.any(self.possible):
            return False
        raise TypeError("the condition is undecided over the box; use rfm.calculus.where instead of `if`")

    def __repr__(self) -> str:
        return f"TriState(certain={self.certain!r}, possible={self.possible!r})"
