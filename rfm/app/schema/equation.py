"""The section `equation`: one equation by its name with its data."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, ValidationInfo, model_validator

from rfm.app.expressions import Expression
from rfm.app.schema.base import Strict
from rfm.app.schema.inclusions import ElasticInclusion, Inclusion, PoissonInclusion
from rfm.app.schema.scalars import (
    DIMENSION_WORDS,
    FROM_EXACT,
    Datum,
    DatumOrExact,
    Number,
    choice,
    fail,
    scope_of,
)
from rfm.app.schema.vectors import Components, ComponentsOrExact
from rfm.app.yaml_reader import Path

ZERO, ONE = Expression("0"), Expression("1")


class Poisson(Strict):
    """Advection, diffusion and reaction, -div(k grad u) + b . grad u + c u = f."""

    source: DatumOrExact = Field(description="f, or 'from exact'")
    conductivity: Datum = Field(default=ONE, description="k, positive")
    reaction: Datum = Field(default=ZERO, description="c, not negative")
    advection: Components | None = Field(default=None, description="b, a list; needs method: galerkin")
    inclusions: tuple[PoissonInclusion, ...] | None = Field(
        default=None, description="parts of another material"
    )


class Elasticity(Strict):
    """Small displacements of an elastic body, -div sigma = f."""

    model: choice(  # type: ignore[valid-type]
        "plane_stress",
        "plane_strain",
        "three_dimensional",
        missing={
            "axisymmetric": "the model axisymmetric is not available; the models are: plane_stress, plane_strain, "
            "three_dimensional"
        },
    ) = Field(description="plane_stress, plane_strain or three_dimensional")
    young_modulus: Datum = Field(description="E, positive")
    poisson_ratio: Datum = Field(description="nu, above -1 and below 1/2")
    body_force: ComponentsOrExact | None = Field(
        default=None, description="f, a list, or 'from exact'; zero by default"
    )
    inclusions: tuple[ElasticInclusion, ...] | None = Field(
        default=None, description="parts of another material"
    )

    @model_validator(mode="after")
    def _fitting(self, info: ValidationInfo) -> Elasticity:
        dimension, plane = scope_of(info).dimension, str(self.model) != "three_dimensional"
        if dimension is not None and plane != (dimension == 2):
            fitting = "plane_stress or plane_strain" if dimension == 2 else "three_dimensional"
            words = DIMENSION_WORDS[dimension]
            raise fail(f"{self.model} does not suit this {words} case; use {fitting}", value=("model",))
        return self


class Plate(Strict):
    """Bending of a thin plate, div div (D H w) = q."""

    stiffness: Datum = Field(default=ONE, description="D, positive")
    poisson_ratio: Number = Field(default=0.3, description="nu, above -1 and at most 1/2")
    load: DatumOrExact = Field(description="q, or 'from exact'")


_ABSENT = ("eigen", "heat", "wave", "helmholtz", "stokes", "navier_stokes", "energy")
MODELS: dict[str, type[Strict]] = {"poisson": Poisson, "elasticity": Elasticity, "plate": Plate}
"""Data of each equation."""

NAMES = tuple(MODELS)


class Equation(Strict):
    """The equation of the case."""

    refused: ClassVar[dict[str, str]] = {
        name: f"the equation {name} is not available; the equations are: {', '.join(NAMES)}"
        for name in _ABSENT
    }

    poisson: Poisson | None = Field(default=None, description="-div(k grad u) + b . grad u + c u = f")
    elasticity: Elasticity | None = Field(default=None, description="-div sigma = f")
    plate: Plate | None = Field(default=None, description="div div (D H w) = q")

    @model_validator(mode="after")
    def _one_equation(self) -> Equation:
        self.one_of(NAMES, "an equation")
        return self

    @property
    def name(self) -> str:
        """Name of the equation."""
        return next(name for name in NAMES if getattr(self, name) is not None)

    @property
    def data(self) -> Poisson | Elasticity | Plate:
        """Data of the equation."""
        data: Poisson | Elasticity | Plate = getattr(self, self.name)
        return data

    @property
    def inclusions(self) -> tuple[Inclusion, ...]:
        """Parts of the domain with another material."""
        return getattr(self.data, "inclusions", None) or ()

    @property
    def exact_path(self) -> Path | None:
        """Where a datum is taken from the exact solution, None when there is none."""
        found: list[tuple[Path, Strict]] = [((), self.data)]
        found += [(("inclusions", i), inclusion) for i, inclusion in enumerate(self.inclusions)]
        taken = ((*path, key) for path, one in found for key, value in one if value == FROM_EXACT)
        return next(taken, None)
