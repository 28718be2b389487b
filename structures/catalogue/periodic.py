"""Periodic: u and its derivatives below order m agree on part A and on part B = A + T, up to a factor.

A structure is made of functions at one point, periodicity relates two.  So psi enters twice, as it is and
translated by the period T, psi'(x) = psi(x - T), and (7.10) joins both:

    u = W_A psi + c W_B psi',    W_A = wB^m / (wA^m + wB^m),    W_B = 1 - W_A.

On A u is psi(x), at the point x + T of B it is c psi'(x + T) = c psi(x), and the weights are flat to order m
there: all derivatives below m agree.  c = 1: periodic, c = -1: antiperiodic (a phase factor of a wave in a
crystal takes two real fields).

For a spline basis psi' needs no unknowns of its own: on a grid whose period is a whole number of cells its
coefficients are those of psi, shifted.  :class:`Translate` says so to a basis; psi must be defined on the
domain and one period before it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.jets import partials
from rfm.calculus.types import Array, Field, Value
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.catalogue.entry import COUNT, Entry, Example, random_field, random_points
from structures.catalogue.samples import RECTANGLE
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.jet_matrix import evaluate
from structures.operator import Operator, unknown
from structures.transfinite import weights


@dataclass(frozen=True)
class Translate:
    """psi_index(x) = psi_source(x - vector).

    Attributes
    ----------
    source, index
        Indices of the unknown and of its copy.
    vector
        T.
    """

    source: int
    index: int
    vector: tuple[float, ...]

    def of(self, psi: Field) -> Field:
        """Return the translated function."""
        return _Moved(psi, self.vector)


def periodic(
    wa: Field | FieldExpr,
    wb: Field | FieldExpr,
    period: Sequence[float],
    order: int = 2,
    factor: float = 1.0,
) -> tuple[Operator, Translate]:
    """Return u, and how its second unknown follows from the first.

    Parameters
    ----------
    wa, wb
        Zero on A and on B, positive elsewhere; wb(x + T) need not equal wa(x).
    period
        T, from A to B.
    order
        m: derivatives below it agree (2: value and flux).
    factor
        c = u(x + T) / u(x).
    """
    dimension = len(period)
    at_a, at_b = weights([field(wa), field(wb)], float(order))
    u = at_a * unknown(dimension, 0) + (factor * at_b) * unknown(dimension, 1)
    return u, Translate(0, 1, tuple(float(t) for t in period))


@dataclass(frozen=True)
class _Moved:
    psi: Field
    vector: tuple[float, ...]

    def __call__(self, *coords: Value) -> Value:
        return self.psi(*(x - t for x, t in zip(coords, self.vector, strict=True)))


@dataclass(frozen=True, eq=False)
class Opposite(Example):
    """Two opposite sides of a shape."""

    domain: Shape
    side: Part
    operators: Sequence[Operator]
    link: Translate
    order: int
    factor: float

    def residual(self, seed: int, count: int = COUNT) -> dict[str, float]:
        """See :meth:`Example.residual`."""
        rng = np.random.default_rng(seed)
        psi = random_field(self.domain.dimension, rng)
        fields: dict[int, Field] = {self.link.source: psi, self.link.index: self.link.of(psi)}
        points = random_points(self.domain, self.side, rng, count)
        here, there = (self._jets(fields, p) for p in (points, points + np.array(self.link.vector)[:, None]))
        gap = float(np.abs(there - self.factor * here).max()) / max(1.0, float(np.abs(here).max()))
        return {f"{self.side.name}: derivatives below {self.order}": gap}

    def _jets(self, fields: dict[int, Field], points: Array) -> Array:
        (u,) = self.operators
        tables = {m: partials(f, tuple(points), self.order - 1) for m, f in fields.items()}
        return evaluate(u, tuple(points), self.order - 1).apply(tables)


def examples() -> list[Opposite]:
    """The left and the right side of a rectangle: value and flux; antiperiodic to third order."""
    left, right = RECTANGLE.part("box.left"), RECTANGLE.part("box.right")
    wa, wb = normalised(RECTANGLE, left, 1), normalised(RECTANGLE, right, 1)
    found = []
    for order, factor in ((2, 1.0), (4, -1.0)):
        u, link = periodic(wa, wb, (1.5, 0.0), order, factor)
        found.append(Opposite(RECTANGLE, left, [u], link, order, factor))
    return found


ENTRY = Entry(
    name="periodic",
    satisfies="d^k u/dn^k(x + T) = c d^k u/dn^k(x), k < m",
    formula="u = W_A psi + c W_B psi', psi'(x) = psi(x - T)",
    conditions=("periodicity",),
    unknowns=2,
    normalisation=1,
    derivatives=0,
    examples=examples,
)
