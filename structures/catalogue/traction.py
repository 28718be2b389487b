"""Traction of an elastic body: sigma(u) n = t, sigma = lambda div u I + mu (grad u + grad u^T), n outward.

    u = psi + w F + w^2 psi',
    F = -(r - (lambda + mu)/(lambda + 2 mu) N (N . r)) / mu,    r = t + sigma(psi) N,    N = grad w.

The correction w F changes sigma n by -(mu F + (lambda + mu) N (N . F)) on w = 0, of which F is the inverse.
Plane stress is this with lambda replaced by 2 lambda mu / (lambda + 2 mu) (:func:`lame`).  By the
general rule (:mod:`structures.catalogue.rule`).
"""

from __future__ import annotations

from collections.abc import Sequence

from rfm.calculus.types import Field
from rfm.errors import StructureError
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.rule import Site, corrected
from structures.catalogue.samples import PLATE, SHELL, first, positive, second
from structures.catalogue.vector_conditions import Traction
from structures.features import normalised
from structures.field_expression import FieldExpr, field
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
    omega, dimension = field(w), len(given)
    psi = [unknown(dimension, c) for c in range(dimension)]
    rest = [omega**2 * unknown(dimension, dimension + c) for c in range(dimension)]
    loaded = corrected(psi, Site.of(omega, [Traction(tuple(given), lame_parameters)]))
    return [a + b for a, b in zip(loaded, rest, strict=True)]


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
