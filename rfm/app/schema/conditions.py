"""The section `boundary_conditions`: what holds on which part of the boundary."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field, ValidationInfo, model_validator

from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import FROM_EXACT, Comparison, Datum, DatumOrExact, PartNames, fail

KIND_NAMES = ("dirichlet", "neumann", "robin")


class RobinData(Strict):
    """Coefficient h and value g of k du/dn + h u = g."""

    coefficient: Datum
    value: DatumOrExact


class BoundaryCondition(Strict):
    """One condition on a part, several parts, `all`, or the `rest` that no other condition takes."""

    refused: ClassVar[dict[str, str]] = {
        name: f"{name} is not available; the conditions of poisson are: {', '.join(KIND_NAMES)}"
        for name in ("traction", "pressure", "clamped", "simply_supported", "free", "extension")
    }

    on: PartNames = Field(description="part, list of parts, all, or rest")
    where: Comparison | None = Field(default=None, description="comparison: only the piece where it holds")
    dirichlet: DatumOrExact | None = Field(default=None, description="u = value")
    neumann: DatumOrExact | None = Field(default=None, description="k du/dn = value, n outward")
    robin: RobinData | None = Field(default=None, description="k du/dn + coefficient * u = value")

    @model_validator(mode="after")
    def _one_kind(self, info: ValidationInfo) -> BoundaryCondition:
        self.one_of(KIND_NAMES, "a condition")
        for name in ("all", "rest"):
            if name in self.on and len(self.on) > 1:
                raise fail(f"{name!r} stands alone, it cannot be combined with other parts", value=("on",))
        if "rest" in self.on and self.where is not None:
            raise fail("'rest' takes what is left and has no where; name the parts instead", key=("where",))
        return self

    @property
    def kind(self) -> str:
        """Name of the condition: dirichlet, neumann or robin."""
        return next(name for name in KIND_NAMES if getattr(self, name) is not None)

    @property
    def from_exact(self) -> bool:
        """Whether its value is taken from the exact solution."""
        return FROM_EXACT in (self.dirichlet, self.neumann, self.robin and self.robin.value)
