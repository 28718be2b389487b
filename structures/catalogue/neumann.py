"""Neumann, (7.13) of Shapiro (Acta Numerica 16, 2007).

    u = psi - w D psi + w phi + w^2 psi2,    D = grad w . grad,

phi the derivative along the normal into the domain.  With the program's outward conormal flux k du/dn = g it is
phi = -g / k.  A conductivity matrix K takes the general rule (:mod:`structures.catalogue.rule`), whose symbol
is -N . K N, N = grad w:

    u = psi + w / (N . K N) (-g - K N . grad psi) + w^2 psi2.
"""

from __future__ import annotations

from rfm.calculus.types import Field
from structures.catalogue import traces
from structures.catalogue.condition import Datum
from structures.catalogue.entry import Entry, OnBoundary
from structures.catalogue.rule import completed
from structures.catalogue.samples import ELLIPSE, PLATE, SHELL, first, positive
from structures.catalogue.scalar_conditions import AnisotropicFlux
from structures.features import normalised
from structures.field_expression import FieldExpr, field
from structures.layers import layer
from structures.operator import D, Operator, unknown

K = ((2.0, 0.5), (0.5, 1.0))


def neumann(w: Field | FieldExpr, dimension: int, flux: Datum, conductivity: Datum = 1.0) -> Operator:
    """Return u with k du/dn = flux where w vanishes, n outward.

    Parameters
    ----------
    w
        Normalised to first order.
    dimension
        Number of coordinates.
    flux, conductivity
        g and k.
    """
    w, phi = field(w), -field(flux) / field(conductivity)
    psi, psi2 = unknown(dimension, 0), unknown(dimension, 1)
    return psi - w * D(w, psi) + w * phi + w**2 * psi2


def anisotropic(w: Field | FieldExpr, flux: Datum, conductivity: tuple[tuple[Datum, ...], ...]) -> Operator:
    """Return u with n . K grad u = flux where w vanishes."""
    psi = layer(w, [unknown(len(conductivity))])
    (u,) = completed([psi], [AnisotropicFlux(flux, conductivity)])
    return u


def examples() -> list[OnBoundary]:
    """Plane and space; a matrix."""
    plate, shell, ellipse = PLATE.part("all"), SHELL.part("all"), ELLIPSE.part("all")
    plane = neumann(normalised(PLATE, plate, 1), 2, first, positive)
    space = neumann(normalised(SHELL, shell, 1), 3, first, positive)
    matrix = anisotropic(normalised(ELLIPSE, ellipse, 1), first, K)
    flux = traces.flux(first, positive)
    return [
        OnBoundary(PLATE, [plane], [(PLATE.part(p), flux) for p in ("rim", "hole")]),
        OnBoundary(SHELL, [space], [(SHELL.part(p), flux) for p in ("outer", "inner")]),
        OnBoundary(ELLIPSE, [matrix], [(ellipse, traces.conormal(first, K))]),
    ]


ENTRY = Entry(
    name="neumann",
    satisfies="k du/dn = g; n . K grad u = g",
    formula="u = psi - w D psi + w phi + w^2 psi2, phi = -g/k (7.13)",
    conditions=("flux",),
    unknowns=2,
    normalisation=1,
    derivatives=1,
    examples=examples,
)
