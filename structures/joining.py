"""Join boundary data given by different formulas on different parts into one smooth field u0.

The textbook answer is transfinite interpolation (:mod:`structures.transfinite`).  Its weights are singular where
parts meet, which costs all orders but two; so it is the last resort, used between as few data as
possible and after they have been made to agree:

1. A formula that happens to take the right values on other parts too serves there.  For u = sin(pi x) on the
   top of the unit square and 0 on the rest, sin(pi x) is right on the left and the right side, and only
   top and bottom are left to be joined: u0 = y sin(pi x), smooth.
2. What is left is joined one after the other, each time in two groups that disagree.
3. Where the groups meet, their data are first continued so that they agree around the corner
   (:mod:`structures.reconcile`).

Measured on the square with four different smooth data (best approximation in L2, degree 5, 24 cells): transfinite
weights alone 1e-5, reconciled 4e-13, one common formula 1e-12.

Notation: an *atom* is one surface with its condition ``where``; g_k the data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import partials
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.weight import weight as weight_field
from structures.contact import boundary_points, meeting_points, spread_points
from structures.corners import jumps_at
from structures.field_expression import Constant, FieldExpr, field
from structures.reconcile import reconcile
from structures.transfinite import interpolate

AGREE = 1e-13  # of the largest value: rounding
CONTRADICT = 1e-8  # of the largest value: beyond the care one takes in writing down decimals
APART, MEETING = 1.0, 2.0  # exponents of the weights; no pole may run out of a common corner

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Piece:
    """Parts of the boundary that carry one formula."""

    part: Part
    value: FieldExpr


def join(domain: Shape, pieces: Sequence[Piece], weight: str = "auto") -> FieldExpr:
    """Return u0, equal to the value of every piece on its part.

    Parameters
    ----------
    domain
        The shape.
    pieces
        Different formulas and where they hold; the parts do not overlap.
    weight
        How the functions that vanish on the parts are built, see :func:`rfm.geometry.weight.weight`.
    """
    if len(pieces) == 1:
        return pieces[0].value
    atoms = [atom for piece in pieces for atom in _atoms(piece.part)]
    agrees, scale = _agreement(domain, pieces, atoms)
    done = np.zeros(len(atoms), dtype=bool)
    value = pieces[0].value
    while not done.all():
        k = _next(agrees, done)
        sides = _Sides(
            wrong=_chosen(atoms, done & ~agrees[k]),
            new=_chosen(atoms, agrees[k] & ~done),
            old=_chosen(atoms, done),
            right=_chosen(atoms, agrees[k]),
        )
        value = _blend(domain, value, pieces[k].value, sides, weight, scale)
        done |= agrees[k]
    return value


def _next(agrees: Mask, done: Mask) -> int:
    """Return the formula that is right on most of the atoms that are left, and wrong on fewest of the others."""
    gains, losses = (agrees & ~done).sum(axis=1), (~agrees & done).sum(axis=1)
    return max(range(len(agrees)), key=lambda k: (gains[k], -losses[k]))


@dataclass(frozen=True, eq=False)
class _Sides:
    """Where the field so far and a new formula hold.

    ``old``: atoms on which the field so far is right; ``right``: those on which the new formula is;
    ``wrong``: old ones on which the new formula is not; ``new``: atoms that it wins.
    """

    wrong: list[Part]
    new: list[Part]
    old: list[Part]
    right: list[Part]


def _blend(domain: Shape, a: FieldExpr, b: FieldExpr, sides: _Sides, weight: str, scale: float) -> FieldExpr:
    """Return a field that is ``a`` on the old atoms and ``b`` on the new ones."""
    if not sides.wrong:
        return b

    def vanishing(parts: Sequence[Part]) -> FieldExpr:
        return field(weight_field(domain, parts, weight))

    corners = np.concatenate([meeting_points(domain, one, two) for one in sides.wrong for two in sides.new])
    plain = isinstance(b - a, Constant) and not len(corners)
    if not plain and _can_agree(sides) and jumps_at(corners, a, b).max(initial=0.0) <= CONTRADICT * scale:
        a, b = reconcile(domain, (a, b), (vanishing(sides.old), vanishing(sides.right)), corners)
    omegas = [_level(domain, parts) for parts in (sides.wrong, sides.new)]
    return interpolate([(a, omegas[0]), (b, omegas[1])], MEETING if len(corners) else APART)


def _level(domain: Shape, parts: Sequence[Part]) -> FieldExpr:
    """Return a function that rises from 0 on the parts to about 1 in the domain.

    Raw products of many factors differ by orders of magnitude, and weights made of them have steep layers.
    """
    level = field(weight_field(domain, parts, "product" if len(parts) == 1 else "saturated"))
    inside = spread_points(domain)
    inside = inside[domain.contains(inside)]
    top = partials(level, tuple(inside.T), 0)[0].max(initial=0.0)
    return level * (1.0 / top) if 0.0 < top < np.inf else level


def _can_agree(sides: _Sides) -> bool:
    """Two conditions on one surface meet tangentially: their data differ by more than smooth extensions can mend."""
    return not any(one.surfaces & two.surfaces for one in sides.wrong for two in sides.new)


def _atoms(part: Part) -> list[Part]:
    return [
        replace(piece, name=surface.name, surfaces=frozenset([surface]))
        for piece in part.pieces
        for surface in sorted(piece.surfaces, key=lambda s: s.label)
    ]


def _chosen(atoms: Sequence[Part], chosen: Mask) -> list[Part]:
    return [atom for atom, take in zip(atoms, chosen, strict=True) if take]


def _agreement(domain: Shape, pieces: Sequence[Piece], atoms: Sequence[Part]) -> tuple[Mask, float]:
    """Return which formulas ``(pieces, atoms)`` have the right values on which atoms, and the largest value."""
    owners = [k for k, piece in enumerate(pieces) for _ in _atoms(piece.part)]
    samples = [boundary_points(domain, atom) for atom in atoms]
    with np.errstate(all="ignore"):
        values = [[partials(piece.value, tuple(s.T), 0)[0] for s in samples] for piece in pieces]
    sizes = [np.abs(values[owner][j]).max(initial=0.0) for j, owner in enumerate(owners)]
    scale = float(np.nan_to_num(sizes).max())
    agrees = np.zeros((len(pieces), len(atoms)), dtype=bool)
    for j, owner in enumerate(owners):
        for k in range(len(pieces)):
            gap = np.abs(values[k][j] - values[owner][j])
            agrees[k, j] = k == owner or (len(gap) > 0 and bool((gap <= AGREE * scale).all()))
    return agrees, scale
