"""Boolean logic on the signs of surfaces.

Notation: ``S`` surfaces of a domain in a fixed order; ``signs (n, S)`` holds +1 (inner side), -1 (outer side) or 0
(both sides, or not known) for ``n`` boxes.  Evaluated by minimum and maximum, the domain's expression gives +1 where
the box lies inside whatever the unknown signs are, -1 where it lies outside, 0 otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.geometry.expression import Conjunction, Node

if TYPE_CHECKING:
    from rfm.geometry.expression import Expression
    from rfm.geometry.surface import Surface

Signs = NDArray[np.int8]
Mask = NDArray[np.bool_]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Logic:
    """The Boolean expression of a domain, evaluated on arrays of signs."""

    expression: Expression
    surfaces: tuple[Surface, ...]

    @cached_property
    def index(self) -> dict[Surface, int]:
        """Column of each surface."""
        return {surface: i for i, surface in enumerate(self.surfaces)}

    @cached_property
    def _root(self) -> _Operation:
        """The expression with columns in place of surfaces."""

        def leaf(surface: Surface, positive: bool) -> _Term:
            return self.index[surface], 1 if positive else -1

        def join(node: Node, terms: list[_Term]) -> _Term:
            return _operation(np.minimum if isinstance(node, Conjunction) else np.maximum, terms)

        found = self.expression.walk(leaf, join)
        return found if isinstance(found, _Operation) else _operation(np.minimum, [found])

    def value(self, signs: Signs) -> Signs:
        """Return the tri-state value, shape ``(n,)``."""
        return self._root.evaluated(signs.T).value

    def relevant(self, signs: Signs) -> Mask:
        """Return which unknown signs can still matter, shape ``(n, S)``.

        A surface matters where its sign and the values of all expressions around it are undecided.
        """
        mask = np.zeros(signs.shape, dtype=bool)
        self._root.evaluated(signs.T).mark(np.ones(len(signs), dtype=bool), signs.T == 0, mask.T)
        return mask

    def table(self, signs: Signs, slots: Integers) -> Mask:
        """Return for each box whether the domain contains it, for all combinations of signs of some surfaces.

        Parameters
        ----------
        signs
            Signs of all surfaces, shape ``(n, S)``.
        slots
            Columns of the surfaces whose signs vary, shape ``(n, m)``.

        Returns
        -------
        Mask
            Shape ``(n, 2**m)``; bit ``a`` of the column number is set when surface ``slots[:, a]`` is positive.
        """
        n, m = slots.shape
        codes = np.arange(2**m)
        chosen = (2 * (codes[:, None] >> np.arange(m) & 1) - 1).astype(np.int8)
        trial = np.repeat(signs[:, None], len(codes), axis=1)
        np.put_along_axis(trial, slots[:, None], chosen[None], axis=2)
        return np.asarray(self.value(trial.reshape(-1, signs.shape[1])) > 0).reshape(n, len(codes))


@dataclass(frozen=True, eq=False)
class _Operation:
    """Minimum or maximum over literals, ``factors (k, 1)`` times the rows ``columns (k,)`` of signs, and operations.

    All literals of a node are one array operation: expressions are evaluated often, on few boxes each time.
    """

    extreme: np.ufunc
    columns: Integers
    factors: Signs
    terms: tuple[_Operation, ...]

    def evaluated(self, signs: Signs) -> _Evaluated:
        """Evaluate on signs ``(S, n)``."""
        terms = [term.evaluated(signs) for term in self.terms]
        value = reduce(self.extreme, [term.value for term in terms]) if terms else None
        if len(self.columns):
            own = self.extreme.reduce(signs[self.columns] * self.factors, axis=0)
            value = own if value is None else self.extreme(own, value)
        return _Evaluated(self, np.asarray(value), terms)


@dataclass(frozen=True, eq=False)
class _Evaluated:
    """An operation with its value ``(n,)`` and those of its terms."""

    operation: _Operation
    value: Signs
    terms: list[_Evaluated]

    def mark(self, open_above: Mask, unknown: Mask, mask: Mask) -> None:
        """Mark the ``unknown (S, n)`` signs that matter where everything above is undecided."""
        still_open = open_above & (self.value == 0)
        columns = self.operation.columns
        mask[columns] |= still_open & unknown[columns]
        for term in self.terms:
            term.mark(still_open, unknown, mask)


_Term: TypeAlias = tuple[int, int] | _Operation
"""A literal, its column and its factor 1 or -1, or an operation."""


def _operation(extreme: np.ufunc, terms: Sequence[_Term]) -> _Operation:
    literals = [term for term in terms if not isinstance(term, _Operation)]
    return _Operation(
        extreme,
        np.array([column for column, _ in literals], dtype=np.int64),
        np.array([[factor] for _, factor in literals], dtype=np.int8).reshape(-1, 1),
        tuple(term for term in terms if isinstance(term, _Operation)),
    )
