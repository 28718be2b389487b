"""Different kinds of conditions on different parts, which may meet at corners.

1. Values (and, where the edge is clamped, slopes) come first: u = g + w psi, w the product of the weights of
these parts, those of clamped
   parts squared; different data are joined by :mod:`structures.joining`, Taylor polynomials by (7.12).
2. The other conditions correct this field, each on its part, by the general rule
(:mod:`structures.catalogue.rule`): weighted, so that
   all of them hold for every psi and any data; or first one after the other (``successive``).
3. What the corrections leave open is w' psi', w' vanishing one order higher than the highest condition of
every part.

Where two flux parts meet, plain corrections one after the other are exact when the normals are perpendicular
and the data are extended compatibly (d phi1/dn2 = d phi2/dn1); the weights have no limit at the corner. With
``successive`` the weights multiply only what the plain corrections leave, which is of higher order in the
distance from the corner.

Shapiro (Acta Numerica 16, 2007), section 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

from rfm.errors import StructureError
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from rfm.geometry.weight import weight as weight_field
from structures.catalogue import traces
from structures.catalogue.compatibility import Prescribed, check
from structures.catalogue.condition import Condition, Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.plate_conditions import Moment, Shear
from structures.catalogue.rule import Site, combined, even, levels
from structures.catalogue.samples import RECTANGLE, first, positive, second
from structures.catalogue.scalar_conditions import Flux, Value
from structures.catalogue.vector_conditions import Components, Traction
from structures.dirichlet import merge
from structures.features import normalised
from structures.field_expression import ONE, FieldExpr, field, is_constant
from structures.joining import join
from structures.layers import layer
from structures.operator import Operator, known, unknown
from structures.transfinite import interpolate


def multipart(
    domain: Shape,
    prescribed: Sequence[Prescribed],
    components: int = 1,
    equation_order: int = 2,
    weight: str = "auto",
    successive: bool = False,
    remainder: bool = True,
) -> list[Operator]:
    """Return the components of u that satisfy all conditions.

    Parameters
    ----------
    domain
        The shape.
    prescribed
        Parts, each with its conditions.
    components
        Number of components of u.
    equation_order
        2 or 4: how many conditions belong on every part.
    weight
        How weights are built, see :func:`rfm.geometry.weight.weight`.
    successive
        See the module's docstring.
    remainder
        Add w' psi', with as many more unknowns as there are components.

    Raises
    ------
    StructureError
        See :func:`structures.catalogue.compatibility.check`.
    """
    check(prescribed, equation_order)
    if any(c.components != components for _, conditions in prescribed for c in conditions):
        raise StructureError(f"u has {components} components; every condition must have as many")
    bases = [_base(domain, prescribed, c, weight) for c in range(components)]
    sites = [site for part, conditions in prescribed if (site := _site(domain, part, conditions))]
    natural = [site for site in sites if site.conditions]
    start = [value + w * unknown(domain.dimension, c) for c, (value, w) in enumerate(bases)]
    found = combined(start, sites, successive) if natural else start
    if not natural or not remainder:
        return found
    higher = reduce(lambda a, b: a * b, (site.w**site.kept for site in natural))
    rest = [_held(domain, prescribed, c, weight, without_natural=True) for c in range(components)]
    return [
        u + (higher * w) * unknown(domain.dimension, components + c)
        for c, (u, w) in enumerate(zip(found, rest, strict=True))
    ]


def essential(conditions: Sequence[Condition]) -> list[Condition]:
    """Return the conditions built into g + w psi: values, and slopes where there is a value too."""
    values = [c for c in conditions if isinstance(c, (Value, Components))]
    return values + [c for c in conditions if values and isinstance(c, Flux)]


def _site(domain: Shape, part: Part, conditions: Sequence[Condition]) -> Site | None:
    built_in = essential(conditions)
    natural = [c for c in conditions if c not in built_in]
    w = normalised(domain, part, 1)
    return Site.of(w, natural) if natural else Site(w, (), kept=len(built_in))


def _given(conditions: Sequence[Condition], component: int) -> Datum | None:
    """Return the value of a component on a part, None when it is free."""
    for condition in conditions:
        if isinstance(condition, Value) and component == 0:
            return condition.value
        if isinstance(condition, Components):
            return condition.given[component]
    return None


def _base(
    domain: Shape, prescribed: Sequence[Prescribed], component: int, weight: str
) -> tuple[FieldExpr, FieldExpr]:
    """Return g and w of a component."""
    held = [(part, conditions, _given(conditions, component)) for part, conditions in prescribed]
    data = [(part, conditions, g) for part, conditions, g in held if g is not None]
    w = _held(domain, prescribed, component, weight, without_natural=False)
    if not data:
        return field(0.0), w
    if all(len(essential(conditions)) == 1 for _, conditions, _ in data):
        return join(domain, merge([(part, g) for part, _, g in data]), weight), w
    pieces = []
    for part, conditions, g in data:
        omega = normalised(domain, part, 1)
        start = layer(omega, [known(domain.dimension, g)])
        slopes = [c for c in essential(conditions) if isinstance(c, Flux)]
        pieces.append((levels([start], slopes)[0].total().offset, omega, even(len(slopes) + 1)))
    if all(is_constant(p, 0.0) for p, _, _ in pieces):
        return field(0.0), w
    return interpolate([(p, omega) for p, omega, _ in pieces], [float(mu) for _, _, mu in pieces]), w


def _held(
    domain: Shape, prescribed: Sequence[Prescribed], component: int, weight: str, without_natural: bool
) -> FieldExpr:
    """Return the product of the weights of the parts that hold a component, to the order that they hold it."""
    by_order: dict[int, list[Part]] = {}
    for part, conditions in prescribed:
        built_in = essential(conditions)
        if without_natural and len(built_in) < len(conditions):
            continue
        if _given(conditions, component) is not None:
            by_order.setdefault(len(built_in), []).append(part)
    factors = [field(weight_field(domain, parts, weight)) ** order for order, parts in by_order.items()]
    return reduce(lambda a, b: a * b, factors, ONE)


def examples() -> list[OnBoundary]:
    """A rectangle: four kinds; the same one after the other; a plate; a bracket."""
    left, right, bottom, top = (RECTANGLE.part(f"box.{s}") for s in ("left", "right", "bottom", "top"))
    scalar: list[Prescribed] = [
        (left, [Value(first)]),
        (right, [Flux(second, positive)]),
        (bottom, [Flux(first, 1.0, positive)]),
        (top, [Value(second)]),
    ]
    checks = [
        (left, traces.value(first)),
        (right, traces.flux(second, positive)),
        (bottom, traces.flux(first, 1.0, positive)),
        (top, traces.value(second)),
    ]
    fluxes: list[Prescribed] = [(part, [Flux(first)]) for part in (left, bottom)]
    edges: list[Prescribed] = [
        (left, [Value(first), Flux(second)]),
        (right, [Value(0.0), Moment(first, 0.3)]),
        (top, [Moment(second, 0.3), Shear(first, 0.3)]),
    ]
    plate = [
        (left, traces.value(first)),
        (left, traces.flux(second)),
        (right, traces.value(0.0)),
        (right, traces.moment(first, 0.3)),
        (top, traces.moment(second, 0.3)),
        (top, traces.shear(first, 0.3)),
    ]
    bracket: list[Prescribed] = [
        (left, [Components((first, None))]),
        (right, [Traction((first, second), (1.0, 0.8))]),
    ]
    loads = [(left, traces.value(first)), (right, traces.traction((first, second), (1.0, 0.8)))]
    return [
        OnBoundary(RECTANGLE, multipart(RECTANGLE, scalar), checks),
        OnBoundary(
            RECTANGLE,
            multipart(RECTANGLE, fluxes, successive=True),
            [(part, traces.flux(first)) for part in (left, bottom)],
        ),
        OnBoundary(RECTANGLE, multipart(RECTANGLE, edges, equation_order=4), plate),
        OnBoundary(RECTANGLE, multipart(RECTANGLE, bracket, components=2), loads),
    ]


ENTRY = Entry(
    name="multipart",
    satisfies="different kinds of conditions on parts that may meet at corners",
    formula="u = u1 + sum_i W_i w_i^k/k! F_i + w' psi', u1 = g + w psi (7.10)",
    conditions=(
        "value",
        "flux",
        "bending moment",
        "Kirchhoff shear",
        "components",
        "traction",
        "normal component",
    ),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
