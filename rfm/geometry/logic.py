"""Boolean logic on the signs of surfaces.

Notation: ``S`` surfaces of a domain in a fixed order; ``signs (n, S)`` holds +1 (inner side), -1 (outer side) or 0
(both sides, or not known) for ``n`` boxes.  Evaluated by minimum and maximum, the domain's expression gives +1 where
the box lies inside whatever the unknown signs are, -1 where it lies outside, 0 otherwise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rfm.geometry.expression import Expression
    from rfm.geometry.surface import Surface

Signs = NDArray[np.int8]
Mask = NDArray[np.bool_]
Integers = NDArray[np.int64]
Visit = Callable[[Mask], None]


@dataclass(frozen=True, eq=False)
class Logic:
    """The Boolean expression of a domain, evaluated on arrays of signs."""

    expression: Expression
    surfaces: tuple[Surface, ...]

    @cached_property
    def index(self) -> dict[Surface, int]:
        """Column of each surface."""
        return {surface: i for i, surface in enumerate(self.surfaces)}

    def value(self, signs: Signs) -> Signs:
        """Return the tri-state value, shape ``(n,)``."""
        return np.asarray(self.expression.evaluate({s: signs[:, i] for i, s in enumerate(self.surfaces)}))

    def relevant(self, signs: Signs) -> Mask:
        """Return which unknown signs can still matter, shape ``(n, S)``.

        A surface matters where its sign and the values of all expressions around it are undecided.
        """
        mask = np.zeros(signs.shape, dtype=bool)

        def leaf(surface: Surface, positive: bool) -> tuple[Signs, Visit]:
            column = self.index[surface]
            value = signs[:, column] if positive else -signs[:, column]

            def visit(open_above: Mask) -> None:
                mask[:, column] |= open_above & (value == 0)

            return value, visit

        def node(terms: list[tuple[Signs, Visit]], extreme: np.ufunc) -> tuple[Signs, Visit]:
            value = reduce(extreme, [term[0] for term in terms])

            def visit(open_above: Mask) -> None:
                still_open = open_above & (value == 0)
                for _, inner in terms:
                    inner(still_open)

            return value, visit

        _, visit = self.expression.fold(
            leaf, lambda terms: node(terms, np.minimum), lambda terms: node(terms, np.maximum)
        )
        visit(np.ones(len(signs), dtype=bool))
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
        rows = np.arange(n)
        table = np.empty((n, 2**m), dtype=bool)
        trial = signs.copy()
        for code in range(2**m):
            for a in range(m):
                trial[rows, slots[:, a]] = 1 if code >> a & 1 else -1
            table[:, code] = self.value(trial) > 0
        return table
