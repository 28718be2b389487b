"""A surface: one smooth function whose zero set carries a piece of the boundary.

Notation: ``f > 0`` on the inner side of the primitive, ``f = 0`` on the *carrier* (a whole line, a
whole circle), ``|grad f| = 1`` on the carrier when the function is *normalised* (Shapiro, Acta
Numerica 2007, definition of first-order normalisation, section 4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rfm.calculus.types import Field

Label = tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Piece:
    """A named piece of a carrier: where ``where`` is positive (a side of a polygon on a shared line)."""

    label: Label
    where: Field


@dataclass(frozen=True, eq=False)
class Surface:
    """One boundary function with its name; compared and hashed by identity.

    Parameters
    ----------
    label
        Name, outermost first: ``("plate", "left")``.
    function
        Smooth field, positive on the inner side, zero exactly on the carrier.
    degree
        Total degree as a polynomial (so a bound of the degree in every direction, in any
        orientation); None when it is not a polynomial.
    size
        Feature size (a radius, a half width); infinite when there is none.
    normalised
        Whether the gradient has length one on the whole carrier.
    peak
        Largest value of the function (half the radius of a disk); infinite when there is none.
    pieces
        When several named sides lie on one carrier, they are pieces of one surface.
    auxiliary
        Only separates branches of another carrier (the two nappes of a cone); bears no boundary.
    """

    label: Label
    function: Field
    degree: int | None = None
    size: float = math.inf
    normalised: bool = False
    peak: float = math.inf
    pieces: tuple[Piece, ...] = ()
    auxiliary: bool = False

    @property
    def name(self) -> str:
        """Dotted label, e.g. ``plate.left``."""
        return ".".join(self.label)

    @property
    def labels(self) -> tuple[Label, ...]:
        """Labels that can be selected: those of the pieces, or the surface's own."""
        return tuple(piece.label for piece in self.pieces) or (self.label,)

    def prefixed(self, name: str) -> Surface:
        """Return the same surface under ``name``."""
        pieces = tuple(replace(piece, label=(name, *piece.label)) for piece in self.pieces)
        return replace(self, label=(name, *self.label), pieces=pieces)

    def __repr__(self) -> str:
        return f"Surface({self.name or 'unnamed'})"
