"""The structure u = u0 + w psi: prescribed values on parts of the boundary.

w vanishes exactly on the parts with conditions, to first order, and is smooth and positive elsewhere
(:func:`rfm.geometry.weight.weight`); u0 takes the data.  Every psi then satisfies all conditions exactly
(Kantorovich's method; Shapiro, Acta Numerica 16, 2007, section 7).  Data that differ from part to part
are joined (:mod:`structures.joining`); parts that share one formula are one piece, so that the common case
needs no interpolation and u0 stays as smooth as the data.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import combinations
from typing import Any

from rfm.calculus.r_systems import RSystem
from rfm.calculus.types import Field
from rfm.errors import StructureError
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.weight import Weighting
from rfm.geometry.weight import weight as weight_field
from structures.field_expression import Constant, FieldExpr, field
from structures.joining import Piece, join
from structures.operator import Operator, unknown


def merge(data: Sequence[tuple[Part, Field | FieldExpr | float]]) -> list[Piece]:
    """Join parts whose data are the same formula: the same field, the same number or the same source text."""
    parts: dict[Any, list[Part]] = {}
    values: dict[Any, FieldExpr] = {}
    for part, value in data:
        key = _formula(value)
        parts.setdefault(key, []).append(part)
        values.setdefault(key, Constant(key) if isinstance(key, float) else field(value))
    return [Piece(reduce(lambda a, b: a | b, parts[key]), values[key]) for key in parts]


def dirichlet(
    domain: Shape,
    data: Sequence[tuple[Part, Field | FieldExpr | float]],
    weight: Weighting | Field = "auto",
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
        How weights are built, see :func:`rfm.geometry.weight.weight`; or w itself, when the caller has
        already built one that vanishes on all of the parts (it is then evaluated once only).
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
    if isinstance(weight, str | RSystem):
        return join(domain, pieces, weight) + field(weight_field(domain, everywhere, weight)) * psi
    return join(domain, pieces) + field(weight) * psi


def _formula(value: Field | FieldExpr | float) -> Any:
    """Return a key that is equal for equal formulas: a float for constants, whatever form they come in."""
    if not callable(value):
        return float(value)
    if isinstance(value, Constant):
        return value.value
    source = getattr(value, "source", None)
    if source is None:
        return id(value)
    try:
        return float(source)
    except ValueError:
        return source, repr(getattr(value, "parameters", None))


def _refuse_contradictions(pieces: Sequence[Piece]) -> None:
    for a, b in combinations(pieces, 2):
        shared = a.part.surfaces & b.part.surfaces
        if shared and a.part.where is None and b.part.where is None:
            label = ".".join(next(iter(shared)).label)
            raise StructureError(
                f"{label} carries two different Dirichlet values (in {a.part.name} and {b.part.name}): "
                "keep one, or separate them with 'where'"
            )
