"""The structure u = u0 + w psi: prescribed values on parts of the boundary.

w vanishes exactly on the parts with conditions, to first order, and is smooth and positive elsewhere
(:func:`rfm.geometry.weight.weight`); u0 takes the data.  Every psi then satisfies all conditions exactly
(Kantorovich's method; Shapiro, Acta Numerica 16, 2007, section 7).  Data that differ from part to part
are joined by transfinite interpolation (7.10)-(7.12); parts that share one formula are one piece, so that
the common case needs no interpolation and u0 stays as smooth as the data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from typing import Any

from rfm.calculus.types import Field
from rfm.errors import StructureError
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.weight import weight as weight_field
from structures.corners import meeting_points
from structures.field_expression import Constant, FieldExpr, field
from structures.operator import Operator, unknown
from structures.transfinite import interpolate

APART_EXPONENT = 1.0
MEETING_EXPONENT = 2.0


@dataclass(frozen=True, eq=False)
class Piece:
    """A maximal set of parts that carry one formula."""

    part: Part
    value: FieldExpr


def merge(data: Sequence[tuple[Part, Field | FieldExpr | float]]) -> list[Piece]:
    """Join parts whose data are the same formula: the same field, the same number or the same source text."""
    parts: dict[Any, list[Part]] = {}
    values: dict[Any, FieldExpr] = {}
    for part, value in data:
        key = _formula(value)
        parts.setdefault(key, []).append(part)
        values.setdefault(key, field(value))
    return [Piece(reduce(lambda a, b: a | b, parts[key]), values[key]) for key in parts]


def boundary_values(domain: Shape, pieces: Sequence[Piece], weight: str = "auto") -> FieldExpr:
    """Return u0, equal to the value of every piece on its part.

    Exponents of the interpolation are 1 between parts that do not meet and 2 otherwise
    (no pole may run out of a common corner into cells that the boundary cuts).
    """
    if len(pieces) == 1:
        return pieces[0].value
    meet = any(len(meeting_points(domain, a.part, b.part)) for a, b in combinations(pieces, 2))
    omegas = [weight_field(domain, piece.part, weight) for piece in pieces]
    exponent = MEETING_EXPONENT if meet else APART_EXPONENT
    return interpolate([(p.value, omega) for p, omega in zip(pieces, omegas, strict=True)], exponent)


def dirichlet(
    domain: Shape,
    data: Sequence[tuple[Part, Field | FieldExpr | float]],
    weight: str = "auto",
    extra: Field | None = None,
) -> Operator:
    """Return u = u0 + w psi with u = g_i on part i for every psi.

    Parameters
    ----------
    domain
        The shape.
    data
        Pairs (part of its boundary, value there).  Empty: no condition, u = psi.
    weight
        How weights are built, see :func:`rfm.geometry.weight.weight`.
    extra
        A field added to psi, u = u0 + w (extra + psi): a guess or a singular function that the spline need not
        find, without disturbing the conditions.

    Raises
    ------
    StructureError
        When a whole surface carries two different values.
    """
    psi = unknown(domain.dimension)
    if extra is not None:
        psi = psi + extra
    if not data:
        return psi
    pieces = merge(data)
    _refuse_contradictions(pieces)
    everywhere = reduce(lambda a, b: a | b, (piece.part for piece in pieces))
    w = field(weight_field(domain, everywhere, weight))
    return boundary_values(domain, pieces, weight) + w * psi


def _formula(value: Field | FieldExpr | float) -> Any:
    """Return a key that is equal for equal formulas."""
    if not callable(value):
        return float(value)
    if isinstance(value, Constant):
        return value.value
    source = getattr(value, "source", None)
    return id(value) if source is None else (source, repr(getattr(value, "parameters", None)))


def _refuse_contradictions(pieces: Sequence[Piece]) -> None:
    for a, b in combinations(pieces, 2):
        shared = a.part.surfaces & b.part.surfaces
        if shared and a.part.where is None and b.part.where is None:
            label = ".".join(next(iter(shared)).label)
            raise StructureError(
                f"{label} carries two different Dirichlet values (in {a.part.name} and {b.part.name}): "
                "keep one, or separate them with 'where'"
            )
