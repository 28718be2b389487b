r"""Is the function of a predicate normalised?  Inversion degrees and Theorem 4.

Theorem 4 of Shapiro (Acta Numerica 2007): R_p-functions of functions that are normalised to order m <= p - 1 are
normalised to order m at the regular points of the boundary.  What it rests on, derived here because it also tells
when it fails: at a regular point one surface function t vanishes and all others do not.  With g > 0

    t ^ g = t + O(t^p),    t ^ (-g) < 0,    -(t ^ g) = -t + O(t^p)

so an operation hands t on, or decides without it, and t arrives at the root with slope (-1)^k, where k negations
lie above it.  That is right if it arrives *once*.  A surface may be mentioned several times (a xor b mentions both
twice) as long as only one mention acts at any point; when two do, ``t ^ t = (2 - 2^(1/p)) t`` has the wrong slope.

Three figures of a surface s in an expression:

    inversions   k modulo 2 of its mentions: 0 for the inner side, 1 for the outer side, both when s occurs both ways
    degree       the largest number of mentions that reach the root together at a point of the boundary
    spurious     whether mentions reach the root where the truth does not depend on s: the function vanishes there too

The *inversion degree* of the shape is the largest degree of its surfaces, and the theorem holds when it is one.  The
definition of Rvachev (in his book of 1982 and in Shapiro's paper) could not be compared word by word: there too every
argument has a number of inversions, whose parity gives the sign of the derivative on the boundary; that number is
``inversions`` here, while ``degree`` is the condition that the derivation needs.  Sign combinations that never
occur in space are counted, so the report errs on the safe side.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from rfm.calculus.r_systems import R1, Rp, RSystem
from rfm.calculus.r_systems import system as r_system
from rfm.calculus.types import Array, Field, Value
from rfm.errors import GeometryError
from rfm.geometry.expression import Conjunction, Expression, Literal, Node
from rfm.geometry.normalisation import kept_order, normalise
from rfm.geometry.shape import Shape
from rfm.geometry.surface import Surface

MOST_SURFACES = 14
"""Up to so many surfaces beside a repeated one all signs are tried; beyond, every mention counts."""

SHOWN = 5
"""Surfaces that a line of the report names."""


@dataclass(frozen=True)
class Occurrence:
    """How a surface enters the function, see the module."""

    name: str
    mentions: int
    inversions: frozenset[int]
    degree: int
    spurious: bool


@dataclass(frozen=True)
class NormalisationReport:
    """What can be said of the function of a shape.

    Attributes
    ----------
    operations
        Number of R-functions of two arguments.
    occurrences
        One for each surface.
    kept
        Order to which all of the systems keep normalisation.
    primitives
        Order of the surface functions as they are: 1, or 0 when one of them is not normalised.
    """

    operations: int
    occurrences: tuple[Occurrence, ...]
    kept: float
    primitives: int

    @property
    def inversion_degree(self) -> int:
        """Largest degree of the surfaces."""
        return max(occurrence.degree for occurrence in self.occurrences)

    @property
    def guaranteed(self) -> bool:
        """Whether Theorem 4 applies, to order `kept`."""
        return self.inversion_degree == 1 and self.kept >= 1

    @property
    def order(self) -> int:
        """Order to which the function is normalised as it is; 0 without a guarantee."""
        return int(min(self.kept, self.primitives)) if self.guaranteed else 0

    def lines(self) -> list[str]:
        """Statement in words."""
        count = len(self.occurrences)
        surfaces = f"{count} surface{'s' if count > 1 else ''}"
        operations = f"{self.operations} R-function{'s' if self.operations != 1 else ''}"
        lines = [f"{operations} of {surfaces}, inversion degree {self.inversion_degree}"]
        acting = _listed([item for item in self.occurrences if item.degree > 1])
        kept = "every order" if self.kept == inf else f"order {self.kept:g}"
        if acting:
            lines.append(f"Theorem 4 does not apply: mentioned more than once at a point: {acting}")
        elif self.kept < 1:
            lines.append("Theorem 4 does not apply: the system does not keep the slope")
        else:
            lines.append(f"Theorem 4 keeps {kept}; the primitives are normalised to order {self.primitives}")
        spurious = _listed([item for item in self.occurrences if item.spurious])
        if spurious:
            lines.append(f"the function may vanish off the boundary too, on: {spurious}")
        return lines


def normalisation_report(shape: Shape, system: str | RSystem | None = None) -> NormalisationReport:
    """Report on the function of a shape.

    Parameters
    ----------
    shape
        Its expression is what the function is made of.
    system
        R-functions of the operations without a system of their own; by default those of the shape.

    Raises
    ------
    GeometryError
        For an unknown system.
    """
    default = shape.system if system is None else r_system(system) if isinstance(system, str) else system
    mentions: dict[Surface, list[Literal]] = {}
    for literal in shape.expression.literals():
        mentions.setdefault(literal.surface, []).append(literal)
    nodes = _nodes(shape.expression)
    systems = {node.system if node.system is not None else default for node in nodes}
    occurrences = tuple(_occurrence(shape.expression, *item) for item in mentions.items())
    bearing = [surface for surface in mentions if not surface.auxiliary]
    return NormalisationReport(
        sum(len(node.terms) - 1 for node in nodes),
        occurrences,
        min((kept_order(item.at(*[0.0] * shape.dimension)) for item in systems), default=inf),
        int(all(surface.normalised for surface in bearing)),
    )


def normalised_function(shape: Shape, order: int = 1, system: str | RSystem | None = None) -> Field:
    """Return the function of a shape, normalised to an order by Theorem 4.

    Every surface function is normalised by itself, (4.9) and (4.10), and the R-functions keep that.

    Parameters
    ----------
    shape
        A shape whose surfaces act once at every point of the boundary (`normalisation_report`).
    order
        Order of the normalisation.
    system
        R-functions, also of operations with a system of their own; by default R_p with the least p that keeps
        the order.

    Raises
    ------
    GeometryError
        When the system does not keep the order, or Theorem 4 does not apply to the shape.
    """
    if system is None:
        chosen: RSystem = Rp(max(2, order + 1 + (order + 1) % 2))
    else:
        chosen = r_system(system) if isinstance(system, str) else system
    plain = shape.expression.plain()
    kept = kept_order(chosen.at(*[0.0] * shape.dimension))
    if kept < order:
        raise GeometryError(
            f"order of normalisation {order} is higher than {system} keeps ({kept:g}); "
            f"take rp{order + 1 + (order + 1) % 2} or a lower order"
        )
    report = normalisation_report(Shape(shape.dimension, plain, shape.reach, shape.outer_reach, R1()))
    if not report.guaranteed:
        raise GeometryError(
            f"{report.lines()[1]}; normalise the finished function with distance(shape, part, order)"
        )
    table = {s: _primitive(s, shape.dimension, order) for s in plain.surfaces()}
    return Substituted(plain, chosen, tuple(table.items()))


@dataclass(frozen=True, eq=False)
class Substituted:
    """R-function of an expression with other functions for its surfaces."""

    expression: Expression
    system: RSystem
    fields: tuple[tuple[Surface, Field], ...]

    def __call__(self, *coords: Value) -> Value:
        """Value at the coordinates; every field is evaluated once."""
        values = {s: field(*coords) for s, field in self.fields}
        return self.expression.composed(values, self.system, coords)


def _listed(occurrences: list[Occurrence]) -> str:
    """Names, the first few of many."""
    names = [item.name or "unnamed" for item in occurrences]
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more


def _primitive(surface: Surface, dim: int, order: int) -> Field:
    if surface.normalised and (order == 1 or surface.degree == 1):
        return surface.function  # a signed distance is normalised to every order
    return normalise(surface.function, dim, order)


def _nodes(expression: Expression) -> list[Node]:
    found: list[Node] = []

    def join(node: Node, terms: list[None]) -> None:
        found.append(node)

    expression.walk(lambda surface, positive: None, join)
    return found


def _occurrence(expression: Expression, surface: Surface, literals: list[Literal]) -> Occurrence:
    inversions = frozenset(0 if literal.positive else 1 for literal in literals)
    single = len(literals) == 1
    degree, spurious = (1, False) if single else _acting(_smallest(expression, surface), surface)
    return Occurrence(surface.name, len(literals), inversions, degree, spurious)


def _smallest(expression: Expression, surface: Surface) -> Expression:
    """Smallest subexpression with all mentions of a surface."""
    while isinstance(expression, Node):
        holders = [term for term in expression.terms if surface in term.surfaces()]
        if len(holders) > 1:
            break
        expression = holders[0]
    return expression


def _acting(expression: Expression, surface: Surface) -> tuple[int, bool]:
    """Largest number of mentions that reach the root at boundary points, and whether some do elsewhere."""
    others = [other for other in expression.surfaces() if other is not surface]
    if len(others) > MOST_SURFACES:
        return sum(literal.surface is surface for literal in expression.literals()), True
    signs = 1 - 2 * np.indices((2,) * len(others)).reshape(len(others), -1)
    columns: dict[Surface, Array] = dict(zip(others, signs, strict=True))
    width = signs.shape[1] if others else 1

    def leaf(other: Surface, positive: bool) -> tuple[Array, Array]:
        if other is surface:
            return np.zeros(width, dtype=int), np.ones(width, dtype=int)
        return columns[other] if positive else -columns[other], np.zeros(width, dtype=int)

    def join(node: Node, terms: list[tuple[Array, Array]]) -> tuple[Array, Array]:
        extreme = np.min if isinstance(node, Conjunction) else np.max
        value = extreme([term[0] for term in terms], axis=0)
        count = np.sum([np.where(term[0] == 0, term[1], 0) for term in terms], axis=0)
        return value, np.where(value == 0, count, 0)

    _, count = expression.walk(leaf, join)
    one = np.ones(width, dtype=int)
    inside = expression.evaluate({**columns, surface: one})
    boundary = inside != expression.evaluate({**columns, surface: -one})
    return int(count[boundary].max(initial=1)), bool(count[~boundary].any())
