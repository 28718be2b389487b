"""Other materials in parts of the domain: where they are, what differs, and what jumps at their interface."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo

from rfm.app.expressions import Expression
from rfm.app.schema.base import Strict
from rfm.app.schema.references import ShapeExpression
from rfm.app.schema.scalars import WRITTEN, Datum, DatumOrExact, Text, fail, validate_datum
from rfm.app.schema.vectors import ComponentsOrExact

ZERO = Expression("0")


def _positive(value: Any, info: ValidationInfo) -> Expression:
    datum = validate_datum(value, info)
    if datum.constant is not None and not float(datum.constant) > 0:
        raise fail(f"must be positive, got {float(datum.constant):g}")
    return datum


PositiveDatum = Annotated[Expression, BeforeValidator(_positive), WRITTEN]


class Inclusion(Strict):
    """A part of the domain with another material; what is not given is that of the rest."""

    region: ShapeExpression = Field(description="shapes joined by & | - ~: the part of the domain in them")
    name: Text | None = Field(
        default=None, description="for results and the key exact; the region by default"
    )

    @property
    def called(self) -> str:
        """Its name."""
        return self.name if self.name is not None else self.region.text

    def overrides(self) -> dict[str, Any]:
        """Data of the equation that are given, by key."""
        known = {"region", "name", "jump", "flux_jump"}
        return {key: value for key, value in self if key not in known and value is not None}


class PoissonInclusion(Inclusion):
    """A material of another conductivity."""

    conductivity: PositiveDatum | None = Field(default=None, description="k, positive")
    source: DatumOrExact | None = Field(default=None, description="f, or 'from exact'")
    reaction: Datum | None = Field(default=None, description="c, not negative")
    jump: DatumOrExact = Field(default=ZERO, description="u inside minus u outside on the interface")
    flux_jump: DatumOrExact = Field(
        default=ZERO, description="k du/dn inside minus outside, n out of the region"
    )


class ElasticInclusion(Inclusion):
    """A material of other moduli."""

    young_modulus: PositiveDatum | None = Field(default=None, description="E, positive")
    poisson_ratio: Datum | None = Field(default=None, description="nu, above -1 and below 1/2")
    body_force: ComponentsOrExact | None = Field(default=None, description="f, a list, or 'from exact'")
    jump: ComponentsOrExact | None = Field(default=None, description="u inside minus u outside, a list")
    flux_jump: ComponentsOrExact | None = Field(
        default=None, description="sigma n inside minus outside, n out of the region, a list"
    )
