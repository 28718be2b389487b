"""A Boolean expression from the table of its signs.

Notation: the columns of the table are flats of an arrangement (cells, faces, edges, vertices), the rows
surfaces; ``signs[k, i]`` is the sign of surface k on flat i, ``wanted[i]`` that of the function: 1 inside, -1
outside, 0 on the boundary.  A literal that holds on all that is inside is a term of an intersection (the
convex hull's faces), one that fails on all that is outside a term of a union; what they leave undecided is
taken apart in the same way, connected pieces one by one (as the hulls and pockets of a polygon).  Where that
ends, the rest is the union of products of literals that cover it (prime implicants of the table).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rfm.geometry.expression import Expression, Literal, conjunction, disjunction
from rfm.geometry.outlines.reduction import reduced
from rfm.geometry.surface import Surface

Signs: TypeAlias = NDArray[np.int8]
Mask: TypeAlias = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Table:
    """Signs of surfaces ``(m, n)`` and of the wanted function ``(n,)`` on the flats."""

    surfaces: tuple[Surface, ...]
    signs: Signs
    wanted: Signs

    def correct(self, expression: Expression) -> bool:
        """Whether an expression has the wanted sign on every flat."""
        values = dict(zip(self.surfaces, self.signs, strict=True))
        return bool((expression.evaluate(values) == self.wanted).all())


def synthesised(table: Table) -> Expression | None:
    """Properly signed expression of a table, each surface once where that was found; None when there is none."""
    everywhere = np.ones(len(table.wanted), dtype=bool)
    for attempt in (_peeled(table, everywhere), covering(table, everywhere, flats=True)):
        if isinstance(attempt, Expression) and table.correct(attempt):
            return reduced(attempt, table.correct)
    return None


def covering(table: Table, domain: Mask, flats: bool) -> Expression | bool:
    """Union of products of literals that is true inside and false outside.

    With ``flats`` every flat inside lies strictly in one of the products, so that the union is zero on the boundary
    only; without, every cell does, which takes fewer products and leaves zeros between them.
    """
    signs, inside = table.signs, domain & (table.wanted > 0)
    blocked = signs[:, domain & (table.wanted <= 0)]
    if not inside.any() or not blocked.shape[1]:
        return bool(inside.any())
    zeros = (signs == 0).sum(axis=0)
    open_ = inside if flats else inside & (zeros == 0)
    products: list[Expression] = []
    while open_.any():
        start = int(np.flatnonzero(open_)[np.argmax(zeros[open_])])
        product = _implicant(signs[:, start], blocked)
        open_ = open_ & ~np.all([signs[k] == s for k, s in product.items()], axis=0)
        products.append(conjunction([Literal(table.surfaces[k], s > 0) for k, s in product.items()]))
    return disjunction(products)


def _implicant(flat: Signs, blocked: Signs) -> dict[int, int]:
    """Few literals that hold on a flat and together on nothing that is blocked."""
    kept = {int(k): int(flat[k]) for k in np.flatnonzero(flat)}
    failing = np.sum([blocked[k] != s for k, s in kept.items()], axis=0)
    for k in list(kept):
        without = failing - (blocked[k] != kept[k])
        if (without > 0).all():
            failing = without
            del kept[k]
    return kept


def _peeled(table: Table, domain: Mask) -> Expression | bool:
    """Expression that is right on the flats of a domain; True or False where the domain is all one."""
    inside, outside = domain & (table.wanted > 0), domain & (table.wanted < 0)
    if not inside.any() or not outside.any():
        return bool(inside.any())
    for one, other, join in ((inside, outside, conjunction), (outside, inside, disjunction)):
        sign = 1 if join is conjunction else -1
        rest, literals = domain, []
        for k, row in enumerate(table.signs):
            side = int(row[one][0])
            if side and (row[one] == side).all() and (row[other & rest] != side).any():
                literals.append(Literal(table.surfaces[k], side * sign > 0))
                rest = rest & (row == side)
        if literals:
            return _with(literals, _peeled(table, rest), sign > 0)
    for one, join in ((outside, conjunction), (inside, disjunction)):
        pieces = _components(table.signs, one)
        if len(pieces) > 1:
            found = [_peeled(table, domain & (piece | ~one)) for piece in pieces]
            return join([term for term in found if isinstance(term, Expression)])
    return covering(table, domain, flats=True)


def _with(literals: Sequence[Expression], rest: Expression | bool, both: bool) -> Expression | bool:
    """Intersection (``both``) or union of literals and the rest."""
    if isinstance(rest, bool) and rest is not both:
        return rest
    terms = [*literals, *([rest] if isinstance(rest, Expression) else [])]
    return conjunction(terms) if both else disjunction(terms)


def _components(signs: Signs, chosen: Mask) -> list[Mask]:
    """Connected pieces: cells are connected through the faces between them."""
    members = [int(i) for i in np.flatnonzero(chosen)]
    index = {signs[:, i].tobytes(): i for i in members}
    parent = {i: i for i in members}

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    zeros = (signs == 0).sum(axis=0)
    for i in members:
        if zeros[i] == 1:
            neighbour = signs[:, i].copy()
            k = int(np.argmin(np.abs(neighbour)))
            for side in (-1, 1):
                neighbour[k] = side
                other = index.get(neighbour.tobytes())
                if other is not None:
                    parent[root(other)] = root(i)
    roots = {root(i) for i in members if zeros[i] == 0}
    places = np.arange(signs.shape[1])
    return [np.isin(places, [i for i in members if root(i) == one]) for one in sorted(roots)]
