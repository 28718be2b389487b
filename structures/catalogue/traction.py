"""Traction of an elastic body: sigma(u) n = t, sigma = lambda div u I + mu (grad u + grad u^T), n outward.

    u = psi + w F + w^2 psi',
    F = -(r - (lambda + mu)/(lambda + 2 mu) N (N . r)) / mu,    r = t + sigma(psi) N,    N = grad w.

The correction w F changes sigma n by -(mu F + (lambda + mu) N (N . F)) on w = 0, of which F is the inverse.
Where a body slips, the normal component of u and the tangential part of the traction are given; on tangential F the
symbol is -mu:

    u = v - w/mu (r - N (N . r)) + w^2 psi',    v = psi - N (g + N . psi),    r = t + sigma(v) N.

Plane stress is this with lambda replaced by 2 lambda mu / (lambda + 2 mu) (:func:`lame`).  By the
general rule (:mod:`structures.catalogue.rule`).
"""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Field
from rfm.errors import StructureError
from rfm.geometry.part import Part
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.rule import completed
from structures.catalogue.samples import PLATE, SHELL, first, positive, second
from structures.catalogue.vector_conditions import Normal, TangentialTraction, Traction
from structures.features import normalised
from structures.field_expression import FieldExpr
from structures.layers import layer
from structures.operator import Operator, unknown

MODELS = ("plane_stress", "plane_strain", "three_dimensional")


def lame(young_modulus: float, poisson_ratio: float, model: str = "three_dimensional") -> tuple[float, float]:
    """Return (lambda, mu), lambda reduced for plane stress."""
    if model not in MODELS:
        raise StructureError(f"unknown model {model!r}; choose one of {', '.join(MODELS)}")
    if not -1.0 < poisson_ratio < 0.5:
        raise StructureError(f"Poisson's ratio must lie between -1 and 0.5, got {poisson_ratio:g}")
    shear = young_modulus / (2.0 * (1.0 + poisson_ratio))
    first_parameter = 2.0 * shear * poisson_ratio / (1.0 - 2.0 * poisson_ratio)
    if model == "plane_stress":
        first_parameter = 2.0 * shear * poisson_ratio / (1.0 - poisson_ratio)
    return first_parameter, shear


def traction(
    w: Field | FieldExpr, given: Sequence[Datum], lame_parameters: tuple[Datum, Datum]
) -> list[Operator]:
    """Return u with sigma(u) n = t where w vanishes.

    Parameters
    ----------
    w
        Normalised to first order.
    given
        t, one datum for each component.
    lame_parameters
        (lambda, mu).
    """
    dimension = len(given)
    psi = [layer(w, [unknown(dimension, c)]) for c in range(dimension)]
    return completed(psi, [Traction(tuple(given), lame_parameters)])


def frictionless(
    w: Field | FieldExpr, given: Sequence[Datum], lame_parameters: tuple[Datum, Datum], value: Datum = 0.0
) -> list[Operator]:
    """Return u with n . u = g and the tangential part of sigma(u) n = t where w vanishes: slip with friction t.

    Parameters
    ----------
    w
        Normalised to first order.
    given
        t; only its tangential part counts.
    lame_parameters
        (lambda, mu).
    value
        g.
    """
    dimension = len(given)
    psi = [layer(w, [unknown(dimension, c)]) for c in range(dimension)]
    conditions = [Normal(value, dimension), TangentialTraction(tuple(given), lame_parameters)]
    return completed(psi, conditions)


def examples() -> list[OnBoundary]:
    """Plane stress and space."""
    flat, solid = lame(2.0, 0.3, "plane_stress"), lame(2.0, 0.3)
    loads = (first, second, positive)
    plane = traction(normalised(PLATE, PLATE.part("all"), 1), loads[:2], flat)
    space = traction(normalised(SHELL, SHELL.part("all"), 1), loads, solid)
    return [
        OnBoundary(
            PLATE, plane, [(PLATE.part(p), traces.traction(loads[:2], flat)) for p in ("rim", "hole")]
        ),
        OnBoundary(
            SHELL, space, [(SHELL.part(p), traces.traction(loads, solid)) for p in ("outer", "inner")]
        ),
    ]


def slip_examples() -> list[OnBoundary]:
    """Slip with a tangential load, in the plane and in space."""
    loads, lam = (first, second, positive), (1.0, 0.8)
    plane = frictionless(normalised(PLATE, PLATE.part("all"), 1), loads[:2], lam, second)
    space = frictionless(normalised(SHELL, SHELL.part("all"), 1), loads, lam)

    def checks(
        parts: Sequence[Part], given: Sequence[Datum], value: Datum
    ) -> list[tuple[Part, traces.Trace]]:
        wanted = traces.normal_component(value), traces.tangential_traction(given, lam)
        return [(part, trace) for part in parts for trace in wanted]

    return [
        OnBoundary(PLATE, plane, checks([PLATE.part(p) for p in ("rim", "hole")], loads[:2], second)),
        OnBoundary(SHELL, space, checks([SHELL.part(p) for p in ("outer", "inner")], loads, 0.0)),
    ]


ENTRY = Entry(
    name="traction",
    satisfies="sigma(u) n = t",
    formula="u = psi + w F + w^2 psi', F = -(r - (l+m)/(l+2m) N (N.r))/m, r = t + sigma(psi) N",
    conditions=("traction",),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
FRICTIONLESS = Entry(
    name="slip-and-traction",
    satisfies="n . u = g and the tangential part of sigma(u) n = t",
    formula="u = v - w/m (r - N (N.r)) + w^2 psi', v = psi - N (g + N.psi), r = t + sigma(v) N",
    conditions=("normal component", "tangential traction"),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=slip_examples,
)
