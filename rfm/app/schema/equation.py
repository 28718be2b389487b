"""The section `equation`: one equation by its name with its data."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from rfm.app.expressions import Expression
from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import Datum, DatumOrExact

ZERO, ONE = Expression("0"), Expression("1")


class Poisson(Strict):
    """Diffusion with reaction, -div(k grad u) + c u = f."""

    refused: ClassVar[dict[str, str]] = {
        "advection": "advection is not available; the data of poisson are: source, conductivity, reaction",
    }

    source: DatumOrExact = Field(description="f, or 'from exact'")
    conductivity: Datum = Field(default=ONE, description="k, positive")
    reaction: Datum = Field(default=ZERO, description="c, not negative")


_ABSENT = ("elasticity", "plate", "eigen", "heat", "wave", "helmholtz", "stokes", "navier_stokes", "energy")


class Equation(Strict):
    """The equation of the case."""

    refused: ClassVar[dict[str, str]] = {
        name: f"the equation {name} is not available; the equations are: poisson" for name in _ABSENT
    }

    poisson: Poisson = Field(description="-div(k grad u) + c u = f")

    @property
    def name(self) -> str:
        """Name of the equation."""
        return "poisson"
