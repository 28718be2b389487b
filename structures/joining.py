"""Join boundary data given by different formulas on different parts into one smooth field u0.

The textbook answer is transfinite interpolation (:mod:`structures.transfinite`).  Its weights are singular where
parts meet, which costs all orders but two; so it comes last, between as few data as possible and after they
have been made to agree:

1. A formula that happens to take the right values on other parts too serves there.  For u = sin(pi x) on the
   top of the unit square and 0 on the rest, sin(pi x) is right on the left and the right side, and only
   top and bottom are left to be joined; they do not meet.
2. What is left is joined one after the other, each time in two groups that disagree.
3. Their data are first continued so that they agree wherever smooth continuations can
   (:mod:`structures.reconcile`); the weights close what gap remains.

Measured, best approximation in L2 of a smooth u whose data are given by different extensions:

=====================================  ============  ==========  ===========
domain and psi                         weights only  reconciled  one formula
=====================================  ============  ==========  ===========
square, four sides, p = 5, 24 cells    1e-5          2e-13       1e-12
annulus, polynomials of degree 8       2e-4          4e-15
=====================================  ============  ==========  ===========

Notation: an *atom* is one surface with its condition ``where``; g_k the data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from rfm.calculus.jets import partials
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.weight import Weighting
from rfm.geometry.weight import weight as weight_field
from structures.atoms import Atoms, Mask
from structures.corners import jumps_at
from structures.field_expression import Constant, FieldExpr, field
from structures.reconcile import reconcile
from structures.transfinite import interpolate

AGREE = 1e-13  # of the largest value: rounding
CONTRADICT = 1e-8  # of the largest value: beyond the care one takes in writing down decimals
# A fit that misses more of the gap has steep polynomials and nothing to show for them; at a common corner
# it still removes the singularity.
RESOLVED_APART, RESOLVED_MEETING = 1e-5, 1e-1
APART, MEETING = 1.0, 2.0  # exponents of the weights; no pole may run out of a common corner


@dataclass(frozen=True, eq=False)
class Piece:
    """Parts of the boundary that carry one formula."""

    part: Part
    value: FieldExpr


def join(domain: Shape, pieces: Sequence[Piece], weight: Weighting = "auto") -> FieldExpr:
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
    atoms = Atoms.of(domain, [piece.part for piece in pieces])
    agrees, scale = _agreement(pieces, atoms)
    done = np.zeros(len(atoms.parts), dtype=bool)
    value = pieces[0].value
    while not done.all():
        k = _next(agrees, done)
        value = _blend(atoms, (value, pieces[k].value), (done, agrees[k]), weight, scale)
        done |= agrees[k]
    return value


def _next(agrees: Mask, done: Mask) -> int:
    """Return the formula that is right on most of the atoms that are left, and wrong on fewest of the others."""
    gains, losses = (agrees & ~done).sum(axis=1), (~agrees & done).sum(axis=1)
    return max(range(len(agrees)), key=lambda k: (gains[k], -losses[k]))


def _blend(
    atoms: Atoms, data: tuple[FieldExpr, FieldExpr], right: tuple[Mask, Mask], weight: Weighting, scale: float
) -> FieldExpr:
    """Return a field that is right on all atoms on which one of two fields a, b is.

    Where both are right every mean of them is; so only the atoms that one of them lacks are kept apart.
    """
    a, b = data
    lost, won = right[0] & ~right[1], right[1] & ~right[0]
    if not lost.any():
        return b
    corners = atoms.corners(lost, won)
    # two conditions on one surface meet tangentially, which no smooth extension mends
    compatible = not atoms.share_a_surface(lost, won)
    compatible &= bool(jumps_at(corners, a, b).max(initial=0.0) <= CONTRADICT * scale)
    if compatible and (len(corners) or not isinstance(b - a, Constant)):
        vanishing = [field(weight_field(atoms.domain, atoms.select(mask), weight)) for mask in right]
        nearer_a, nearer_b, left_over = reconcile(atoms.domain, (a, b), (vanishing[0], vanishing[1]), corners)
        if left_over < (RESOLVED_MEETING if len(corners) else RESOLVED_APART):
            a, b = nearer_a, nearer_b
    omegas = [_level(atoms, mask, weight) for mask in (lost, won)]
    return interpolate([(a, omegas[0]), (b, omegas[1])], MEETING if len(corners) else APART)


def _level(atoms: Atoms, chosen: Mask, weight: Weighting) -> FieldExpr:
    """Return omega of a set of atoms: the product where they meet, the harmonic sum of what does not.

    1/omega = 1/omega_1 + 1/omega_2 + ... keeps the unit slopes, so that blending two groups gives (7.11) for all of
    their members; a product of many distances has slopes of all magnitudes, and its weights steep layers.
    """
    omegas = [field(weight_field(atoms.domain, parts, weight)) for parts in atoms.clusters(chosen)]
    return reduce(lambda one, two: one * two / (one + two), omegas)


def _agreement(pieces: Sequence[Piece], atoms: Atoms) -> tuple[Mask, float]:
    """Return which formulas ``(pieces, atoms)`` have the right values on which atoms, and the largest value."""
    with np.errstate(all="ignore"):
        values = [[partials(piece.value, tuple(s.T), 0)[0] for s in atoms.samples] for piece in pieces]
    wanted = [values[owner][j] for j, owner in enumerate(atoms.owners)]
    scale = float(np.nan_to_num([np.abs(v).max(initial=0.0) for v in wanted]).max())
    agrees = np.zeros((len(pieces), len(wanted)), dtype=bool)
    for j, target in enumerate(wanted):
        for k, found in enumerate(values):
            same = len(target) > 0 and bool((np.abs(found[j] - target) <= AGREE * scale).all())
            agrees[k, j] = k == atoms.owners[j] or same
    return agrees, scale
