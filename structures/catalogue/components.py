"""Vector fields component by component: null components are left free (a roller on a flat wall).

    u_c = g_c + w_c psi_c,

w_c the weight of the parts on which component c is prescribed (:mod:`structures.dirichlet` for each component).
Shapiro (Acta Numerica 16, 2007), section 7, applied to every component.
"""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Field
from rfm.geometry.part import Part
from rfm.geometry.shape import Shape
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.samples import BALL, RECTANGLE, first, second
from structures.dirichlet import dirichlet
from structures.operator import Operator, renumbered


def componentwise(
    domain: Shape, data: Sequence[tuple[Part, Sequence[Datum | None]]], weight: str | Field = "auto"
) -> list[Operator]:
    """Return one operator for each component, with psi_c in component c.

    Parameters
    ----------
    domain
        The shape.
    data
        Pairs (part, (g_1, ..., g_c)); None leaves the component free there.
    weight
        See :func:`structures.dirichlet.dirichlet`.
    """
    return [_component(domain, data, c, weight) for c in range(len(data[0][1]))]


def _component(
    domain: Shape, data: Sequence[tuple[Part, Sequence[Datum | None]]], c: int, weight: str | Field
) -> Operator:
    given = [(part, value) for part, values in data if (value := values[c]) is not None]
    return renumbered(dirichlet(domain, given, weight), {0: c})


def examples() -> list[OnBoundary]:
    """A rectangle held on the left, on a roller below; an ellipsoid."""
    left, bottom, skin = RECTANGLE.part("box.left"), RECTANGLE.part("box.bottom"), BALL.part("all")
    plane = componentwise(RECTANGLE, [(left, (first, second)), (bottom, (None, second))])
    space = componentwise(BALL, [(skin, (first, None, second))])
    return [
        OnBoundary(
            RECTANGLE,
            plane,
            [
                (left, traces.value(first, 0)),
                (left, traces.value(second, 1)),
                (bottom, traces.value(second, 1)),
            ],
        ),
        OnBoundary(BALL, space, [(skin, traces.value(first, 0)), (skin, traces.value(second, 2))]),
    ]


ENTRY = Entry(
    name="componentwise",
    satisfies="u_c = g_c for the components that are given",
    formula="u_c = g_c + w_c psi_c",
    conditions=("components",),
    unknowns=1,
    normalisation=0,
    derivatives=0,
    examples=examples,
)
